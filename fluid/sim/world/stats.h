// The figures of a world. On a GPU they are two or three frames late.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "fluid/sim/solids/probes.h"

namespace rivulet {

struct FluidStats {
    uint64_t frame = 0;         // of the figures below
    double time = 0;            // s simulated
    uint32_t particles = 0;     // all of them, frozen ones too; not free slots
    uint32_t lost = 0;          // left the grid or NaN: counted, frozen, indexed nowhere
    uint32_t nan = 0;           // of those, NaN or infinite
    uint32_t asleep = 0;        // of them: see fluid.sleep
    double emitted = 0;         // m^3, put in so far: blocks, what emitters let out, and particles spawned from deposits
    double deposited = 0;       // m^3, of that: particles spawned from deposits
    double pendingVolume = 0;   // m^3, deposited and not yet spawned
    double withdrawn = 0;       // m^3, by others
    double drained = 0;         // m^3, taken by sinks and dry volumes, and by walls that were added where it was
    double backlog = 0;         // m^3, due from emitters and held back: their opening is blocked, or there is no slot
    double avgCompression = 0;  // mean of max(rho / rho0 - 1, 0) over particles
    double maxCompression = 0;
    double kinetic = 0;    // J
    double potential = 0;  // J, against height 0
    double centreOfMass[3] = {0, 0, 0};
    double maxSpeed = 0;               // m/s
    uint32_t speedLimited = 0;         // particles whose speed the step had to limit
    int substeps = 0;                  // of that frame
    double iterations = 0;             // of the pressure solver, mean over those substeps; on a GPU over some frames earlier
    uint64_t sweeps = 0;               // over all neighbours, since the start: what a step costs, whatever the machine
    double stepped = 0;                // particles times substeps, since the start: without those asleep, late on a GPU
    std::optional<double> residual;    // mean compression after the last of them, as the solver predicts it; nothing: it predicts none
    double dtMin = 0, dtMax = 0;       // s, since the start
    uint64_t bodyWaits = 0;            // times that a GPU's loads or states of bodies were waited for, since the start; never late
    uint64_t bodyStrays = 0;           // bodies that moved further in a frame than foreseen while the GPU moved them, since the start
    ProbeFrame loads = {};             // what fluid.probes measured, of its own last frame
    std::vector<std::string> limited;  // sentences: what the program limited and why, each once
};

}  // namespace rivulet
