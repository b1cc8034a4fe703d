// Small worlds of every kind, each of some hundred particles and a few steps: for checks that are slow (an interpreter of OpenCL) or
// repeated (another order of the work items, other limits of a device). Together they run nearly every kernel that GPUs have.
#pragma once

#include <initializer_list>
#include <ostream>
#include <string>
#include <string_view>
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

// For parameters of tests.
struct WorldOn {
    const char* device;  // "cpu", "gl", "cl"
    const SmallWorld* world;
};
std::string nameOf(const WorldOn& on);  // of a test: "gl_dfsph"
std::ostream& operator<<(std::ostream& to, const WorldOn& on);
// Each world on each device that can run it, of those that RIVULET_WORLDS chooses and that are `wanted`.
std::vector<WorldOn> worldsOn(std::initializer_list<const char*> devices, bool (*wanted)(std::string_view device, std::string_view world));

// Fails the test where the other answer differs: in a bit of what is exact, or by more than `within` in what is near.
void expectSame(const Answer& plain, const Answer& other);

// In the environment, RIVULET_RACES=full runs what takes minutes, and RIVULET_WORLDS="flow rain" only these worlds.
bool full();
bool someChosen();
bool chosen(const SmallWorld& world);

}  // namespace rivulet::races
