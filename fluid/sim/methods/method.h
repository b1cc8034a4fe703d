// A Method advances particles by one substep: their positions and velocities as if there were no solids. Methods are rows of methods().
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
    bool doesViscosity = false;  // of forces: MethodRow::doesViscosity
};

// A buffer that a method keeps between steps, with a name of its own: at most 20 letters.
struct NamedBuffer {
    const char* name;
    Buffer* buffer;    // of floats
    bool byId = true;  // one value a particle, 0 for a new one; else not per particle
};

class Method {
  public:
    virtual ~Method() = default;
    // Fills the method's part of StepParams (kernel factors, stiffness). `fastest`: the speed the scene's water can reach by falling, m/s.
    virtual void fill(const FluidParams& params, float fastest, StepParams& step) const = 0;
    // Speed of sound of its equation of state, m/s, 0 where there is none.
    virtual float soundSpeed(const FluidParams& params, float fastest) const = 0;
    // How far the fastest particle may go in a step, in spacings, and the longest step, s, with the reason. `fastest`: as in fill.
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
    // All that a step depends on beside particles, params and solids. The world saves it, restores it, and fills it with 0 at t = 0.
    virtual std::vector<NamedBuffer> remembered() { return {}; }
    // Resets the estimates of a solver's iterations: the world begins at t = 0.
    virtual void reset() {}
};

// A method is a pair of files method_NAME.h (its Params and its row's function) and .cpp, and its kernels; a line of methods.cpp, and where
// it has Params a member of FluidParams. What the program asks of a method is here: its name is compared nowhere.
struct MethodRow {
    const char* name;
    const char* doc;
    // Error (badInput): it cannot do what the world asks for.
    Result<std::unique_ptr<Method>> (*make)(Device& device, const MethodSetup& setup);
    // It computes explicit viscosity among its own pair forces; else the force viscosity does.
    bool doesViscosity = false;
    // An equation of state gives it a speed of sound, which limits its steps (fluid.cfl) and how far bodies push the fluid in one.
    bool hasSound = false;
    bool linkedLists = false;  // it runs on fluid.grid linked_list
    // The least substeps in a sixtieth of a second.
    int (*leastSubsteps)(const FluidParams& params) = [](const FluidParams&) { return 1; };
    // Its own Params, a group of the "fluid" section; none: it has none.
    void (*visit)(FluidParams& params, ParamVisitor& v) = nullptr;
};
Table<MethodRow> methods();
const MethodRow& methodOf(const FluidParams& params);  // params.method must be a name of methods()

}  // namespace rivulet
