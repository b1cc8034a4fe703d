// A session's whole state: saved and restored, replayed, moved to another device, continued in another session.
#include <fmt/format.h>

#include "fluid/session/session.h"
#include "fluid/sim/world/state_check.h"

namespace rivulet {

Status Session::replay(Replay replay) {
    const RecordedFrame& frame = replay.shown();
    if (!solids_.fits(frame))
        return badInput(
            fmt::format("the recording has {} moving solids and {} deforming vertices, this scene {} and {}: use the scene and the "
                        "meshes of the recording",
                        frame.places.size(), frame.corners.size(), solids_.recordedPlaces(), solids_.recordedCorners()));
    replay_ = std::move(replay);
    solids_.placeNodes(scene_, replay_->shown());
    return ok();
}

void Session::endReplay() {
    if (!replay_) return;
    replay_.reset();
    solids_.placeNodes(scene_, *world_);
}

Status Session::moveTo(Device& device) {
    takeSnapshot();
    // Notices about the scene were logged when it was opened.
    const auto opening = std::make_shared<bool>(true);
    const Log quiet{[log = log_, opening](LogLevel level, std::string_view text) {
        if (!*opening && log.sink) log.sink(level, text);
    }};
    if (Status back = solids_.rest(); !back) return back;
    FluidParams params = world_->params();  // the scene's may hold an edit that is not applied
    if (device.backend() == Backend::cpu) params.grid = scene_.fluid.grid = "sorted";
    if (Status made = makeWorld(device, params, quiet); !made) return made;
    report(world_->setSources(sources_.now(scene_)));
    report(world_->setSurfaces(SceneSolids::surfaces(scene_)));
    const std::optional<SnapshotKeeper::Snapshot>& last = snapshots_.last();
    if (Status moved = flows_.moveTo(device, scene_, solids_.nodes(), quiet, last ? last->flows.get() : nullptr); !moved) return moved;
    *opening = false;
    if (!last) {
        world_->reset();
        toStart();
        return ok();
    }
    SnapshotKeeper::Snapshot snapshot = snapshots_.release();
    solids_.setTurned(snapshot.turned);
    WorldState& state = snapshot.world;
    (void)state.takeText("world.params");
    state.putText("world.params", fixedValues([&params](ParamVisitor& v) { params.visit(v); }));  // a changed grid holds the same particles
    if (Status done = world_->restore(state); !done) return done;
    solids_.placeNodes(scene_, *world_);
    return ok();
}

void Session::save(WorldState& state) {
    state.putText("session.params", fixedValues([this](ParamVisitor& v) { scene_.visit(v); }));
    state.put<double>("session.turned", solids_.turned());
    world_->save(state);
}

Status Session::restore(WorldState& state) {
    Result<std::string> params = state.takeText("session.params");
    if (!params) return params.error();
    if (Status same = sameFixedValues(*params, fixedValues([this](ParamVisitor& v) { scene_.visit(v); })); !same) return same;
    Result<std::vector<double>> turned = state.take<double>("session.turned", solids_.ofWorld().rigid.size());
    if (!turned) return turned.error();
    constexpr double kMostTurned = 1.0e12;  // deg
    if (Status sound = checkRange("session.turned", *turned, -kMostTurned, kMostTurned); !sound) return sound;
    if (Status done = restoreWorld(state); !done) return done;
    solids_.setTurned(*turned);
    solids_.placeNodes(scene_, *world_);
    interrupted_ = world_->device().interrupted();
    if (!interrupted_ && world_->device().backend() == Backend::cl) takeSnapshot();
    return ok();
}

Status Session::restoreWorld(WorldState& state) {
    const std::optional<uint32_t> room = world_->savable() ? moreRoom(state) : std::nullopt;
    if (!room) return world_->restore(state);
    const uint32_t least = sources_.ofWorld().least;
    WorldState mine;
    world_->save(mine);
    Status done = remake(*room);
    if (done) done = world_->restore(state);
    if (done) return done;
    if (Status back = remake(least); !back) return back;
    if (Status back = world_->restore(mine); !back) return back;
    solids_.placeNodes(scene_, *world_);
    return done;
}

// The slots of the saved world, if it has more than this one: it may have continued from a world whose solids left more space.
std::optional<uint32_t> Session::moreRoom(const WorldState& state) const {
    const auto ids = state.sections().find("particles.id");
    constexpr size_t kMost = size_t{1} << 30U;  // bytes: of more the world's own error is better
    if (ids == state.sections().end() || ids->second.size() % sizeof(uint32_t) != 0 || ids->second.size() > kMost) return std::nullopt;
    const size_t slots = ids->second.size() / sizeof(uint32_t);
    const ParticleView now = world_->particles();
    if (slots <= now.slots) return std::nullopt;
    return static_cast<uint32_t>(slots - (now.slots - now.count));
}

// A world at its start, with memory for `least` particles.
Status Session::remake(uint32_t least) {
    scene_.room = least;
    sources_.setLeast(least);
    if (Status back = solids_.rest(); !back) return back;
    if (Status made = makeWorld(world_->device(), world_->params(), {}); !made) return made;
    toStart();
    return ok();
}

bool Session::sameWater(const SceneFile& before, const SceneFile& after) {
    const auto fixed = [](SceneFile scene) {
        scene.fluid.maxParticles = 0;
        return fixedValues([&scene](ParamVisitor& v) { scene.fluid.visit(v); });
    };
    return fixed(before) == fixed(after);
}

Status Session::continueFrom(Session& other) {
    if (replay_ || other.replay_) return badInput("a recording cannot be continued");
    solids_.setTurned(scene_, other.solids_, other.scene_);
    const SceneSolids::Motion motion = solids_.motionAt(scene_, other.world_->time(), 0);
    if (Status gone = world_->continueFrom(*other.world_, motion.poses, motion.shapes); !gone) {
        world_->reset();
        toStart();
        return gone;
    }
    solids_.moveContacts(motion, 0);
    solids_.placeNodes(scene_, *world_);
    return ok();
}

}  // namespace rivulet
