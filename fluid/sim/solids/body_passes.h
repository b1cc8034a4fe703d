// The passes of a step for bodies: positions of their samples, and the fluid's forces on them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/solids/bodies.h"
#include "fluid/sim/solids/body_contacts.h"
#include "fluid/sim/solids/body_forecast.h"
#include "fluid/sim/solids/body_states.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

// The bodies of a world, on its Device. In a substep: place, sort, index, then push as often as the method needs, and advance.
class BodyPasses {
  public:
    // Error (badInput): a body without samples, not finite, with mass but no inertia, a host without one of its functions, more samples
    // than params.maxBodySamples; (failed): out of memory. `host` empty: bodies move freely.
    static Result<BodyPasses> create(Device& device, std::span<const Body> bodies, const BodyHost& host, const FluidParams& params,
                                     const PairTraits& traits);

    // Creates the buffers that depend on the number of slots, including samples. Error: out of memory.
    Status allocate(uint32_t slots);

    // While the world runs: another body behind the others, or one less; the others keep their samples. `params`: as create. Error
    // (badInput): as create; the host has no function for it; no room for the samples; (failed): out of memory. Nothing has changed then.
    // place() and Particles::matterOf must follow. An exception of the host leaves the body where it is.
    Status add(const Body& body, uint32_t id, const FluidParams& params);
    Status remove(size_t body);
    static Status check(const Body& body);  // Error (badInput): no body is like this

    bool any() const { return !states_.empty(); }
    uint32_t sampleCount() const { return sampleCount_; }      // those that there is memory for
    const std::vector<uint32_t>& ids() const { return ids_; }  // of the bodies
    uint32_t nextId() const { return nextId_; }
    const Body& body(size_t body) const { return bodies_[body]; }
    Bounds boundsOf(size_t body) const;  // m, around it where it is
    // Whether `p` (m) is inside it, or inside one that was added; of a body without a distance: false.
    bool inside(size_t body, const vec3& p, float spacing) const;
    bool insideAdded(const vec3& p, float spacing) const;
    // True if a particle may be spawned at `p`: outside every body, and not nearer than its rest distance.
    bool maySpawn(const vec3& p, float spacing, float near = 1) const;  // `near` as of SolidPasses
    // The entries of Particles::matterOf for the samples; those of no body have a volume of 0.
    const std::vector<vec4>& matter() const { return matterRows_; }
    std::vector<vec4> matter(std::span<const uint32_t> first) const;  // where a saved state has them

    // As far as the host knows them: with isAhead(), where they are expected. settle() makes them exact.
    const std::vector<BodyState>& states() const { return states_; }
    std::vector<Pose> starts() const;                        // at t = 0
    float reach(size_t body) const { return reach_[body]; }  // m, from the centre of mass to the farthest sample
    // True if the body's surface has moved by more than `way` (m) from where it was at the pose `from`. A ball that turns has not moved.
    bool movedBy(size_t body, const Pose& from, float way) const;
    const std::vector<BodyLoad>& loads() const { return loads_; }  // of the last substep
    // m/s, speed of the fastest point of all bodies.
    float fastest() const;

    // Writes positionNext and velocityNext of the samples, wherever they are sorted.
    void place(const StepParams& step, Particles& particles);
    // After the sort.
    void index(const StepParams& step, const NeighborGrid& grid, Particles& particles);
    // As StepContext::pushSamples.
    void push(const StepParams& step, const NeighborGrid& grid, Particles& particles, const Buffer& position, const Buffer& pressures,
              float scale, const vec3& weight);
    // What probes read: of each sample its slot, its place in the body's frame (w: the body) and from its centre of mass; and the bodies.
    struct Samples {
        const Buffer *slotOf, *own, *arm, *bodies;
    };
    Samples samples() const { return {&slotOf_, &own_, &arm_, &deviceBodies_}; }
    // A frame of up to `seconds` begins. On a GPU it finds the contacts (BodyHost::contacts) with which the GPU moves the bodies, and does
    // not wait.
    void beginFrame(const vec3& gravity, double seconds);
    // Sums the forces and moves the bodies: on the GPU, or it waits for the forces (some KB, one round trip) and calls the host.
    void advance(const StepParams& step, Particles& particles, double seconds);
    void endFrame(double time);                           // s, of the world
    bool isAhead() const { return ahead_ && !settled_; }  // the GPU has moved them, and states() and loads() are not exact
    // Makes states() and loads() exact: waits if isAhead().
    void settle();
    BodyRows rows() const;
    // FluidWorld::bodiesAt; `time` is not now.
    std::optional<std::vector<BodyState>> statesAt(double time) const;
    uint64_t waits() const { return waits_; }    // of all functions here on a GPU, so far
    uint64_t strays() const { return strays_; }  // bodies that moved further than foreseen while they were free: on a GPU, late
    // The body for which the host last returned a state that is not finite; the body has kept its state.
    std::optional<size_t> misled() const { return misled_; }
    // Back to t = 0.
    void reset();

    // Poses of bodies, their pending loads, and the state of their host.
    struct Saved {
        std::vector<BodyState> states;
        std::vector<BodyLoad> loads;
        std::vector<std::byte> host;
        std::vector<uint32_t> first;  // sample of each body
    };
    // Error (failed): the host has a state that it cannot save.
    Status savable() const;
    void save(WorldState& state) const;
    // Error: as WorldState::take; other bodies, or invalid values.
    Result<Saved> take(WorldState& state) const;
    // Error (badInput): from the host; then nothing has changed.
    Status restore(const Saved& saved);

  private:
    uint64_t shapesHash() const;
    static uint32_t samplesOf(const Body& body);
    uint32_t samplesOf(size_t body) const { return samplesOf(bodies_[body]); }
    bool anyMeets() const;                 // the water
    std::vector<uint32_t> packed() const;  // first samples without gaps
    Status makeRoom(size_t bodies);        // on the device
    void upload();                         // of all bodies, where their samples are
    void fillMatter(std::span<const uint32_t> first, std::span<vec4> rows) const;
    void append(Body body, uint32_t id, uint32_t first, std::vector<float> volumes);  // allocates nothing after reserve()
    void reserve(size_t bodies);
    // States that arrive late.
    struct Late {
        BodyForecast forecast;
        std::vector<uint32_t> faults;  // of each body, that arrived since they were last looked at
        BodyStates states;
        double crowdedUntil = -1;  // s: until then more may touch than a GPU moves
        double heldUntil = -1;     // s: until then pulls act
        ContactRows moved = {};    // the contacts whose states contactStates_ has: of the last substep
        double step = 0;           // s, that substep's length
    };
    void writeStates();  // to the device
    void writeMotions(std::span<const vec4> balls);
    // The contacts of a frame; false: only the host can move the bodies, or there is no memory for them.
    bool findContacts(const vec3& gravity, double seconds);
    bool uploadContacts();
    void moveOnDevice(const StepParams& step);    // by a substep
    void stay();                                  // the host moves the bodies from states() on
    void take(std::span<const DeviceBody> rows);  // the states and loads there

    Device* device_ = nullptr;
    std::vector<Body> bodies_;
    std::vector<BodyState> states_;
    std::vector<BodyLoad> loads_;
    std::optional<size_t> misled_;
    std::vector<float> reach_;
    BodyLoads filter_{{}, FluidParams{}};
    std::shared_ptr<FreeBodies> free_;  // used if there is no other host
    BodyHost host_;
    uint32_t sampleCount_ = 0;
    std::vector<uint32_t> ids_;
    uint32_t nextId_ = 0;
    size_t startCount_ = 0;                    // the first bodies are those of create()
    std::vector<uint32_t> first_;              // sample of each body
    std::vector<std::vector<float>> volumes_;  // of each body's samples, over spacing^3
    std::vector<DeviceBody> uploaded_;
    std::vector<vec4> ownRows_, matterRows_;  // of own_; matter()
    size_t room_ = 0;                         // bodies that there is memory for
    Buffer own_, arm_, slotOf_, wet_, rows_, deviceBodies_, motions_;
    Buffer pairs_, contacts_, colours_, contactStates_, contactsBefore_;  // of advance_touching
    Kernel place_, index_, wetSamples_, push_, sumLoads_, advance_, touch_;
    std::vector<BodyMotion> motionRows_;
    ContactRows touching_;         // of this frame
    std::vector<BodyPull> pulls_;  // of this frame
    // On a GPU: what is known of bodies that it moves. Replaced where reads in flight must no longer arrive.
    std::shared_ptr<Late> late_;
    bool mayBeAhead_ = false;              // a GPU, and a host that allows it
    bool ahead_ = false, settled_ = true;  // the GPU moves them; states_ and loads_ are exact nevertheless
    double time_ = 0;                      // s, moved so far
    std::vector<BodyLoad> pushed_;         // N s, N m s, of each body by loads since pushedFrom_ (s), while the host moved them
    double pushedFrom_ = 0;
    double frameBegin_ = 0;  // s, of the last frame in which the GPU moved them
    bool frameBegins_ = false;
    uint64_t waits_ = 0, strays_ = 0;
    bool friction_ = false;
    float spacing_ = 0;  // m, of the fluid
};

}  // namespace rivulet
