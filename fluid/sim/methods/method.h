// A Method advances particles by one substep: where they would be, and how fast, if no solid were in the way. Methods are rows of
// methods().
#pragma once

#include <memory>
#include <vector>

#include "engine/core/table.h"
#include "fluid/sim/world/step_context.h"

namespace rivulet {

// What a Method is made for.
struct MethodSetup {
    const FluidParams& params;
    uint32_t count;  // slots of particles
    PairTraits traits;
    bool doesViscosity = false;  // of forces: whether the method has viscosity among its own pair forces
};

// What a method remembers of earlier steps, by a name of its own: at most 20 letters.
struct NamedBuffer {
    const char* name;
    Buffer* buffer;    // of floats
    bool byId = true;  // of the particles: 0 for one that is born; else in no particle's order
};

class Method {
  public:
    virtual ~Method() = default;
    // Fills the method's part of StepParams (kernel factors, stiffness). `fastest`: the speed the scene's water can reach by falling, m/s.
    virtual void fill(const FluidParams& params, float fastest, StepParams& step) const = 0;
    // Speed of sound of its equation of state, m/s, 0 where there is none.
    virtual float soundSpeed(const FluidParams& params, float fastest) const = 0;
    // Whether it does explicit viscosity among its own pair forces; else the row of forces() does.
    virtual bool doesViscosity() const { return false; }
    // How far the fastest particle may go in a step, in spacings, and the longest step, s, with what says so. `fastest`: as in fill.
    struct StepLimit {
        float reach = 1;
        double longest = 1;
        const char* why = "the method's fewest steps a frame (minSubsteps)";
    };
    virtual StepLimit stepLimit(const FluidParams& params, float fastest) const = 0;
    // positionNext, velocityNext as they are -> a substep later, in sorted order; positionNext's w the density ratio. It calls build, once.
    virtual void step(StepContext& context) = 0;
    // Called at a frame's end: makes w of positionNext the density ratio of the positions as they are, where step() left an earlier one.
    virtual void measure(StepContext&) {}
    // Whether it moves particles before it sorts them.
    virtual bool predicts() const { return false; }
    // The pressures of the last step, Pa, slot by slot in the order of the newest state; reads them back and waits. `step`: its params.
    virtual std::vector<float> pressures(Device& device, const Particles& particles, const StepParams& step) const = 0;
    // All that a step depends on beside particles, params and solids. The world saves it, puts it back, and fills it with 0 at t = 0.
    virtual std::vector<NamedBuffer> remembered() { return {}; }
    // What was learnt of a solver's pace: the world begins again.
    virtual void forget() {}
};

struct MethodRow {
    const char* name;
    const char* doc;
    // Error (badInput): it cannot do what the world asks for.
    Result<std::unique_ptr<Method>> (*make)(Device& device, const MethodSetup& setup);
};
Table<MethodRow> methods();

}  // namespace rivulet
