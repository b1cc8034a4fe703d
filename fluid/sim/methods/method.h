// A Method advances particles by one substep: their positions and velocities as if there were no solids. Methods are rows of methods().
#pragma once

#include <memory>
#include <vector>

#include "engine/core/table.h"
#include "fluid/sim/world/step_context.h"

namespace rivulet {

// The values that a Method is created for.
struct MethodSetup {
    const FluidParams& params;
    uint32_t count;  // slots of particles
    PairTraits traits;
    bool doesViscosity = false;  // of forces: MethodRow::doesViscosity
    bool closed = false;         // the liquid starts without a free surface
};

// A buffer that a method keeps between steps. Its name is unique and has at most 20 letters.
struct NamedBuffer {
    const char* name;
    Buffer* buffer;    // of floats
    bool byId = true;  // one value a particle, 0 for a new one; else not per particle
};

// What the pair forces read of a particle that sleeps, slot by slot, beside its position and density; its velocity is 0.
struct AsleepPressure {
    const Buffer* from = nullptr;  // floats; times `scale`: pressure over density, m^2/s^2. Its mean over the last steps is what stays
    Buffer* to = nullptr;          // floats: that mean times `back`
    float scale = 1, back = 1;
};
struct AsleepValue {
    const Buffer* from;  // floats, kept as they are when a particle falls asleep; null: `to` is 0
    Buffer* to;
};
struct AsleepValues {
    AsleepPressure pressure{};
    std::vector<AsleepValue> others;
};

class Method {
  public:
    virtual ~Method() = default;
    // Fills the method's part of StepParams (kernel factors, stiffness). `fastest`: the speed that a fall in the scene can reach, m/s.
    virtual void fill(const FluidParams& params, float fastest, StepParams& step) const = 0;
    // Speed of sound of the equation of state, m/s; 0 if the method has none.
    virtual float soundSpeed(const FluidParams& params, float fastest) const = 0;
    // The longest path of the fastest particle in a step, in spacings, and the longest step, s, with the reason. `fastest`: as in fill.
    struct StepLimit {
        float reach = 1;
        double longest = 1;
        const char* why = "the method's fewest steps a frame (minSubsteps)";
    };
    virtual StepLimit stepLimit(const FluidParams& params, float fastest) const = 0;
    // Advances positionNext and velocityNext by a substep, in sorted order; w of positionNext becomes the density ratio. Calls build once.
    virtual void step(StepContext& context) = 0;
    // Called at the end of a frame: sets w of positionNext to the density ratio of the current positions, if step() left an earlier one.
    virtual void measure(StepContext&) {}
    // True if it moves particles before it sorts them.
    virtual bool predicts() const { return false; }
    // The pressures of the last step, Pa, slot by slot in the order of the newest state; reads them back and waits. `step`: its params.
    virtual std::vector<float> pressures(Device& device, const Particles& particles, const StepParams& step) const = 0;
    // All data that a step depends on in addition to particles, params and solids. The world saves and restores it, and fills it with 0 at
    // t = 0.
    virtual std::vector<NamedBuffer> remembered() { return {}; }
    // The values of sleeping particles. `step`: of the last substep. Without pressures: the method does not support fluid.sleep.
    virtual AsleepValues asleepValues(Particles&, const StepParams&) { return {}; }
    // A setting with which no water may fall asleep, "fluid.pbf.tolerance is above 0"; null: there is none.
    virtual const char* keepsAwake(const FluidParams&) const { return nullptr; }
    // Resets the estimates of a solver's iterations: the world begins at t = 0.
    virtual void reset() {}
};

// A method is a pair of files method_NAME.h (its Params and its row's function) and .cpp, and its kernels; a line of methods.cpp, and a
// member of FluidParams if it has Params. This row is all that the program reads of a method; names are not compared.
struct MethodRow {
    const char* name;
    const char* doc;
    // Error (badInput): the method does not support a feature of the world.
    Result<std::unique_ptr<Method>> (*make)(Device& device, const MethodSetup& setup);
    // True if the method computes explicit viscosity in its own pair forces; otherwise the force `viscosity` does.
    bool doesViscosity = false;
    // True if an equation of state defines a speed of sound, which limits the steps (fluid.cfl) and the path of bodies in a step.
    bool hasSound = false;
    bool linkedLists = false;  // it runs on fluid.grid linked_list
    bool keepsPairs = true;    // on a GPU its first sweep keeps which neighbours are within reach (shaders/fluid/grid/neighbors.h)
    // The smallest number of substeps in a sixtieth of a second.
    int (*leastSubsteps)(const FluidParams& params) = [](const FluidParams&) { return 1; };
    // Its own Params, a group of the "fluid" section; none: it has none.
    void (*visit)(FluidParams& params, ParamVisitor& v) = nullptr;
};
Table<MethodRow> methods();
const MethodRow& methodOf(const FluidParams& params);  // params.method must be a name of methods()

}  // namespace rivulet
