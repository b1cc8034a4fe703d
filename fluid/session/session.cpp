#include "fluid/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/timeline.h"
#include "fluid/scene/collider_kinds.h"
#include "fluid/sim/sources/block.h"

namespace rivulet {

namespace {

FluidParams simulated(const SceneFile& scene) { return fluidForLook(scene.fluid, scene.look); }

// The steps of opening that the start of the water counts for: a hundred thousand particles take about as long as a mesh.
int waterParts(const FluidParams& p) {
    double particles = 0;
    for (const BlockParams& b : p.blocks) particles += blockCount(b, p.spacing);
    return 1 + static_cast<int>(std::min(particles / 1.0e5, 1000.0));
}

}  // namespace

Result<std::unique_ptr<Session>> Session::create(SceneFile scene, Device& device, const Log& log, const OpeningSteps& steps) {
    std::unique_ptr<Session> session(new Session());
    Session& s = *session;
    const auto hasTriangles = [](const ColliderParams& c) { return kindOf(c).hasTriangles(); };
    const auto meshes = std::count_if(scene.colliders.begin(), scene.colliders.end(), hasTriangles);
    OpeningProgress progress{steps, scene.name};
    progress.total = static_cast<int>(2 * meshes) + 1 + (scene.bodies.empty() ? 0 : 1) + 1 + static_cast<int>(scene.flow.size());
    const int water = waterParts(scene.fluid);
    progress.total += water - 1;
    Result<std::optional<Budget>> budget = openBudget(scene, device, log);
    if (!budget) return budget.error();
    s.budget_ = std::move(*budget);
    s.log_ = log;
    s.scene_ = std::move(scene);
    if (Status solids = s.solids_.create(s.scene_, log, progress); !solids) return solids.error();
    if (Status sources = s.sources_.create(s.scene_); !sources) return sources.error();
    // A scene of skins alone needs no water: no notice about its absence.
    Log quiet = log;
    if (!s.scene_.flow.empty() && s.scene_.fluid.blocks.empty() && s.scene_.emitters.empty()) quiet.sink = {};
    if (Status on = progress.next("the water"); !on) return on.error();
    const auto started = [&](double share) { return progress.within("the water", share, water); };
    if (Status made = s.makeWorld(device, simulated(s.scene_), quiet, started); !made) return made.error();
    progress.done += water - 1;
    if (!s.scene_.flow.empty())
        if (Status on = progress.next("skins"); !on) return on.error();
    if (Status flows = s.flows_.create(s.scene_, device, s.solids_.nodes(), log); !flows)
        return Error{fmt::format("{}: {}", s.scene_.name, flows.error().message), flows.error().fault};
    s.solids_.placeNodes(s.scene_, *s.world_);
    if (s.world_->particles().count == 0 && s.scene_.emitters.empty() && s.scene_.flow.empty())
        log.notice(fmt::format("the scene {} has 0 particles: no water is visible", s.scene_.name));
    return session;
}

Status Session::makeWorld(Device& device, const FluidParams& params, const Log& log, const StartProgress& progress) {
    auto world = FluidWorld::create(device, params, solids_.ofWorld(), log, sources_.ofWorld(), {}, progress);
    if (!world) return Error{fmt::format("{}: {}", scene_.name, world.error().message), world.error().fault};
    world_ = std::move(*world);
    return ok();
}

Bounds Session::bounds() const {
    Bounds all = solids_.nodes().bounds();
    all.add(scene_.fluid.box.min);
    all.add(scene_.fluid.box.max);
    return all;
}

void Session::pourOnto(const std::optional<vec3>& place) {
    if (!replay_ && sources_.pourOnto(scene_, place)) report(world_->setSources(sources_.now(scene_)));
}

bool Session::needsNew(const SceneFile& scene) const {
    return solids_.needsNew(scene_, scene) || SceneSources::needsNew(scene_, scene) || flows_.needsNew(scene);
}

void Session::report(const Status& status) const {
    if (!status) log_.notice(status.error().message);
}

void Session::apply(const SceneFile& scene) {
    std::string folder = scene_.folder;
    scene_ = scene;
    scene_.folder = folder;
    if (budget_) applySetting(budget_->setting(), scene_);
    report(world_->setParams(simulated(scene_)));
    report(world_->setSources(sources_.now(scene_)));
    flows_.apply(scene_, solids_.nodes());
    report(world_->setSurfaces(SceneSolids::surfaces(scene_)));
    solids_.apply(scene_);
}

// Steps the world, with the solids at their places in `seconds`.
void Session::advance(double seconds, double deviceMs) {
    FluidInputs inputs;
    inputs.deviceMs = deviceMs;
    inputs.mostMs = mostMs_;
    const double before = world_->time(), ahead = world_->pending() + seconds;
    const SceneSolids::Motion motion = solids_.motionAt(scene_, before + ahead, ahead);
    solids_.moveContacts(motion, seconds);
    inputs.poses = motion.poses;
    inputs.shapes = motion.shapes;
    world_->step(inputs, seconds);
    const Device& device = world_->device();
    if ((interrupted_ = device.interrupted())) return;
    const double gone = world_->time() - before;  // less than asked if the time step limit slows the simulation
    if (Status flowed = flows_.step(scene_, *world_, gone, solids_.nodes()); !flowed) log_.notice(flowed.error().message);
    if ((interrupted_ = device.interrupted())) return;
    solids_.advance(scene_, gone);
}

void Session::work(double asked, bool wait, double deviceMs) {
    const double start = hostSeconds();
    if (replay_) {
        (void)replay_->next();  // replayed() reports it
        worked_ = {.ms = 1000 * (hostSeconds() - start), .seconds = 0, .costMs = 0};
        return;
    }
    if (interrupted_) {
        worked_ = {};
        return;
    }
    const double seconds = world_->acceptedSeconds(asked), before = world_->time();
    // Between two poses a solid moves along a straight line and turns the short way: long frames are split to follow its path.
    const int parts = anyMoves() && seconds > 0 ? static_cast<int>(std::min(std::ceil(seconds * kFramesPerSecond - 1.0e-6), 1.0e4)) : 1;
    for (int k = 0; k < std::max(parts, 1) && !interrupted_; ++k) advance(seconds / std::max(parts, 1), deviceMs / std::max(parts, 1));
    if (wait) world_->device().finish();
    worked_ = {.ms = 1000 * (hostSeconds() - start), .seconds = world_->time() - before, .costMs = deviceMs};
    // Without a wait a GPU still works after the call: a frame's cost is that of its passes some frames ago.
    if (wait || world_->device().backend() == Backend::cpu) worked_.costMs = worked_.ms;
}

double Session::settle() {
    const double start = hostSeconds();
    if (replay_) {
        solids_.placeNodes(scene_, replay_->shown());
        return worked_.ms + 1000 * (hostSeconds() - start);
    }
    if (interrupted_) return worked_.ms;
    if (anyMoves() || solids_.hasBodies()) solids_.placeNodes(scene_, *world_);
    worked_.ms += 1000 * (hostSeconds() - start);
    world_->device().poll();
    if (budget_) watchBudget(worked_.costMs, worked_.seconds);
    snapshots_.count(worked_.costMs);
    if (world_->device().backend() == Backend::cl && snapshots_.isDue()) takeSnapshot();
    return worked_.ms;
}

bool Session::canStepInBackground() const {
    return !replay_ && world_->device().backend() == Backend::cpu && flows_.empty() && !solids_.bendsAsDrawn();
}

void Session::watchBudget(double ms, double seconds) {
    std::string sentence;
    if (budget_->frame(ms, seconds, world_->stats().avgCompression, sentence)) {
        applySetting(budget_->setting(), scene_);
        report(world_->setParams(simulated(scene_)));
    }
    if (!sentence.empty()) log_.notice(sentence);
}

void Session::reset() {
    if (replay_) {
        replay_->seek(0);
        (void)replay_->next();
        solids_.placeNodes(scene_, replay_->shown());
        return;
    }
    world_->reset();
    if (Status fresh = flows_.reset(scene_, world_->device(), solids_.nodes(), log_); !fresh) log_.notice(fresh.error().message);
    toStart();
    snapshots_.forget();
    interrupted_ = world_->device().interrupted();
}

void Session::toStart() {
    solids_.toStart(*world_);
    solids_.placeNodes(scene_, *world_);
}

}  // namespace rivulet
