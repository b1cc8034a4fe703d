#include "fluid/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "engine/scene/import_assimp.h"
#include "engine/scene/transform.h"
#include "fluid/scene/collider_motion.h"
#include "fluid/scene/scene_bodies.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/voxel/voxel_cache.h"

namespace rivulet {

namespace {

// The scene's fluid, with the normals and the ellipsoids that its look wants to show.
FluidParams simulated(const SceneFile& scene) {
    FluidParams fluid = scene.fluid;
    const bool shown = scene.look.colourBy == "normal" || scene.look.colourBy == "surface";
    if (shown && fluid.forces.normals == "none") fluid.forces.normals = "thesis";
    const bool surface = scene.look.renderer == "screen_space" || scene.look.split == "screen_space";
    fluid.ellipsoids = fluid.ellipsoids || (surface && scene.look.splats == "ellipsoids" && scene.look.quality != "fast");
    return fluid;
}

float longest(const Bounds& bounds) {
    vec3 size = bounds.size();
    return std::max({size.x, size.y, size.z});
}

mat4 matrixOf(const Pose& pose) {
    mat4 m = glm::mat4_cast(pose.rotation);
    m[3] = vec4(pose.position, 1.0F);
    return m;
}

// One surface a collider while they suffice, so that each can be edited; else colliders that are alike share one.
std::vector<Surface> surfacesOf(const SceneFile& scene, std::vector<uint8_t>& surfaceOf) {
    std::vector<Surface> table;
    surfaceOf.clear();
    for (const ColliderParams& collider : scene.colliders) {
        size_t at = table.size();
        if (scene.colliders.size() > kMostSurfaces) {
            const auto same = std::find_if(table.begin(), table.end(), [&](const Surface& s) {
                return s.friction == collider.friction && s.restitution == collider.restitution;
            });
            at = static_cast<size_t>(same - table.begin());
        }
        if (at == table.size()) table.push_back({collider.friction, collider.restitution});
        surfaceOf.push_back(static_cast<uint8_t>(at));
    }
    return table;
}

// A sentence of the baker, with whose mesh it is about.
Error about(const Error& error, size_t collider, const ColliderParams& params) {
    return {fmt::format("colliders[{}] ({}): {}", collider, params.mesh, error.message), error.fault};
}

// What a file's materials hide is said once: a colour that changes nothing would be a riddle.
bool saysMaterial(const ColliderParams& c) {
    const ColliderParams none;
    return c.colour != none.colour || c.roughness != none.roughness || c.metallic != none.metallic || c.opacity != none.opacity ||
           c.grain != none.grain;
}

}  // namespace

Result<std::unique_ptr<Session>> Session::create(SceneFile scene, Device& device, const Log& log, const OpeningSteps& steps) {
    std::unique_ptr<Session> session(new Session());
    Session& s = *session;
    s.steps_ = steps;
    const auto isMesh = [](const ColliderParams& c) { return c.shape == "mesh"; };
    const auto meshes = std::count_if(scene.colliders.begin(), scene.colliders.end(), isMesh);
    s.stepsInAll_ = static_cast<int>(2 * meshes) + 1 + (scene.bodies.empty() ? 0 : 1) + 1 + static_cast<int>(scene.flow.size());
    Result<std::optional<Budget>> budget = openBudget(scene, device, log);
    if (!budget) return budget.error();
    s.budget_ = std::move(*budget);
    s.log_ = log;
    s.scene_ = std::move(scene);
    if (Status imported = s.importColliders(); !imported) return imported.error();
    Solids& solids = s.given_;
    solids.surfaces = surfacesOf(s.scene_, s.surfaceOf_);
    if (Status baked = s.bake(log); !baked) return baked.error();
    if (!s.field_.empty()) solids.field = &s.field_;
    for (size_t i = 0; i < s.scene_.colliders.size(); ++i) {
        const ColliderParams& collider = s.scene_.colliders[i];
        if (collider.shape == "plane") solids.planes.push_back({collider.position, collider.normal, s.surfaceOf_[i]});
    }
    for (const Rigid& r : s.rigid_) solids.rigid.push_back({r.field.get(), s.poseOf(r.model, 0, 0)});
    for (const Deforming& d : s.deforming_) solids.deforming.push_back(d.field.get());
    if (!s.scene_.bodies.empty())
        if (Status on = s.next("bodies"); !on) return on.error();
    if (Status added = s.addBodies(solids); !added) return added.error();
    Result<Sources> sources = s.importEmitters();
    if (!sources) return sources.error();
    s.sources_ = std::move(*sources);
    // A scene of skins alone has no water to miss.
    Log quiet = log;
    if (!s.scene_.flow.empty() && s.scene_.fluid.blocks.empty() && s.scene_.emitters.empty()) quiet.sink = {};
    if (Status on = s.next("the water"); !on) return on.error();
    if (Status made = s.makeWorld(device, simulated(s.scene_), quiet); !made) return made.error();
    if (!s.scene_.flow.empty())
        if (Status on = s.next("skins"); !on) return on.error();
    if (Status flows = s.flows_.create(s.scene_, device, s.solids_, log); !flows)
        return Error{fmt::format("{}: {}", s.scene_.name, flows.error().message), flows.error().fault};
    s.placeNodes();
    if (s.world_->particles().count == 0 && s.scene_.emitters.empty() && s.scene_.flow.empty())
        log.notice(fmt::format("the scene {} has 0 particles: there is no water to see", s.scene_.name));
    s.steps_ = {};
    return session;
}

Status Session::next(const std::string& what) {
    if (!steps_ || steps_(what, static_cast<double>(step_++) / stepsInAll_)) return ok();
    return failed(fmt::format("opening {} was given up", scene_.name));
}

Status Session::makeWorld(Device& device, const FluidParams& params, const Log& log) {
    auto world = FluidWorld::create(device, params, given_, log, sources_);
    if (!world) return Error{fmt::format("{}: {}", scene_.name, world.error().message), world.error().fault};
    world_ = std::move(*world);
    return ok();
}

Status Session::importColliders() {
    for (size_t i = 0; i < scene_.colliders.size(); ++i) {
        const ColliderParams& collider = scene_.colliders[i];
        if (collider.shape != "mesh") continue;
        if (Status on = next("reading " + collider.mesh); !on) return on;
        if (!bender_) bender_ = makeCpuDevice(cpuKernels());
        Result<ColliderModel> model = ColliderModel::create(collider, scene_.folder, *bender_, solids_);
        if (!model) return about(model.error(), i, collider);
        if (model->dressed() && collider.materials == "file" && saysMaterial(collider))
            log_.notice(
                fmt::format("colliders[{}] ({}) is drawn with its file's materials: materials scene would take its colour from here", i,
                            collider.mesh));
        models_.push_back(std::move(*model));
        colliderOf_.push_back(i);
    }
    return takeViews(models_, scene_);
}

Result<Sources> Session::importEmitters() const {
    Sources sources{.sinks = scene_.sinks, .seconds = static_cast<double>(scene_.duration), .least = scene_.room};
    sources.expectedDeposit = SkinFlows::expectedPoured(scene_, sources.seconds);
    for (const EmitterParams& params : scene_.emitters) {
        Emitter emitter{params, {}};
        if (params.shape == "mesh") {
            Result<std::string> path = findAsset(params.mesh, scene_.folder);
            if (!path) return path.error();
            Result<Mesh> mesh = importMesh(*path);
            if (!mesh) return mesh.error();
            const mat4 place = params.fitSize > 0 ? Transform::fitted(mesh->bounds(), params.fitSize, params.position, params.rotation)
                                                  : Transform{params.position, params.rotation, 1.0F}.matrix();
            const Mesh placed = transformed(*mesh, place);
            for (const uint32_t i : placed.indices) emitter.triangles.push_back(placed.positions[i]);
        }
        sources.emitters.push_back(std::move(emitter));
    }
    if (scene_.pour.litres > 0) {
        sources.emitters.push_back({pouring(scene_.pour, scene_.fluid, std::nullopt), {}});
        sources.more = 1.0e-3 * double{scene_.pour.litres};
    }
    return sources;
}

// What may change while it runs, as it is now.
Sources Session::sourcesNow() const {
    Sources sources{.sinks = scene_.sinks};
    for (const EmitterParams& params : scene_.emitters) sources.emitters.push_back({params, {}});
    if (scene_.pour.litres > 0) sources.emitters.push_back({pouring(scene_.pour, scene_.fluid, pouredOnto_), {}});
    return sources;
}

void Session::pourOnto(const std::optional<vec3>& place) {
    if (replay_ || scene_.pour.litres <= 0 || place == pouredOnto_) return;
    pouredOnto_ = place;
    told(world_->setSources(sourcesNow()));
}

Status Session::addBodies(Solids& solids) {
    if (scene_.bodies.empty()) return ok();
    if (!deforming_.empty())
        return badInput(
            fmt::format("colliders[{}] bends, and bodies would pass through it: give it a motion instead, or leave the bodies out",
                        deforming_[0].collider));
    Result<std::vector<SceneBody>> made = sceneBodies(scene_);
    if (!made) return made.error();
    std::vector<BodyForm> forms;
    for (size_t i = 0; i < made->size(); ++i) {
        SceneBody& b = (*made)[i];
        const BodyParams& params = scene_.bodies[i];
        Node node;
        node.name = params.mesh.empty() ? params.shape : params.mesh;
        node.local = matrixOf(b.body.state.pose);
        node.mesh = std::make_shared<const Mesh>(std::move(b.mesh));
        node.material.baseColour = params.colour;
        node.material.roughness = params.roughness;
        node.visible = params.visible;
        const int main = solids_.add(std::move(node));
        bodyNodes_.push_back(static_cast<size_t>(main));
        for (size_t p = 0; p < b.parts.size(); ++p) {
            Node part;
            part.name = params.parts[p].mesh;
            part.parent = main;
            part.mesh = std::make_shared<const Mesh>(std::move(b.parts[p]));
            part.material.baseColour = params.parts[p].colour;
            part.material.roughness = params.parts[p].roughness;
            solids_.add(std::move(part));
        }
        forms.push_back(std::move(b.form));
        solids.bodies.push_back(std::move(b.body));
    }
    std::vector<MeshView> still, moving;
    std::vector<Pose> poses;
    for (size_t m = 0; m < models_.size(); ++m) {
        const ColliderParams& collider = scene_.colliders[colliderOf_[m]];
        if (collider.solid && !collider.motion.moves() && !models_[m].plays()) still.push_back(models_[m].mesh().view());
    }
    for (const Rigid& r : rigid_) {
        moving.push_back(models_[r.model].mesh().view());
        poses.push_back(poseOf(r.model, 0, 0));
    }
    contacts_ = std::make_unique<BulletSolids>(
        BulletSolids::Scene{.box = scene_.fluid.box, .planes = solids.planes, .still = still, .moving = moving, .poses = poses},
        solids.bodies, forms);
    solids.bodyHost = contacts_->host();
    return ok();
}

VoxelFieldOptions Session::fieldOptions(const Bounds& bounds, float edge) const {
    VoxelFieldOptions options;
    options.resolution = static_cast<int>(std::clamp(std::ceil(longest(bounds) / edge - 0.001F), 2.0F, 1.0e6F));
    // A particle must find the field before it touches: two spacings hold what a substep can move and the contact distance.
    options.band = 2 * scene_.fluid.spacing;
    options.padding = options.band;
    return options;
}

// What a collider asks for; where it leaves the choice, a quarter of the spacing, or the finest that memory holds.
float Session::voxelEdge(const ColliderParams& collider, const Bounds& bounds, const Log& log) const {
    const float side = longest(bounds);
    if (!(side > 0)) return 0.25F * scene_.fluid.spacing;
    if (collider.resolution > 0) return side / static_cast<float>(collider.resolution);
    constexpr float kMostVoxels = 2047;  // along a side: what a field takes
    const float wanted = 0.25F * scene_.fluid.spacing;
    float edge = std::min(wanted, 0.5F * side);
    const VoxelFieldOptions options = fieldOptions(bounds, edge);
    const auto bytes = [&] {
        const dvec3 voxels = (dvec3(bounds.size()) + 2.0 * std::max(options.band, kBandVoxels * edge)) / static_cast<double>(edge) + 2.0;
        return voxels.x * voxels.y * voxels.z * (sizeof(float) + sizeof(uint32_t) + 0.125);
    };
    while (bytes() > 0.9 * static_cast<double>(options.memoryLimit)) edge *= 1.05F;
    edge = std::max(edge, side / kMostVoxels);
    if (edge > 1.01F * wanted)
        log.notice(
            fmt::format("{} is too large for voxels of a quarter of the spacing: they are {:.3g} m instead of {:.3g} m, and water "
                        "rests {:.3g} m off it; a resolution would say otherwise",
                        collider.mesh, edge, wanted, std::max(0.5F * scene_.fluid.spacing, kContactVoxels * edge)));
    return edge;
}

Result<VoxelField> Session::bakeMeshes(std::span<const MeshView> views, std::span<const uint8_t> surfaces, float edge,
                                       const Log& log) const {
    Bounds all;
    for (const MeshView& view : views)
        for (const vec3& p : view.positions) all.add(p);
    VoxelFieldOptions options = fieldOptions(all, edge);
    options.surfaces = surfaces;
    return cachedVoxelField(views, options, log);
}

Status Session::bake(const Log& log) {
    // All that stands still becomes one field, whose voxels are the finest that any mesh asks for.
    float edge = std::numeric_limits<float>::max();
    std::vector<MeshView> still;
    std::vector<uint8_t> stillSurfaces;
    size_t one = 0;  // of those that stand still
    for (size_t m = 0; m < models_.size(); ++m) {
        const size_t c = colliderOf_[m];
        const ColliderParams& collider = scene_.colliders[c];
        if (Status on = next("voxels of " + collider.mesh); !on) return on;
        const uint8_t surface = surfaceOf_[c];
        const ColliderModel& model = models_[m];
        const Bounds bounds = model.mesh().bounds();
        const MeshView view = model.mesh().view();
        const bool whole = collider.motion.moves() || model.rigid();
        if (!collider.solid) {
            if (whole) shown_.push_back(m);
        } else if (whole) {
            Result<VoxelField> field = bakeMeshes(std::span(&view, 1), std::span(&surface, 1), voxelEdge(collider, bounds, log), log);
            if (!field) return about(field.error(), c, collider);
            rigid_.push_back({c, m, std::make_unique<VoxelField>(std::move(*field)), 0.0});
        } else if (collider.wave.amplitude > 0 || model.plays()) {
            const Bounds reach = model.plays() ? model.reach() : waveReach(collider.wave, bounds);
            VoxelFieldOptions options = fieldOptions(reach, voxelEdge(collider, reach, log));
            options.surfaces = std::span(&surface, 1);
            Result<DeformingField> field = DeformingField::create(std::span(&view, 1), reach, options);
            if (!field) return about(field.error(), c, collider);
            deforming_.push_back({c, m, std::make_unique<DeformingField>(std::move(*field)), model.mesh().positions, {}});
        } else {
            if (longest(bounds) > 0) edge = std::min(edge, voxelEdge(collider, bounds, log));
            still.push_back(view);
            one = c;
            stillSurfaces.push_back(surface);
        }
    }
    if (Status on = next("voxels of what stands still"); !on) return on;
    if (still.empty()) return ok();
    Result<VoxelField> field = bakeMeshes(still, stillSurfaces, edge, log);
    if (!field) return still.size() == 1 ? about(field.error(), one, scene_.colliders[one]) : field.error();
    field_ = std::move(*field);
    return ok();
}

bool Session::needsNew(const SceneFile& scene) const {
    if (scene.colliders.size() != scene_.colliders.size() || scene.bodies.size() != scene_.bodies.size()) return true;
    for (size_t i = 0; i < scene.colliders.size(); ++i) {
        const ColliderParams &a = scene_.colliders[i], &b = scene.colliders[i];
        if (a.motion.moves() != b.motion.moves() || (a.wave.amplitude > 0) != (b.wave.amplitude > 0)) return true;
    }
    if (scene.emitters.size() != scene_.emitters.size() || scene.sinks.size() != scene_.sinks.size()) return true;
    if ((scene.pour.litres > 0) != (scene_.pour.litres > 0)) return true;
    std::vector<uint8_t> surfaceOf;
    (void)surfacesOf(scene, surfaceOf);
    return surfaceOf != surfaceOf_ || flows_.needsNew(scene);
}

void Session::told(const Status& status) const {
    if (!status) log_.notice(status.error().message);
}

void Session::apply(const SceneFile& scene) {
    std::string folder = scene_.folder;
    scene_ = scene;
    scene_.folder = folder;
    if (budget_) applySetting(budget_->setting(), scene_);
    told(world_->setParams(simulated(scene_)));
    told(world_->setSources(sourcesNow()));
    flows_.apply(scene_);
    std::vector<uint8_t> unchanged;  // see needsNew
    told(world_->setSurfaces(surfacesOf(scene_, unchanged)));
    for (size_t m = 0; m < models_.size(); ++m)
        if (colliderOf_[m] < scene_.colliders.size()) models_[m].dress(scene_.colliders[colliderOf_[m]], solids_);
    for (size_t k = 0; k < bodyNodes_.size() && k < scene_.bodies.size(); ++k) {
        Node& node = solids_.nodes()[bodyNodes_[k]];
        node.material.baseColour = scene_.bodies[k].colour;
        node.material.roughness = scene_.bodies[k].roughness;
        node.visible = scene_.bodies[k].visible;
    }
}

// Steps the world with the solids where they are to be `seconds` from now.
void Session::advance(double seconds, double deviceMs) {
    FluidInputs inputs;
    inputs.deviceMs = deviceMs;
    const double before = world_->time(), ahead = world_->pending() + seconds, then = before + ahead;
    std::vector<Pose> poses;
    for (const Rigid& r : rigid_) {
        poses.push_back(poseOf(r.model, then, r.turned + double{scene_.colliders[r.collider].motion.spin} * ahead));
    }
    std::vector<std::span<const vec3>> shapes;
    for (Deforming& d : deforming_) {
        bend(d, then);
        shapes.emplace_back(d.shape);
    }
    if (contacts_) contacts_->moveTo(poses, seconds);
    inputs.poses = poses;
    inputs.shapes = shapes;
    world_->step(inputs, seconds);
    const double gone = world_->time() - before;  // less than asked where time slows
    if (Status flowed = flows_.step(scene_, *world_, gone, solids_); !flowed) log_.notice(flowed.error().message);
    for (Rigid& r : rigid_) r.turned = std::fmod(r.turned + double{scene_.colliders[r.collider].motion.spin} * gone, 360.0);
}

// Into its shape at `time` (s).
void Session::bend(Deforming& deforming, double time) {
    if (models_[deforming.model].plays())
        models_[deforming.model].shape(time, deforming.shape);
    else
        waveShape(scene_.colliders[deforming.collider].wave, deforming.rest, time, deforming.shape);
}

Pose Session::poseOf(size_t model, double time, double turned) const {
    return models_[model].rigid() ? models_[model].pose(time) : colliderPose(scene_.colliders[colliderOf_[model]], time, turned);
}

// A mesh that a wave bends is a new one in each picture.
void Session::bendNode(const Deforming& deforming, std::span<const vec3> positions) {
    if (models_[deforming.model].plays()) return;  // its nodes bend themselves
    Mesh mesh = models_[deforming.model].mesh();
    mesh.positions.assign(positions.begin(), positions.end());
    recomputeNormals(mesh);
    nodeOf(deforming.model).mesh = std::make_shared<const Mesh>(std::move(mesh));
}

// What only the time moves.
void Session::placeModels() {
    for (const size_t m : shown_)
        nodeOf(m).local = matrixOf(poseOf(m, time(), time() * double{scene_.colliders[colliderOf_[m]].motion.spin}));
    for (ColliderModel& model : models_)
        if (model.plays() && !model.rigid()) model.place(time(), solids_);
}

void Session::placeNodes() {
    const std::vector<Pose> poses = world_->drawnPoses();
    for (size_t k = 0; k < rigid_.size(); ++k) nodeOf(rigid_[k].model).local = matrixOf(poses[k]);
    for (size_t k = 0; k < bodyNodes_.size(); ++k) solids_.nodes()[bodyNodes_[k]].local = matrixOf(world_->bodies()[k].pose);
    for (const Deforming& d : deforming_) bendNode(d, d.field->positions());
    placeModels();
}

void Session::work(double asked, bool wait, double deviceMs) {
    const double start = hostSeconds();
    if (replay_) {
        replayed_ = replay_->next();
        worked_ = {.ms = 1000 * (hostSeconds() - start), .seconds = 0, .costMs = 0};
        return;
    }
    const double seconds = world_->acceptedSeconds(asked), before = world_->time();
    // Between two places a solid moves straight and turns the short way: a long frame is cut, so that it keeps to its path.
    const int parts = anyMoves() && seconds > 0 ? static_cast<int>(std::min(std::ceil(seconds * kFramesPerSecond - 1.0e-6), 1.0e4)) : 1;
    for (int k = 0; k < std::max(parts, 1); ++k) advance(seconds / std::max(parts, 1), deviceMs / std::max(parts, 1));
    if (wait) world_->device().finish();
    worked_ = {.ms = 1000 * (hostSeconds() - start), .seconds = world_->time() - before, .costMs = deviceMs};
    // A GPU that nobody waits for works on after the call: what its passes took, some frames ago, says what a frame costs.
    if (wait || world_->device().backend() == Backend::cpu) worked_.costMs = worked_.ms;
}

double Session::settle() {
    const double start = hostSeconds();
    if (replay_) {
        placeRecorded();
        return worked_.ms + 1000 * (hostSeconds() - start);
    }
    if (anyMoves() || contacts_) placeNodes();
    worked_.ms += 1000 * (hostSeconds() - start);
    world_->device().poll();
    if (budget_) watchBudget(worked_.costMs, worked_.seconds);
    // Of what steps take, snapshots take a hundredth.
    constexpr double kSnapshots = 0.01;
    steppedMs_ += worked_.costMs;
    if (world_->device().backend() == Backend::cl && steppedMs_ * kSnapshots >= snapshotMs_) takeSnapshot();
    return worked_.ms;
}

bool Session::anyMoves() const {
    const auto plays = [](const ColliderModel& model) { return model.plays(); };
    return !rigid_.empty() || !deforming_.empty() || !shown_.empty() || !flows_.empty() ||
           std::any_of(models_.begin(), models_.end(), plays);
}

bool Session::mayWorkAside() const {
    const auto bends = [this](const Deforming& d) { return models_[d.model].plays(); };  // what is drawn is what water meets
    return !replay_ && world_->device().backend() == Backend::cpu && flows_.empty() &&
           std::none_of(deforming_.begin(), deforming_.end(), bends);
}

void Session::takeSnapshot() {
    const Device& device = world_->device();
    if (device.health().state == DeviceHealth::lost || !world_->savable()) return;
    const auto start = std::chrono::steady_clock::now();
    Snapshot now;
    for (const Rigid& r : rigid_) now.turned.push_back(r.turned);
    world_->save(now.world);
    now.flows = flows_.save();
    if (device.health().state == DeviceHealth::lost) return;  // what was read is nothing
    kept_ = std::move(now);
    steppedMs_ = 0;
    snapshotMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Status Session::moveTo(Device& device) {
    takeSnapshot();
    // What there is to say of the scene was said when it was opened.
    const auto opening = std::make_shared<bool>(true);
    const Log quiet{[log = log_, opening](LogLevel level, std::string_view text) {
        if (!*opening && log.sink) log.sink(level, text);
    }};
    for (Deforming& d : deforming_)  // as they were when the world was made
        if (const auto back = d.field->update(d.rest); !back) return back.error();
    FluidParams params = world_->params();  // of the scene's, an edit may be under way
    if (device.backend() == Backend::cpu) params.grid = scene_.fluid.grid = "sorted";
    if (Status made = makeWorld(device, params, quiet); !made) return made;
    told(world_->setSources(sourcesNow()));
    std::vector<uint8_t> unchanged;  // see needsNew
    told(world_->setSurfaces(surfacesOf(scene_, unchanged)));
    if (Status moved = flows_.moveTo(device, scene_, solids_, quiet, kept_ ? kept_->flows.get() : nullptr); !moved) return moved;
    *opening = false;
    if (!kept_) {
        world_->reset();
        startSolids();
        return ok();
    }
    for (size_t k = 0; k < rigid_.size(); ++k) rigid_[k].turned = kept_->turned[k];
    WorldState state = std::move(kept_->world);
    kept_.reset();
    (void)state.takeText("world.params");
    state.putText("world.params", fixedValues([&params](ParamVisitor& v) { params.visit(v); }));  // another grid holds the same particles
    if (Status done = world_->restore(state); !done) return done;
    placeNodes();
    return ok();
}

void Session::watchBudget(double ms, double seconds) {
    std::string sentence;
    if (budget_->frame(ms, seconds, world_->stats().avgCompression, sentence)) {
        applySetting(budget_->setting(), scene_);
        told(world_->setParams(simulated(scene_)));
    }
    if (!sentence.empty()) log_.notice(sentence);
}

void Session::reset() {
    if (replay_) {
        replay_->seek(0);
        replayed_ = replay_->next();
        placeRecorded();
        return;
    }
    world_->reset();
    if (Status fresh = flows_.reset(scene_, world_->device(), solids_, log_); !fresh) log_.notice(fresh.error().message);
    startSolids();
    kept_.reset();
    steppedMs_ = snapshotMs_ = 0;
}

void Session::startSolids() {
    for (Rigid& r : rigid_) r.turned = 0;
    if (contacts_) contacts_->moveTo(world_->poses(), 0);
    placeNodes();
}

}  // namespace rivulet
