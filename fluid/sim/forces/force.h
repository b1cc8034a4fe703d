// Forces other than pressure and gravity: rows, each with its own passes, which run only if the scene enables the force.
#pragma once

#include <functional>

#include "engine/core/table.h"
#include "fluid/sim/methods/method.h"

namespace rivulet {

// Adds to particles.acceleration (m/s^2) of the fluid and of the samples on bodies. Its buffers live in the closure; its sums must not
// depend on earlier steps: a saved state would lack them.
using ForcePass = std::function<void(StepContext&)>;

// The longest step that is stable, s, and what limits it: the end of "their length limited by ...".
struct StepLimit {
    double dt = 1.0e30;
    const char* why = "";
};

// What a force's step limit may depend on.
struct ForceLimitInputs {
    const FluidParams& params;
    float h;             // m, support radius
    bool doesViscosity;  // MethodRow::doesViscosity
    float mostViscous;   // m^2/s, the largest of a pair of the world's liquids; 0: all particles are alike
    float artificial;    // m^2/s, StepParams::artificial: the method's artificial viscosity
};

// A force is a pair of files force_NAME.h and .cpp and its kernels. The header has a namespace force_NAME with its Params, which become
// keys of fluid.forces, and row(). CMakeLists.txt lists the headers; nothing else names a force.
struct ForceRow {
    const char* name;
    const char* doc;
    int order;           // forces run from the smallest on
    const char* remedy;  // how it is turned off, as a half sentence of an error: "set fluid.forces.tension to 0"
    // Whether these Params turn it on; `doesViscosity`: MethodRow::doesViscosity. Called before every frame; the pass is made when it is
    // first on.
    bool (*on)(const FluidParams& params, bool doesViscosity);
    Result<ForcePass> (*make)(Device& device, const MethodSetup& setup);
    StepLimit (*limit)(const ForceLimitInputs& inputs) = nullptr;  // none: it limits no step. Called whether it is on or not
    float (*fastest)(const FluidParams& params) = nullptr;         // m/s, as HostForce::fastest
    float (*pressure)(const FluidParams& params) = nullptr;        // Pa, the most that it causes inside the fluid; none: little
    // True: no water may sleep while the force is on, because its kernels read values of neighbours that sleeping particles do not have.
    bool keepsAwake = false;
};
Table<ForceRow> forces();  // by `order`

// StepParams of a force's kernels: the factors of Wendland's kernel, whichever kernel the method has, and `force`.
StepParams forceParams(const StepContext& context, const vec4& force);

// A force of the host's own, handed to FluidWorld::create: it runs beside the rows of forces(), before viscosity. Its kernel is a text like
// any other (shaders/common/lang.h): a GPU's device is made with ShaderFiles to which it was added, the cpu's with a CpuKernelRow of the
// same text compiled as C++ (docs in README.md). Params of its own are the host's: no saved state has them.
struct HostForce {
    const char* name = "";  // unlike all others'
    const char* doc = "";
    void* self = nullptr;  // handed to all of these; outlives the world
    // Whether it is on now; none: always. Asked before every frame.
    bool (*on)(void* self, const FluidParams& params) = nullptr;
    // As ForceRow::make. Pass: it adds to particles.acceleration from position and velocity, sorted; StepParams::force is free for it.
    Result<ForcePass> (*make)(void* self, Device& device, const MethodSetup& setup) = nullptr;
    // m/s, the fastest that it drives water; none: no faster than a fall. Speeds are limited to ten times the largest of all these, and
    // that is reported.
    float (*fastest)(void* self) = nullptr;
    void (*visit)(void* self, ParamVisitor& v) = nullptr;  // its Params; none: it has none
};

}  // namespace rivulet
