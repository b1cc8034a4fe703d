// Small worlds of every kind, each of some hundred particles and a few steps: for checks that are slow (an interpreter of OpenCL) or
// repeated (another order of the work items, other limits of a device). Together they run nearly every kernel that GPUs have.
#pragma once

#include <string>
#include <vector>

#include "engine/compute/device.h"

namespace rivulet::races {

// What a world came to.
struct Answer {
    std::vector<float> exact;  // the same bits in every order of the work items
    std::vector<float> near;   // sums and means, to `within` of the largest: where the order decides who takes a slot, or adds floats
    double within = 1.0e-3;
};

struct SmallWorld {
    const char* name;
    Answer (*run)(Device& device);
    bool onCpu = true;  // false: linked lists, which need a GPU
};
const std::vector<SmallWorld>& smallWorlds();

// In the environment, RIVULET_RACES=full runs what takes minutes, and RIVULET_WORLDS="flow rain" only these worlds.
bool full();
bool someChosen();
bool chosen(const SmallWorld& world);

}  // namespace rivulet::races
