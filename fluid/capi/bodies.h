// The bodies of a host's world: each has an id, and the samples of one that is given as a mesh are found at the start or beside the frames.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/background.h"
#include "engine/core/jobs.h"
#include "engine/core/result.h"
#include "fluid/capi/callbacks.h"
#include "fluid/capi/rivulet.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet::capi {

class Bodies {
  public:
    Bodies() = default;
    Bodies(const Bodies&) = delete;  // the world has a pointer to it
    Bodies& operator=(const Bodies&) = delete;

    // Those of the options, into `to`, moved by the host's functions or freely. `callback`: of the context. Errors as rivulet_world_create.
    Status begin(const rivulet_world_options& o, const FluidParams& fluid, const Jobs& jobs, size_t memoryLimit, Callback& callback,
                 Solids& to);

    // Another one. Its id, or an error as FluidWorld::addBody. One with a mesh is in the world when it is ready: arrive().
    Result<uint32_t> add(FluidWorld& world, const rivulet_body& body);
    Status remove(FluidWorld& world, uint32_t id);
    // Brings bodies that are ready into the world. Returns sentences about those that could not be.
    std::vector<std::string> arrive(FluidWorld& world);

    // Its place among FluidWorld::bodyIds. Nothing: it is not in the world yet. Error (badInput): there is none; why it never will be.
    Result<std::optional<size_t>> placeOf(const FluidWorld& world, uint32_t id) const;
    rivulet_body_state stateOf(size_t place, const BodyState& state) const;

    Status thrown();  // the error of a function of the host in this call: what it threw, or a contact that cannot be
    void forget() { thrown_.clear(); }

  private:
    struct Made {
        BodyShape shape;
        Pose frame;  // of the body's own frame in that of its mesh
    };
    struct Waiting {
        uint32_t id = 0;
        Body body;  // its pose is that of the mesh's frame
        std::unique_ptr<Background<Made>> make;
        std::string failure;
    };
    // What is read of a host's struct, and what remains to be made of its mesh: empty if nothing does.
    struct Read {
        Body body;
        std::function<Result<Made>()> make;
    };
    Result<Read> read(const rivulet_body& given, const std::string& name, bool bakes) const;
    static void finish(Body& body, Made made);
    Status enter(FluidWorld& world, uint32_t id, const Body& body, const Pose& frame);
    template <class Call>
    void callHost(const char* name, const char* then, const Call& call);
    void fail(const std::string& sentence, const char* then);
    BodyHost host();
    void toStates(std::span<const BodyState> from);
    void toLoads(std::span<const BodyLoad> from);
    void fromStates(std::span<BodyState> to) const;
    Result<BodyContact> contactOf(const rivulet_body_contact& c, size_t bodies) const;
    void addContact(const rivulet_body_contact* contact) noexcept;
    bool findContacts(std::span<const BodyState> states, std::span<const vec4> balls, double seconds, std::vector<BodyContact>& found);

    float spacing_ = 0;
    BoxParams box_;
    LayersParams water_;
    Jobs jobs_;
    size_t memoryLimit_ = 0;
    Callback* callback_ = nullptr;
    rivulet_body_host host_{};
    std::string thrown_;
    std::vector<rivulet_body_load> loads_;
    std::vector<rivulet_body_state> states_;
    std::vector<rivulet_body_contact> contacts_;  // that the host has added
    bool addingFailed_ = false;                   // there was no memory for one
    uint32_t next_ = 0;
    std::vector<Pose> frames_;  // of FluidWorld::bodyIds; behind them that of one which is being added, or could not be
    std::vector<Waiting> waiting_;
};

}  // namespace rivulet::capi
