// Every array that belongs to a particle. Between steps the newest state is positionNext, velocityNext, id; a step sorts it into
// position, velocity, id (sorted by cell), computes, and integrates back into positionNext, velocityNext in the sorted order.
// What stays with a particle for its life is a table by id, and is gathered into sorted order after each sort.
#pragma once

#include <vector>

#include "engine/compute/device.h"
#include "engine/core/math.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

struct Particles {
    uint32_t count = 0;                 // slots: particles, free slots and the samples on bodies, whose ids are the last
    Buffer position, velocity;          // vec4: m, m/s; sorted, at the step's start
    Buffer positionNext, velocityNext;  // vec4; w: density / rest density (negative: a free slot), 1 where the speed was limited
    Buffer id, idNext;                  // uint; id goes with the newest state
    Buffer density;                     // float, density / rest density
    Buffer pressure;                    // float, what the method makes of it
    Buffer acceleration;                // vec4, m/s^2; of a sample: what it would be for a particle of the fluid
    Buffer nearWalls;                   // vec4, four a particle: see shaders/fluid/solids/near_walls.h
    Buffer normal;                      // vec4: of the surface (fluid/forces/normals), w its length; see hasNormals
    bool hasNormals = false;            // whether a force of the last substep filled `normal`
    // Where particles differ (PairTraits::matter). vec4: x volume / spacing^3; y reference rest density / own; z dynamic viscosity, Pa s;
    // w the liquid's row, or of a sample on body k: -1 - k.
    Buffer matterOf;  // by id
    Buffer matter;    // sorted
    // Where liquids or dyes differ, for drawing; as ParticleView::absorption.
    Buffer absorptionOf;  // by id
    Buffer absorption;    // in the order of the newest state, as of the last frame's end
    // vec4: the host's, as FluidParams::attributes.
    std::vector<Buffer> attributesOf;  // by id
    std::vector<Buffer> attributes;    // as absorption

    // `matter`: whether particles differ; `absorption`: whether they do to the eye; `attributes`: how many the host has.
    static Result<Particles> create(Device& device, uint32_t count, bool matter = false, bool absorption = false, size_t attributes = 0);

    // The newest state. Lost particles, and they alone, may be outside `inside` (m) or have values that are not finite: a section names
    // them.
    struct Saved {
        std::vector<vec4> position, velocity, matter, absorption;
        std::vector<std::vector<vec4>> attributes;  // empty: of a state without them
        std::vector<uint32_t> id;
    };
    void save(Device& device, WorldState& state, const Bounds& inside, uint32_t samples) const;
    // `samples`: the matter of the samples on bodies (BodyPasses::matter). Error (badInput): as WorldState::take; values that no particle
    // of this world can have; ids that are not each there once.
    Result<Saved> take(WorldState& state, const Bounds& inside, std::span<const vec4> samples) const;
    void restore(Device& device, const Saved& saved);
};

}  // namespace rivulet
