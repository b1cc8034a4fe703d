// A Session's state as a whole: saved and restored, recorded and replayed, handed over to another.
#include <fmt/format.h>

#include <cmath>

#include "fluid/session/session.h"

namespace rivulet {

Status Session::replay(Replay replay) {
    size_t corners = 0;
    for (const Deforming& d : deforming_) corners += d.rest.size();
    const RecordedFrame& frame = replay.shown();
    if (frame.places.size() != rigid_.size() + bodyNodes_.size() || frame.corners.size() != corners)
        return badInput(
            fmt::format("the recording has {} solids that move and {} corners that bend, this scene {} and {}: replay it with the "
                        "scene and the meshes that it is of",
                        frame.places.size(), frame.corners.size(), rigid_.size() + bodyNodes_.size(), corners));
    replay_ = std::move(replay);
    placeRecorded();
    return ok();
}

void Session::placesInto(RecordedFrame& frame) const {
    for (const Rigid& r : rigid_) frame.places.push_back(nodeOf(r.model).local);
    for (const size_t node : bodyNodes_) frame.places.push_back(solids_.nodes()[node].local);
    for (const Deforming& d : deforming_)
        frame.corners.insert(frame.corners.end(), d.field->positions().begin(), d.field->positions().end());
}

// A frame of other solids than the first has is no frame of this recording: nothing moves then.
void Session::placeRecorded() {
    const RecordedFrame& frame = replay_->shown();
    size_t corner = 0;
    for (const Deforming& d : deforming_) corner += d.rest.size();
    if (frame.places.size() != rigid_.size() + bodyNodes_.size() || frame.corners.size() != corner) return;
    auto place = frame.places.begin();
    for (const Rigid& r : rigid_) nodeOf(r.model).local = *place++;
    for (const size_t node : bodyNodes_) solids_.nodes()[node].local = *place++;
    auto next = frame.corners.begin();
    for (const Deforming& d : deforming_) {
        bendNode(d, std::span(next, d.rest.size()));
        next += static_cast<std::ptrdiff_t>(d.rest.size());
    }
    placeModels();
}

void Session::save(WorldState& state) {
    state.putText("session.params", fixedValues([this](ParamVisitor& v) { scene_.visit(v); }));
    std::vector<double> turned;
    for (const Rigid& r : rigid_) turned.push_back(r.turned);
    state.put<double>("session.turned", turned);
    world_->save(state);
}

Status Session::restore(WorldState& state) {
    Result<std::string> params = state.takeText("session.params");
    if (!params) return params.error();
    if (Status same = sameFixedValues(*params, fixedValues([this](ParamVisitor& v) { scene_.visit(v); })); !same) return same;
    Result<std::vector<double>> turned = state.take<double>("session.turned", rigid_.size());
    if (!turned) return turned.error();
    for (double degrees : *turned)
        if (!std::isfinite(degrees)) return badInput("the saved state's angles make no sense: save it again");
    if (Status done = restoreWorld(state); !done) return done;
    for (size_t k = 0; k < rigid_.size(); ++k) rigid_[k].turned = (*turned)[k];
    placeNodes();
    if (world_->device().backend() == Backend::cl) takeSnapshot();
    return ok();
}

Status Session::restoreWorld(WorldState& state) {
    const std::optional<uint32_t> room = world_->savable() ? moreRoom(state) : std::nullopt;
    if (!room) return world_->restore(state);
    const uint32_t least = sources_.least;
    WorldState mine;
    world_->save(mine);
    Status done = remake(*room);
    if (done) done = world_->restore(state);
    if (done) return done;
    if (Status back = remake(least); !back) return back;
    if (Status back = world_->restore(mine); !back) return back;
    placeNodes();
    return done;
}

// The slots of the world that was saved, where they are more than those of this one: it may have gone on from one whose solids left room
// for more.
std::optional<uint32_t> Session::moreRoom(const WorldState& state) const {
    const auto ids = state.sections().find("particles.id");
    constexpr size_t kMost = size_t{1} << 30U;  // bytes: what the world says of more is a better sentence
    if (ids == state.sections().end() || ids->second.size() % sizeof(uint32_t) != 0 || ids->second.size() > kMost) return std::nullopt;
    const size_t slots = ids->second.size() / sizeof(uint32_t);
    const ParticleView now = world_->particles();
    if (slots <= now.slots) return std::nullopt;
    return static_cast<uint32_t>(slots - (now.slots - now.count));
}

// A world as at first, but for its room.
Status Session::remake(uint32_t least) {
    sources_.least = scene_.room = least;
    for (Deforming& d : deforming_)
        if (const auto back = d.field->update(d.rest); !back) return back.error();
    if (Status made = makeWorld(world_->device(), world_->params(), {}); !made) return made;
    startSolids();
    return ok();
}

bool Session::sameWater(const SceneFile& before, const SceneFile& after) {
    const auto fixed = [](SceneFile scene) {
        scene.fluid.maxParticles = 0;
        return fixedValues([&scene](ParamVisitor& v) { scene.fluid.visit(v); });
    };
    return fixed(before) == fixed(after);
}

Status Session::goOnFrom(Session& other) {
    if (replay_ || other.replay_) return badInput("what was recorded does not go on");
    const double time = other.world_->time();
    for (Rigid& r : rigid_)
        for (const Rigid& before : other.rigid_)
            if (before.collider == r.collider && scene_.colliders[r.collider].mesh == other.scene_.colliders[r.collider].mesh)
                r.turned = before.turned;
    std::vector<Pose> poses;
    for (const Rigid& r : rigid_) poses.push_back(poseOf(r.model, time, r.turned));
    std::vector<std::span<const vec3>> shapes;
    for (Deforming& d : deforming_) {
        bend(d, time);
        shapes.emplace_back(d.shape);
    }
    if (Status gone = world_->goOnFrom(*other.world_, poses, shapes); !gone) {
        world_->reset();
        startSolids();
        return gone;
    }
    if (contacts_) contacts_->moveTo(poses, 0);
    placeNodes();
    return ok();
}

}  // namespace rivulet
