// Bodies that the fluid pushes, and that push it: boundary particles on their surface (Akinci et al. 2012), and the host that moves them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/result.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/pose.h"

namespace rivulet {

// A point of a surface, m, and its outward normal, unit.
struct ShellPoint {
    vec3 place{0.0F}, normal{0.0F};
};

// A body's own frame has its origin at the centre of mass and its axes along the principal axes of inertia.
struct BodyShape {
    std::vector<vec3> samples;  // m, half a spacing of the fluid under the surface, about a spacing apart
    float mass = 0;             // kg; 0: it never moves
    vec3 inertia{0.0F};         // kg m^2, about the own axes
    float volume = 0;           // m^3, of water it displaces when it is under
    float sticks = 0;           // 1: fluid sticks to it (no-slip), 0: it slips
    // Distance (m) of a point of the own frame from the surface, negative inside. May be empty: then no fluid is left out.
    std::function<float(const vec3&)> distance = {};
    // Points all over the surface, `apart` (m) from each other or nearer. May be empty: then it does not get wet (fluid.wetness).
    std::function<std::vector<ShellPoint>(float apart)> shell = {};
};

struct BodyState {
    Pose pose;
    vec3 velocity{0.0F};  // m/s, of the centre of mass
    vec3 spin{0.0F};      // rad/s, world
    vec3 velocityAt(const vec3& p) const { return velocity + glm::cross(spin, p - pose.position); }
};

struct Body {
    BodyShape shape;
    BodyState state;         // at t = 0
    bool meetsWater = true;  // false: the water passes through it, and its load is 0
};

// What the fluid does to a body in a substep: force, N, and torque about the centre of mass, N m, in the world's axes.
struct BodyLoad {
    dvec3 force{0.0}, torque{0.0};
    dvec3 pendingImpulse{0.0}, pendingAngularImpulse{0.0};  // N s, N m s: transferred in later substeps, see BodyLoads
};

// A contact that may act in a frame, between body a and body b, or between body a and a solid. It names a point of each of the two
// surfaces: those that are nearest to each other there. The surfaces may be apart or overlap.
struct BodyContact {
    static constexpr uint32_t kSolid = UINT32_MAX;  // a wall or solid that the host knows
    uint32_t a = 0, b = kSolid;                     // places among the states
    // m: in the frame of a; in that of b, of a solid in the world when the frame begins. With a radius above 0 the surface there is a ball
    // of this radius, and the point is its centre.
    vec3 onA{0.0F}, onB{0.0F};
    float radiusA = 0, radiusB = 0;  // m
    // Unit, from b to a: in the frame of b (of a, where b is a body with a radius), of a solid in the world. During the frame the surface
    // of b is taken for an infinite plane through onB: of a body that moves past b, give the contact at the place where they come nearest
    // to each other in the frame; otherwise the plane may stop it.
    vec3 normal{0.0F};
    // Of a solid that moves in the frame: m/s and rad/s, as it turns about a point (m, in the world, when the frame begins); s, how long.
    vec3 velocityB{0.0F}, spinB{0.0F}, centreB{0.0F};
    float secondsB = 0;
    float friction = 0.5F, restitution = 0;  // Coulomb; 0 to 1
};

// A hand that holds a body in a frame: it pulls one of its points by a critically damped spring, carries its weight and calms its spin.
// The law is in shaders/fluid/solids/body_pull.h, for hosts and GPUs.
struct BodyPull {
    uint32_t body = 0;  // place among the states
    vec3 at{0.0F};      // m, in the body's frame
    vec3 to{0.0F};      // m, in the world
    float rate = 30;    // 1/s: the spring's; in longer steps it is softer
    float most = 200;   // m/s^2: the spring pulls with no more than this times the mass
};

// Moves the bodies: functions that a host fills in. advance, called once a substep, and reset: both or neither. Loads and states are those
// of all bodies, in the order of FluidWorld::bodyIds.
struct BodyHost {
    void* self = nullptr;
    // Moves all bodies by `seconds` under the fluid's `loads`, its own contacts and `gravity` (m/s^2). `states`: as they are -> as they
    // are then.
    void (*advance)(void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds,
                    std::span<BodyState> states) = nullptr;
    // Back to `states`, those at t = 0; of a body that was added later, its state then.
    void (*reset)(void* self, std::span<const BodyState> states) = nullptr;
    // For a world that is saved: whether advance depends on its arguments alone. Else the host needs the other two, or its world cannot be
    // saved.
    bool remembersNothing = false;
    // All that advance depends on beside its arguments.
    std::vector<std::byte> (*save)(void* self) = nullptr;
    // Continues from there; the bodies are in `states`. Error (badInput): the bytes are not valid; then nothing has changed.
    Status (*restore)(void* self, std::span<const std::byte> bytes, std::span<const BodyState> states) = nullptr;
    // For bodies that are added and removed while the world runs, else that is refused: both, or neither. `id`: of FluidWorld::addBody; the
    // body is the last of the next states. `index`: of the removed one among the states until now. If one throws, nothing changes.
    void (*added)(void* self, uint32_t id, const Body& body) = nullptr;
    void (*removed)(void* self, uint32_t id, size_t index) = nullptr;
    // On a GPU a step waits for the loads before each call of advance. With these two functions (both, or neither) it does not: the GPU
    // moves the bodies, and the host learns of it some frames late. contacts is called once or twice in a frame; on the cpu never. It adds
    // to `found` all contacts that may act in the next `seconds`, while the bodies are about in `states` and their centres of mass stay in
    // their balls (xyz m, w m, the radius). No contacts: they move as FreeBodies does it. False: only the host can move them in this frame.
    // After true `passed` is called for each substep, instead of advance, unless more than 384 bodies have contacts or memory is full.
    bool (*contacts)(void* self, std::span<const BodyState> states, std::span<const vec4> balls, double seconds,
                     std::vector<BodyContact>& found) = nullptr;
    void (*passed)(void* self, double seconds) = nullptr;
    // May be null. Called before contacts: adds what pulls at bodies in this frame, at most one pull for each. It needs predict, which must
    // pull as well, as advance does.
    void (*pulls)(void* self, std::vector<BodyPull>& found) = nullptr;
    // May be null; then bodies are expected to move freely. As advance, from `from` (s, before now where negative) on, without an effect on
    // later calls: where bodies will be under loads as they lately were.
    void (*predict)(void* self, std::span<const BodyLoad> loads, const vec3& gravity, double from, double seconds,
                    std::span<BodyState> states) = nullptr;
};

// A host for worlds where bodies touch nothing but fluid: rigid motion, symplectic Euler, momentum and angular momentum kept.
class FreeBodies {
  public:
    explicit FreeBodies(std::span<const Body> bodies);
    BodyHost host();  // the FreeBodies must outlive its use

  private:
    void add(const Body& body);
    struct Own {
        double mass;
        dvec3 inertia;
    };
    std::vector<Own> own_;
};

// Filters the loads of the fluid on bodies. The load depends on the body's acceleration in the step before (added mass). Without a filter,
// a body lighter than about the fluid that moves with it oscillates with growing amplitude (Causin, Gerbeau and Nobile 2005). Therefore a
// fictitious mass a is added (Baek and Karniadakis 2012), and the rest of the load is pending: (m + a) F' = m (F + pending),
// pending = F + pending - F'. Momentum is conserved, and for a steady load F' = F.
// With a compressible method (wcsph) only the fluid that sound reaches in a step responds one step late: the layer of particles next to the
// samples. A larger fictitious mass delays the body, too, and it then throws water off: a box half as dense as water had 0.44 of itself
// under water instead of 0.5.
class BodyLoads {
  public:
    BodyLoads(std::span<const Body> bodies, const FluidParams& params);
    void add(const Body& body, const FluidParams& params);  // behind the others
    void remove(size_t body);
    // Returns the filtered load of a substep of `seconds`; `wet`: share of the surface that is in the fluid, 0..1.
    BodyLoad transfer(size_t body, const dvec3& force, const dvec3& torque, double wet, double seconds);
    void restore(std::span<const BodyLoad> last);  // what transfer returned last, of each
    void reset();
    double added(size_t body) const { return own_[body].added; }  // the fictitious mass of a body that is wet all over, over its mass

  private:
    struct Own {
        double added;  // mass of the fluid moved along, over the body's
        BodyLoad last;
    };
    std::vector<Own> own_;
};

// The volume (over spacing^3) each sample stands for: gamma / sum of W over the body's samples (Akinci et al. 2012), gamma such that fluid
// whose lattice begins half a spacing off the surface, one off a plane of samples, is at rest density. Samples lie that deep because nearer
// ones would have to be so light for it that their gradient, which falls towards the plane, could not carry the fluid's pressure: it
// leaked. Kernel and spacing of `params`.
std::vector<float> sampleVolumes(std::span<const vec3> samples, const FluidParams& params);

}  // namespace rivulet
