// Hair of the scalp and the brows: ribbons along the skin, each with several hairs, which the shader draws (Material::strand).
#pragma once

#include "assets/make_head/eyes.h"

namespace rivulet::head {

// 0..1: how dense the crop is at a point of the skin at rest. `ear`: the point's weight kEar.
double cropAt(dvec3 p, double ear);
// The line of a brow on the left side, from the nose outward, and half its width at a share `t` of its length; cm.
inline constexpr std::array<dvec3, 6> kBrowLine = {
    {{1.25, 4.50, 5.24}, {2.05, 4.72, 5.16}, {2.85, 4.90, 4.98}, {3.75, 5.0, 4.57}, {4.6, 4.78, 4.0}, {5.35, 4.25, 3.25}}};
double browHalfWidth(double t);

// u of a ribbon: a number of its own, plus 0..1 across it; v: 0 at the root, 1 at the tip.
Part makeHair(const Surface& head);
// `roots`: for each vertex the skin's vertex that it goes with.
Part makeBrows(const Surface& head, std::vector<uint32_t>& roots);

}  // namespace rivulet::head
