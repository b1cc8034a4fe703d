// AirDrops: the drops in the air between skins, a world's water and the ground. A drop that comes down on the world's water goes into
// it; a particle of the world that comes down on a skin becomes drops. One mass: it is counted in picolitres.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fluid/flow/placed_flow.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

class AirDrops {
  public:
    struct Inputs {
        std::span<PlacedFlow* const> skins = {};  // the same ones in each step
        // Its water takes drops in, and its particles become drops: it was made with Sources::expectedDeposit. null: no water is there.
        FluidWorld* world = nullptr;
        vec3 gravity{0.0F, -9.81F, 0.0F};  // m/s^2
        std::span<const vec3> winds = {};  // m/s, of each skin
        double floor = 0;                  // m: a drop that falls below it is gone
        double time = 0;                   // s, when the step begins; where the skins are
    };
    // Moves all drops on by `seconds`, and takes particles that come down on a skin. Before the skins' own step and after the world's. What
    // it asks of the world's water and of the skins it reads back: on a GPU this waits. Error (failed): out of memory.
    Status step(const Inputs& inputs, double seconds);
    void add(const AirDrop& drop) { drops_.push_back(drop); }
    // From now on the skin that was number k in Inputs::skins is number places[k]. Nothing: it is gone; drops of it are lost, as drained.
    void renumber(std::span<const std::optional<uint32_t>> places);

    const std::vector<AirDrop>& drops() const { return drops_; }
    std::vector<vec4> drawn() const;  // the balls, as FluidView::drops
    // Those that have let go so lately that they are no balls yet.
    struct LetGo {
        HungDrop shape;
        uint32_t skin = 0;
    };
    std::vector<LetGo> letGo(std::span<PlacedFlow* const> skins) const;
    // Picolitres since the start, `air` now.
    struct Counts {
        uint64_t air = 0, drained = 0;   // drained: on the ground, or lost from sight
        uint64_t poured = 0, taken = 0;  // into the world and out of it
    };
    Counts counts() const;

  private:
    Status fall(const Inputs& inputs, double seconds);
    void takeLanding(const Inputs& inputs, double seconds);
    bool hasRoom(const Inputs& inputs, size_t skin, uint32_t count = 1);

    std::vector<AirDrop> drops_;
    std::vector<int64_t> room_;  // of each skin, drops that still find a slot in this step; -1: not asked yet
    uint64_t drained_ = 0, poured_ = 0, taken_ = 0;
    uint64_t particles_ = 0;  // taken
};

}  // namespace rivulet
