// AirDrops: the drops in the air between skins, a world's water and the ground. A drop that comes down on the world's water goes into
// it; a particle of the world that comes down on a skin becomes drops. One mass: it is counted in picolitres.
//
// On a GPU no exchange waits: the world answers two or three frames late. A drop flies on meanwhile; where its way ends before the answer,
// on a skin or on the ground, it stays in sight there until then. Particles are known from a list that is as old, and are moved on as
// bodies that fall; one that now comes down on a skin is claimed by its id. Until the world reports that it removed the particle, a ball is
// drawn in its place, and counts() leaves it out, as the world's figures still have it.
#pragma once

#include <deque>
#include <map>
#include <memory>
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
    // Moves all drops on by `seconds`, and takes particles that come down on a skin. Before the skins' own step and after the world's.
    // Waits only for the shape of a skin that a GPU bends: until its first report, and where the GPU is 0.1 s behind
    // (SurfaceFlow::shape). Error (failed): out of memory.
    Status step(const Inputs& inputs, double seconds);
    void add(const AirDrop& drop);
    // The same drops and counts, which later steps of this one do not change. The device must have finished and been polled.
    AirDrops copy() const;
    // From now on the skin that was number k in Inputs::skins is number places[k]. Nothing: it is gone; drops of it are lost, as drained.
    void renumber(std::span<const std::optional<uint32_t>> places);

    const std::vector<AirDrop>& drops() const { return drops_; }
    std::vector<vec4> drawn() const;    // the balls, as FluidView::drops; with those of particles that are claimed
    std::vector<vec4> claimed() const;  // those alone
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
    // About the water at places along the ways of drops.
    struct Question {
        struct Way {
            uint64_t drop = 0;
            size_t begin = 0, count = 0;
            double until = 2;  // share of it: where a skin ends it
        };
        std::vector<Way> ways;
        std::vector<vec3> places;
        std::vector<float> full;  // the answer: density ratios
        bool answered = false;
    };
    // Particles near skins.
    struct List {
        double time = 0;  // s
        std::vector<WorldParticle> particles;
    };
    // A particle that comes down on a skin, and what becomes of it.
    struct Claim {
        struct Part {
            AirDrop drop;
            std::optional<size_t> lands = {};  // the skin
            SkinSearch::Hit where = {};
        };
        dvec3 position{0.0}, velocity{0.0};  // m, m/s
        double radius = 0;                   // m
        std::vector<Part> parts;
    };
    struct Claims {
        std::vector<Claim> all;
        std::vector<uint32_t> removed;  // the answer
        bool answered = false;
    };
    Status fall(const Inputs& inputs, double seconds);
    std::vector<std::optional<vec3>> wetPlaces();
    void listParticles(const Inputs& inputs, double seconds);
    void takeLanding(const Inputs& inputs, double seconds);
    void spread(const Inputs& inputs, const dvec3& from, const FirstMet& first, uint32_t count, double then, Claim& into);
    void landClaimed(const Inputs& inputs);
    bool hasRoom(const Inputs& inputs, size_t skin, uint32_t count = 1);
    uint64_t volumeOf(uint64_t particles) const;

    std::vector<AirDrop> drops_;  // in the order of their numbers
    uint64_t numbers_ = 0;
    std::vector<int64_t> room_;  // of each skin, drops that still find a slot in this step; -1: not asked yet
    uint64_t drained_ = 0, poured_ = 0, taken_ = 0;
    uint64_t particles_ = 0;  // taken
    double spacing_ = 0;      // m, of them
    // Shared with reads in flight.
    std::deque<std::shared_ptr<Question>> questions_;
    uint64_t answered_ = 0;  // the number of the first of questions_
    std::shared_ptr<std::optional<List>> list_ = std::make_shared<std::optional<List>>();
    std::deque<std::shared_ptr<Claims>> claims_;
    double testedTo_ = 0;                   // s: up to then paths of particles have been tested
    std::map<uint32_t, double> claimedAt_;  // s, of ids, as long as older lists may arrive
};

}  // namespace rivulet
