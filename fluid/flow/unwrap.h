// UVs for a skin: what is wrong with those it has, and own ones where they will not do. Charts, each laid flat by least squares conformal
// maps (Levy, Petitjean, Ray and Maillot 2002).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

// What was found in UVs of a mesh, in triangles unless said otherwise.
struct UvReport {
    size_t triangles = 0;
    bool missing = false;   // there are none at all
    size_t notNumbers = 0;  // or far beyond any map
    size_t noArea = 0;
    size_t tooWide = 0;            // wider than the map
    size_t mirrored = 0;           // no fault
    size_t beyond = 0;             // with a corner outside 0 to 1: no fault, they wrap round
    double overlap = 0;            // share of the texels claimed that another triangle has claimed too
    double lost = 0;               // share of the skin's area without texels of its own: of all but the last two
    bool usable() const;           // little is lost and little overlaps
    std::string sentence() const;  // "" where nothing is wrong
};
// `uvs`: 3 a triangle, or none. `size`: texels of the map's edge on which it is tried.
UvReport checkUvs(const FlowMesh& mesh, std::span<const vec2> uvs, int size = 1024);

struct Unwrap {
    std::vector<vec2> uvs;        // 3 a triangle, within 0 to 1; a triangle without area has none in UV
    std::vector<uint32_t> chart;  // of each triangle
    uint32_t charts = 0;
    double texelsPerMetre = 0;  // the same of every chart
    double distortion = 0;      // mean over the area of (a/b + b/a) / 2, a and b the singular values of the map: 1 where angles are kept
};
// Charts do not overlap and are 2 `gutter` texels apart. Error (badInput): so many charts that a map of this size has no room for them.
Result<Unwrap> unwrap(const FlowMesh& mesh, int size = 1024, int gutter = 3);

// The UVs that a mesh has where they are usable, else own ones.
struct SkinUvs {
    std::vector<vec2> uvs;  // 3 a triangle
    UvReport given;
    bool unwrapped = false;
    std::string said;  // "" where there is nothing to say
};
Result<SkinUvs> skinUvs(const FlowMesh& mesh, const MeshView& from, int size = 1024);

}  // namespace rivulet
