// Probes: the load of the fluid on walls, parts of walls and bodies.
//
// A load is the sum of the impulses that a wall gives to particles, with the opposite sign: pressure, contact, friction and adhesion. It is
// not computed from the particles' pressures, because the pressure of a particle beside a wall is the multiplier of a constraint that the
// wall takes part in, and differs from the transmitted pressure by tens of percent; momentum is conserved between particles, so the
// impulses are exact: with gravity and the loads on bodies their sum is the change of the fluid's momentum.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/params.h"

namespace rivulet {

// What a probe measures. The numbers are those of shaders/fluid/solids/probe_sum.h.
enum class ProbeOn : uint32_t { box = 0, plane = 1, still = 2, rigid = 3, deforming = 4, body = 5, none = 6 };

// An item of the list fluid.probes.
struct ProbeParams {
    std::string name;          // unlike all others'
    std::string on = "box";    // box | collider | body | plane | still | rigid | deforming
    std::string face = "all";  // of the box: all | -x | +x | -y | +y | -z | +z
    int index = -1;            // of those, of a body its id; -1 = all
    vec3 min{-1.0e5F};         // m, the region: only what acts between min and max counts
    vec3 max{1.0e5F};          // m
    vec3 about{0.0F};          // m, the point of the torque
    float area = 0.0F;         // m^2; 0 = that of the region on one face of the box, else no pressure is given
    void visit(ParamVisitor& v);
    bool operator==(const ProbeParams&) const = default;
};

// The load that one probe measured, in world axes.
struct ProbeReading {
    std::string name;
    dvec3 force{0.0};                // N, on the wall: mean over the frame
    dvec3 torque{0.0};               // N m, about ProbeParams::about: mean over the frame
    std::optional<double> pressure;  // Pa, along the wall's normal: mean over area and frame; empty: no area, or a body
    dvec3 impulse{0.0};              // N s, sum since the start, a reset, a restored state or a change of the probes
    dvec3 angularImpulse{0.0};       // N m s, likewise
};

// The loads of one frame: of the last `seconds` before `time`. Empty before the first frame, and in a world without probes.
struct ProbeFrame {
    double time = 0, seconds = 0;      // s simulated
    std::vector<ProbeReading> probes;  // in the order of fluid.probes
};

// What a collider of a host's list is in a world, for probes that name it by number.
struct SolidRef {
    ProbeOn on = ProbeOn::none;  // none: not solid
    uint32_t index = 0;          // of Solids::planes, surfaces, rigid or deforming
};

}  // namespace rivulet
