// Volumes that stay dry, such as the inside of a boat.
//
// After each substep the particles inside are removed, as by a sink, and counted in FluidStats::drained: what leaks through a thin hull or
// comes over its edge is gone, and has no weight in the boat. Nothing is emitted there. The picture of the water is cut there too, because
// a drawn surface reaches about a spacing beyond its particles: what is in the volume is the host's, and the water beyond a volume without
// a hull around it is not drawn where the cut surface hid it. A volume therefore ends at the hull, and above at its edge. Renderer points
// draws single particles and is not cut.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/core/params.h"
#include "engine/core/result.h"
#include "fluid/sim/solids/bodies.h"
#include "shaders/fluid/sources/dry_volume.h"

namespace rivulet {

inline constexpr size_t kMostDry = 16;  // volumes of a world

struct DryParams {
    std::string shape = "box";  // box | ellipsoid
    vec3 position{0.0F};        // m, its centre; with a body, where it is at t = 0
    vec3 rotation{0.0F};        // deg, about x, then y, then z
    vec3 size{0.0F};            // m, edge lengths or axes
    int body = -1;              // the id of the body that it moves with; -1: none
    void visit(ParamVisitor& v);
    bool operator==(const DryParams&) const = default;
};

// Error (badInput): more than kMostDry, values out of range, a size that is not positive, a body that is not among `ids`.
Status checkDry(std::span<const DryParams> volumes, std::span<const uint32_t> ids);
// The bodies of a world: an id, the pose at t = 0 or when it was added, and the state of each.
struct DryBodies {
    std::span<const uint32_t> ids;
    std::span<const Pose> starts;
    std::span<const BodyState> states;
};
// In the world, with the bodies where they are.
std::vector<DryVolume> placedDry(std::span<const DryParams> volumes, const DryBodies& bodies);
// Those that move with a body in its frame, wherever it is; and in the world, with the bodies in `states`.
std::vector<DryVolume> ownDry(std::span<const DryParams> volumes, const DryBodies& bodies);
std::vector<DryVolume> placedDry(std::span<const DryVolume> own, std::span<const BodyState> states);
// Whether it has moved by more than `way` (m), turned or changed its size.
bool hasMoved(const DryVolume& from, const DryVolume& to, float way);
Bounds boundsOf(const DryVolume& volume);  // m, around it
bool isDry(std::span<const DryVolume> volumes, const vec3& place);

}  // namespace rivulet
