// The states of bodies that a GPU moves: on the device now, and those of earlier frames, which have arrived.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/solids/bodies.h"

namespace rivulet {

// Rows of DeviceBody (shaders/fluid/solids/body_state.h), in the order of FluidWorld::bodyIds.
struct BodyRows {
    const Buffer* rows = nullptr;  // valid as a ParticleView; null: the host moves the bodies in each step
    uint32_t count = 0;
    bool current = false;  // the GPU has moved the bodies in the last step; else the host has, and knows where they are
};

// The states at the ends of the last frames.
class BodyStates {
  public:
    void keep(double time, std::vector<BodyState> states);  // of the world's time, s
    std::optional<std::vector<BodyState>> at(double time) const;

  private:
    static constexpr size_t kKept = 32;  // frames: a picture is at most three pictures late, and several frames may pass between two
    std::deque<std::pair<double, std::vector<BodyState>>> kept_;
};

}  // namespace rivulet
