#include "fluid/capi/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "engine/core/exception_error.h"
#include "fluid/capi/call.h"
#include "fluid/capi/callbacks.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/versioned.h"
#include "fluid/capi/walls.h"
#include "fluid/sim/world/contradictions.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet::capi {

namespace {

// What a function of the host threw, in a sentence, on its way through FluidWorld.
struct HostThrew : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// What a function that failed leaves behind: in this frame no other is called, and without `advance` no body moves.
constexpr const char* kStay = "; the bodies stay where they are";
constexpr const char* kMoved = "; the GPU has moved the bodies nevertheless";

bool isOrigin(const Pose& frame) { return frame.position == vec3(0.0F) && frame.rotation == quat(1, 0, 0, 0); }

// Between the pose of a body's own frame and that of its mesh's frame, in which `frame` is the own one.
Pose toMesh(const Pose& own, const Pose& frame) {
    if (isOrigin(frame)) return own;
    const quat turn = glm::normalize(own.rotation * glm::conjugate(frame.rotation));
    return {own.position - turn * frame.position, turn};
}
Pose toOwn(const Pose& mesh, const Pose& frame) {
    if (isOrigin(frame)) return mesh;
    return {mesh.position + mesh.rotation * frame.position, glm::normalize(mesh.rotation * frame.rotation)};
}

// The distance from a mesh, by voxels: as BodyShape::distance, but no more than their band.
Result<std::function<float(const vec3&)>> distanceOf(const HostMesh& mesh, const VoxelFieldOptions& options) {
    const MeshView view = mesh.view();
    Result<VoxelField> baked = bakeVoxelField(std::span(&view, 1), options);
    if (!baked) return baked.error();
    auto field = std::make_shared<const VoxelField>(std::move(*baked));
    return std::function<float(const vec3&)>(
        [field](const vec3& p) { return field->inside(p) ? -std::abs(field->clearance(p)) : field->clearance(p); });
}

}  // namespace

Result<Bodies::Read> Bodies::read(const rivulet_body& given, const std::string& name, bool bakes) const {
    const Result<rivulet_body> input = readStruct(&given, "rivulet_body", name);
    if (!input) return input.error();
    const rivulet_body& b = *input;
    const bool sampled = b.samples != nullptr && b.samples_count > 0;
    if (!sampled && b.mesh == nullptr)
        return badInput(
            fmt::format("{} has no samples: give points below its surface, about a spacing apart, or a mesh and a density", name));
    constexpr float kLeastDensity = 0.01F, kMostDensity = 1.0e5F;  // kg/m^3, as of bodies in scene files
    if (!sampled && !(b.density >= kLeastDensity && b.density <= kMostDensity))
        return badInput(
            fmt::format("{}.density is {} kg/m^3: give {} to {}, or samples and a mass", name, b.density, kLeastDensity, kMostDensity));
    if (!sampled && (b.mass != 0 || b.volume != 0 || isSet(b.inertia)))
        return badInput(
            fmt::format("{} has a mesh and no samples: its mass, inertia and volume are computed from the mesh and its density; set mass, "
                        "inertia and volume to 0, or give samples",
                        name));
    if (sampled && b.density != 0) return badInput(fmt::format("{} has samples and a density: give one of them", name));
    Read read;
    BodyShape& shape = read.body.shape;
    for (size_t i = 0; sampled && i < b.samples_count; ++i) shape.samples.push_back(vectorOf(b.samples + 3 * i));
    shape.mass = b.mass;
    shape.inertia = vectorOf(b.inertia);
    shape.volume = b.volume;
    const Result<Pose> pose = soundPose(b.pose, name + ".pose");
    if (!pose) return pose.error();
    read.body.state = {*pose, vectorOf(b.velocity), vectorOf(b.spin)};
    if (!isWithin(read.body.state.velocity, kMostSpeed) || !isWithin(read.body.state.spin, kMostSpeed))
        return badInput(fmt::format("{}: velocity or spin is not finite, or more than {}", name, kMostSpeed));
    const auto checkPlace = [&](const char* what, const vec3& place) -> Status {
        const std::string wrong = outside(name + what, pose->toWorld(place), box_);
        return wrong.empty() ? ok() : Status(badInput(wrong));
    };
    if (sampled)
        if (Status in = checkPlace(".pose.position", vec3(0.0F)); !in) return in.error();
    const Result<LayersParams> layers = layersOf(b.layers, b.meets, name);
    if (!layers) return layers.error();
    read.body.meetsWater = water_.meet(*layers);
    if (b.mesh == nullptr) return read;
    const Result<rivulet_mesh> mesh = readStruct(b.mesh, "rivulet_mesh", name + ".mesh");
    if (!mesh) return mesh.error();
    Result<HostMesh> copy = meshOf(*mesh, name + ".mesh");
    if (!copy) return copy.error();
    if (sampled) shape.shell = [mesh = *copy](float apart) { return meshShell(mesh.view(), apart); };
    if (sampled && !bakes) return read;
    Bounds bounds;
    for (const vec3& p : copy->positions) bounds.add(p);
    if (!sampled)
        if (Status in = checkPlace(": the centre of its mesh", 0.5F * (bounds.min + bounds.max)); !in) return in.error();
    const VoxelFieldOptions options = voxelOptions(bounds, mesh->resolution, spacing_, memoryLimit_);
    const MeshView view = copy->view();
    if (Status sound = checkVoxelField(std::span(&view, 1), options); !sound) return sound.error();
    read.make = [mesh = std::move(*copy), options, sampled, own = shape, density = b.density,
                 spacing = spacing_]() mutable -> Result<Made> {
        Made made{std::move(own), {}};
        if (!sampled) {
            Result<MeshBody> body = meshShape(mesh.view(), double{density}, spacing);
            if (!body) return body.error();
            made = {std::move(body->shape), body->frame};
            for (vec3& p : mesh.positions) p = made.frame.toOwn(p);
        }
        Result<std::function<float(const vec3&)>> distance = distanceOf(mesh, options);
        if (!distance) return distance.error();
        made.shape.distance = std::move(*distance);
        return made;
    };
    return read;
}

void Bodies::finish(Body& body, Made made) {
    body.state.pose = toOwn(body.state.pose, made.frame);
    body.shape = std::move(made.shape);
}

Status Bodies::begin(const rivulet_world_options& o, const FluidParams& fluid, const Jobs& jobs, size_t memoryLimit, Callback& callback,
                     Solids& to) {
    spacing_ = fluid.spacing;
    box_ = fluid.box;
    water_ = fluid.collision.layers;
    jobs_ = jobs;
    memoryLimit_ = memoryLimit;
    callback_ = &callback;
    if (o.bodies_count > 0 && o.bodies == nullptr) return badInput("bodies is NULL, and bodies_count is not 0");
    const auto* at = reinterpret_cast<const std::byte*>(o.bodies);
    for (size_t k = 0; k < o.bodies_count; ++k) {
        const std::string name = fmt::format("bodies[{}]", k);
        const auto* given = reinterpret_cast<const rivulet_body*>(at);
        Result<Read> body = read(*given, name, false);
        if (!body) return body.error();
        Pose frame;
        if (body->make) {
            Result<Made> made = body->make();
            if (!made) return Error{fmt::format("{}.mesh: {}", name, made.error().message), made.error().fault};
            frame = made->frame;
            finish(body->body, std::move(*made));
        }
        to.bodies.push_back(std::move(body->body));
        frames_.push_back(frame);
        at += given->size;
    }
    next_ = static_cast<uint32_t>(o.bodies_count);
    const Result<rivulet_body_host> hosting = readStruct(o.body_host, "rivulet_body_host", "body_host");
    if (!hosting) return hosting.error();
    host_ = *hosting;
    if ((host_.advance == nullptr) != (host_.reset == nullptr))
        return badInput("body_host has one of advance and reset: give both or neither");
    if ((host_.contacts == nullptr) != (host_.passed == nullptr))
        return badInput("body_host has one of contacts and passed: give both or neither");
    if (host_.contacts == nullptr && host_.predict != nullptr)
        return badInput("body_host has predict, and neither contacts nor passed: give these, too, or leave predict out");
    if (host_.contacts != nullptr && host_.advance == nullptr)
        return badInput(
            fmt::format("body_host has contacts, passed{}, and neither advance nor reset: give these, too; they move the bodies "
                        "on the cpu, and where contacts returns 0",
                        host_.predict != nullptr ? ", predict" : ""));
    if (host_.advance != nullptr) to.bodyHost = host();
    return ok();
}

// Runs `call`, a function of the host. What it throws is kept, for the call that is under way; `then` ends the sentence.
template <class Call>
void Bodies::callHost(const char* name, const char* then, const Call& call) {
    const CallbackScope scope(*callback_);
    try {
        call();
    } catch (const std::exception& e) {
        fail(fmt::format("body_host.{} threw an exception: {}", name, e.what()), then);
    } catch (...) {
        fail(fmt::format("body_host.{} threw an exception", name), then);
    }
}

// The first of a call counts.
void Bodies::fail(const std::string& sentence, const char* then) {
    if (thrown_.empty()) thrown_ = sentence + then;
}

Status Bodies::thrown() {
    if (thrown_.empty()) return ok();
    return failed(std::exchange(thrown_, {}));
}

void Bodies::toStates(std::span<const BodyState> from) {
    states_.clear();
    for (size_t k = 0; k < from.size(); ++k) states_.push_back(stateOf(k, from[k]));
}

void Bodies::toLoads(std::span<const BodyLoad> from) {
    loads_.clear();
    loads_.reserve(from.size());
    for (const BodyLoad& l : from) loads_.push_back({{l.force.x, l.force.y, l.force.z}, {l.torque.x, l.torque.y, l.torque.z}});
}

void Bodies::fromStates(std::span<BodyState> to) const {
    for (size_t k = 0; k < to.size(); ++k)
        to[k] = {toOwn(poseOf(states_[k].pose), frames_[k]), vectorOf(states_[k].velocity), vectorOf(states_[k].spin)};
}

// Error (badInput): an invalid contact.
Result<BodyContact> Bodies::contactOf(const rivulet_body_contact& c, size_t bodies) const {
    const auto wrong = [](const std::string& what) { return badInput("body_host.contacts added a contact " + what); };
    const bool solid = c.b == RIVULET_SOLID;
    if (c.a == RIVULET_SOLID)
        return wrong(solid ? "of two solids: a is a body" : "whose a is RIVULET_SOLID: a is a body, and b may be a solid");
    for (const uint32_t body : {c.a, c.b})
        if (body >= bodies && body != RIVULET_SOLID)
            return wrong(fmt::format("of body {}, and there are {}: give indices into the states, counted from 0", body, bodies));
    if (c.a == c.b) return wrong(fmt::format("of body {} with itself", c.a));
    BodyContact to;
    to.a = c.a;
    to.b = solid ? BodyContact::kSolid : c.b;
    const Pose& a = frames_[c.a];
    const Pose b = solid ? Pose() : frames_[c.b];
    to.onA = a.toOwn(vectorOf(c.on_a));
    to.onB = b.toOwn(vectorOf(c.on_b));
    to.radiusA = c.radius_a;
    to.radiusB = c.radius_b;
    to.normal = glm::conjugate(!solid && c.radius_b > 0 ? a.rotation : b.rotation) * vectorOf(c.normal);
    to.velocityB = vectorOf(c.velocity_b);
    to.spinB = vectorOf(c.spin_b);
    to.centreB = vectorOf(c.centre_b);
    to.secondsB = static_cast<float>(c.seconds_b);
    to.friction = c.friction;
    to.restitution = c.restitution;
    constexpr float kMostFriction = 1.0e3F;
    constexpr double kMostSeconds = 1.0e6;
    if (!isWithin(to.onA, kMostDistance) || !isWithin(to.onB, kMostDistance) || !isWithin(to.centreB, kMostDistance))
        return wrong(fmt::format("whose on_a, on_b or centre_b is not finite, or beyond {} m", kMostDistance));
    if (!(c.radius_a >= 0 && c.radius_a <= kMostDistance && c.radius_b >= 0 && c.radius_b <= kMostDistance))
        return wrong(fmt::format("whose radius_a or radius_b is not from 0 to {} m", kMostDistance));
    if (!(std::abs(glm::length(to.normal) - 1.0F) < 1.0e-3F)) return wrong("whose normal is not a unit vector");
    if (!isWithin(to.velocityB, kMostSpeed) || !isWithin(to.spinB, kMostSpeed))
        return wrong(fmt::format("whose velocity_b or spin_b is not finite, or more than {}", kMostSpeed));
    if (!(c.seconds_b >= 0 && c.seconds_b <= kMostSeconds))
        return wrong(fmt::format("whose seconds_b is not from 0 to {} s", kMostSeconds));
    if (!(c.friction >= 0 && c.friction <= kMostFriction)) return wrong(fmt::format("whose friction is not from 0 to {}", kMostFriction));
    if (!(c.restitution >= 0 && c.restitution <= 1)) return wrong("whose restitution is not from 0 to 1");
    return to;
}

// Nothing may be thrown through the host's function.
void Bodies::addContact(const rivulet_body_contact* contact) noexcept {
    try {
        if (!thrown_.empty()) return;
        if (contact == nullptr) return fail("body_host.contacts added a contact that is NULL", kStay);
        const Result<rivulet_body_contact> read = readStruct(contact, "rivulet_body_contact", "contact");
        if (!read) return fail("body_host.contacts: " + read.error().message, kStay);
        contacts_.push_back(*read);
    } catch (...) {
        addingFailed_ = true;
    }
}

bool Bodies::findContacts(std::span<const BodyState> states, std::span<const vec4> balls, double seconds, std::vector<BodyContact>& found) {
    if (!thrown_.empty()) return false;
    toStates(states);
    contacts_.clear();
    addingFailed_ = false;
    const rivulet_add_contact add = [](void* to, const rivulet_body_contact* contact) { static_cast<Bodies*>(to)->addContact(contact); };
    bool knows = false;
    callHost("contacts", kStay,
             [&] { knows = host_.contacts(host_.user, states_.data(), &balls.data()->x, states.size(), seconds, add, this) != 0; });
    if (addingFailed_) fail("body_host.contacts added more contacts than there is memory for", kStay);
    if (!knows || !thrown_.empty()) return false;
    found.reserve(found.size() + contacts_.size());
    for (const rivulet_body_contact& c : contacts_) {
        const Result<BodyContact> contact = contactOf(c, states.size());
        if (!contact) {
            fail(contact.error().message, kStay);
            return false;
        }
        found.push_back(*contact);
    }
    return true;
}

rivulet_body_state Bodies::stateOf(size_t place, const BodyState& s) const {
    return {poseOf(toMesh(s.pose, frames_[place])), {s.velocity.x, s.velocity.y, s.velocity.z}, {s.spin.x, s.spin.y, s.spin.z}};
}

BodyHost Bodies::host() {
    BodyHost h;
    h.self = this;
    h.advance = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
        Bodies& b = *static_cast<Bodies*>(self);
        if (!b.thrown_.empty()) return;
        b.toLoads(loads);
        b.toStates(states);
        const float g[3] = {gravity.x, gravity.y, gravity.z};
        b.callHost("advance", kStay, [&] { b.host_.advance(b.host_.user, b.loads_.data(), g, seconds, b.states_.data(), states.size()); });
        if (b.thrown_.empty()) b.fromStates(states);
    };
    if (host_.contacts != nullptr) {
        h.contacts = [](void* self, std::span<const BodyState> states, std::span<const vec4> balls, double seconds,
                        std::vector<BodyContact>& found) {
            return static_cast<Bodies*>(self)->findContacts(states, balls, seconds, found);
        };
        h.passed = [](void* self, double seconds) {
            Bodies& b = *static_cast<Bodies*>(self);
            if (b.thrown_.empty()) b.callHost("passed", kMoved, [&] { b.host_.passed(b.host_.user, seconds); });
        };
    }
    if (host_.predict != nullptr)
        h.predict = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double from, double seconds,
                       std::span<BodyState> states) {
            Bodies& b = *static_cast<Bodies*>(self);
            if (!b.thrown_.empty()) return;
            b.toLoads(loads);
            b.toStates(states);
            const float g[3] = {gravity.x, gravity.y, gravity.z};
            b.callHost("predict", kStay,
                       [&] { b.host_.predict(b.host_.user, b.loads_.data(), g, from, seconds, b.states_.data(), states.size()); });
            if (b.thrown_.empty()) b.fromStates(states);
        };
    h.reset = [](void* self, std::span<const BodyState> states) {
        Bodies& b = *static_cast<Bodies*>(self);
        b.toStates(states);
        b.callHost("reset", "", [&] { b.host_.reset(b.host_.user, b.states_.data(), states.size()); });
    };
    // An exception here leaves the body where it is: in the world, or not.
    h.added = [](void* self, uint32_t id, const Body& body) {
        Bodies& b = *static_cast<Bodies*>(self);
        if (b.host_.added == nullptr) return;
        const rivulet_body_state state = b.stateOf(b.frames_.size() - 1, body.state);
        b.callHost("added", "", [&] { b.host_.added(b.host_.user, id, &state); });
        if (!b.thrown_.empty()) throw HostThrew(std::exchange(b.thrown_, {}));
    };
    h.removed = [](void* self, uint32_t id, size_t) {
        Bodies& b = *static_cast<Bodies*>(self);
        if (b.host_.removed == nullptr) return;
        b.callHost("removed", "", [&] { b.host_.removed(b.host_.user, id); });
        if (!b.thrown_.empty()) throw HostThrew(std::exchange(b.thrown_, {}));
    };
    return h;
}

Status Bodies::enter(FluidWorld& world, uint32_t id, const Body& body, const Pose& frame) {
    frames_.resize(world.bodyIds().size());
    frames_.push_back(frame);  // `added` reads it
    try {
        const Result<uint32_t> added = world.addBody(body, true, id);
        return added ? ok() : Status(added.error());
    } catch (const HostThrew& thrown) {
        return failed(thrown.what());
    }
}

Result<uint32_t> Bodies::add(FluidWorld& world, const rivulet_body& given) {
    Result<Read> body = read(given, "body", true);
    if (!body) return body.error();
    if (body->make == nullptr) {
        if (Status in = enter(world, next_, body->body, {}); !in) return in.error();
        return next_++;
    }
    Waiting one{.id = next_, .body = std::move(body->body), .make = nullptr, .failure = {}};
    one.make = std::make_unique<Background<Made>>(std::move(body->make), jobs_);
    waiting_.push_back(std::move(one));
    return next_++;
}

Status Bodies::remove(FluidWorld& world, uint32_t id) {
    if (const auto at = std::ranges::find(waiting_, id, &Waiting::id); at != waiting_.end()) {
        waiting_.erase(at);
        return ok();
    }
    const std::vector<uint32_t>& ids = world.bodyIds();
    const auto place = std::ranges::find(ids, id) - ids.begin();
    try {
        if (Status gone = world.removeBody(id); !gone) return gone;
    } catch (const HostThrew& thrown) {
        return failed(thrown.what());
    }
    frames_.erase(frames_.begin() + place);
    return ok();
}

std::vector<std::string> Bodies::arrive(FluidWorld& world) {
    std::vector<std::string> wrong;
    for (Waiting& w : waiting_) {
        if (w.make == nullptr || !w.make->done()) continue;
        const auto arrives = [&]() -> Status {
            try {
                Result<Made> made = w.make->take();
                if (!made) return made.error();
                const Pose frame = made->frame;
                finish(w.body, std::move(*made));
                return enter(world, w.id, w.body, frame);
            } catch (...) {  // there is no memory, for example
                return errorOf(std::current_exception());
            }
        };
        const Status in = arrives();
        w.make.reset();
        if (in) continue;
        w.failure = in.error().message;
        wrong.push_back(fmt::format("body {}: {}", w.id, w.failure));
    }
    std::erase_if(waiting_, [](const Waiting& w) { return w.make == nullptr && w.failure.empty(); });
    return wrong;
}

Result<std::optional<size_t>> Bodies::placeOf(const FluidWorld& world, uint32_t id) const {
    const std::vector<uint32_t>& ids = world.bodyIds();
    if (const auto at = std::ranges::find(ids, id); at != ids.end()) return std::optional(static_cast<size_t>(at - ids.begin()));
    const auto waits = std::ranges::find(waiting_, id, &Waiting::id);
    if (waits == waiting_.end()) return badInput(fmt::format("there is no body {}", id));
    if (!waits->failure.empty()) return failed(fmt::format("body {}: {}", id, waits->failure));
    return std::optional<size_t>();
}

namespace {

Status statesInto(const rivulet_world& world, const std::vector<BodyState>& bodies, rivulet_body_state* states, size_t count) {
    if (states == nullptr) return badInput("states is NULL");
    if (count != bodies.size()) return badInput(fmt::format("count is {}, and there are {} bodies", count, bodies.size()));
    for (size_t k = 0; k < count; ++k) states[k] = world.bodies.stateOf(k, bodies[k]);
    return ok();
}

}  // namespace
}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

rivulet_status rivulet_world_bodies(const rivulet_world* world, rivulet_body_state* states, size_t count, rivulet_error* why) {
    return with(world, why, Needs::device, [&] { return statesInto(*world, world->world->bodies(), states, count); });
}

rivulet_status rivulet_world_expected_bodies(const rivulet_world* world, rivulet_body_state* states, size_t count, rivulet_error* why) {
    return with(world, why, Needs::memory, [&] { return statesInto(*world, world->world->expectedBodies(), states, count); });
}

rivulet_status rivulet_world_add_body(rivulet_world* world, const rivulet_body* body, uint32_t* id, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (body == nullptr || id == nullptr) return badInput("body or id is NULL");
        world->bodies.forget();
        const Result<uint32_t> added = world->bodies.add(*world->world, *body);
        if (!added) return added.error();
        *id = *added;
        return ok();
    });
}

rivulet_status rivulet_world_remove_body(rivulet_world* world, uint32_t id, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        world->bodies.forget();
        return world->bodies.remove(*world->world, id);
    });
}

rivulet_status rivulet_world_body(const rivulet_world* world, uint32_t id, int32_t* inside, rivulet_body_state* state,
                                  rivulet_body_load* load, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        const Result<std::optional<size_t>> place = world->bodies.placeOf(*world->world, id);
        if (!place) return place.error();
        if (inside != nullptr) *inside = *place ? 1 : 0;
        if (!*place) return ok();
        if (state != nullptr) *state = world->bodies.stateOf(**place, world->world->bodies()[**place]);
        if (load != nullptr) {
            const BodyLoad& l = world->world->bodyLoads()[**place];
            *load = {{l.force.x, l.force.y, l.force.z}, {l.torque.x, l.torque.y, l.torque.z}};
        }
        return ok();
    });
}

rivulet_status rivulet_world_body_ids(const rivulet_world* world, uint32_t* ids, size_t capacity, size_t* count, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        if (count == nullptr) return badInput("count is NULL");
        const std::vector<uint32_t>& all = world->world->bodyIds();
        if (ids != nullptr) std::copy_n(all.begin(), std::min(capacity, all.size()), ids);
        *count = all.size();
        return ok();
    });
}
