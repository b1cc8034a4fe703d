#include "fluid/session/scene_solids.h"

#include <algorithm>
#include <cmath>

#include "fluid/io/recording.h"
#include "fluid/scene/collider_motion.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

SolidFields SceneSolids::fields() const {
    SolidFields all;
    if (!still_.empty()) all.still = &still_;
    for (const Rigid& r : rigid_) all.rigid.push_back(r.field.get());
    for (const Deforming& d : deforming_) all.deforming.push_back(&d.field->field());
    return all;
}

bool SceneSolids::anyMoves() const {
    const auto plays = [](const ColliderModel& model) { return model.plays(); };
    return !rigid_.empty() || !deforming_.empty() || !shown_.empty() || std::any_of(models_.begin(), models_.end(), plays);
}

bool SceneSolids::bendsAsDrawn() const {
    return std::any_of(deforming_.begin(), deforming_.end(), [this](const Deforming& d) { return models_[d.model].plays(); });
}

void SceneSolids::apply(const SceneFile& scene) {
    for (size_t m = 0; m < models_.size(); ++m)
        if (colliderOf_[m] < scene.colliders.size()) models_[m].dress(paramsOf(scene, m), nodes_);
    for (size_t k = 0; k < bodyNodes_.size() && k < scene.bodies.size(); ++k) {
        Node& node = nodes_.nodes()[bodyNodes_[k]];
        node.material.baseColour = scene.bodies[k].colour;
        node.material.roughness = scene.bodies[k].roughness;
        node.material.porosity = scene.bodies[k].porosity;
        node.visible = scene.bodies[k].visible;
    }
}

Pose SceneSolids::poseOf(const SceneFile& scene, size_t model, double time, double turned) const {
    return models_[model].rigid() ? models_[model].pose(time) : colliderPose(paramsOf(scene, model), time, turned);
}

SceneSolids::Motion SceneSolids::motionAt(const SceneFile& scene, double time, double ahead) {
    Motion motion;
    for (const Rigid& r : rigid_)
        motion.poses.push_back(poseOf(scene, r.model, time, r.turned + double{paramsOf(scene, r.model).motion.spin} * ahead));
    motion.contacts = motion.poses;
    for (const size_t m : dry_) motion.contacts.push_back(poseOf(scene, m, time, time * double{paramsOf(scene, m).motion.spin}));
    for (Deforming& d : deforming_) {
        if (models_[d.model].plays())
            models_[d.model].shape(time, d.shape);
        else
            waveShape(paramsOf(scene, d.model).wave, d.rest, time, d.shape);
        motion.shapes.emplace_back(d.shape);
    }
    return motion;
}

void SceneSolids::moveContacts(const Motion& motion, double seconds) {
    if (contacts_) contacts_->moveTo(motion.contacts, seconds);
}

void SceneSolids::advance(const SceneFile& scene, double seconds) {
    for (Rigid& r : rigid_) r.turned = std::fmod(r.turned + double{paramsOf(scene, r.model).motion.spin} * seconds, 360.0);
}

void SceneSolids::toStart(const FluidWorld& world) {
    for (Rigid& r : rigid_) r.turned = 0;
    std::vector<Pose> contacts = world.poses();
    contacts.insert(contacts.end(), dryStart_.begin(), dryStart_.end());
    if (contacts_) contacts_->moveTo(contacts, 0);
}

Status SceneSolids::rest() {
    for (Deforming& d : deforming_)
        if (const auto back = d.field->update(d.rest); !back) return back.error();
    return ok();
}

std::vector<double> SceneSolids::turned() const {
    std::vector<double> all;
    for (const Rigid& r : rigid_) all.push_back(r.turned);
    return all;
}

void SceneSolids::setTurned(std::span<const double> turned) {
    for (size_t k = 0; k < rigid_.size(); ++k) rigid_[k].turned = turned[k];
}

void SceneSolids::setTurned(const SceneFile& scene, const SceneSolids& other, const SceneFile& before) {
    for (Rigid& r : rigid_)
        for (const Rigid& was : other.rigid_)
            if (other.colliderOf_[was.model] == colliderOf_[r.model] &&
                paramsOf(scene, r.model).mesh == other.paramsOf(before, was.model).mesh)
                r.turned = was.turned;
}

// A mesh that a wave bends is a new one in each picture.
void SceneSolids::bendNode(const Deforming& deforming, std::span<const vec3> positions) {
    if (models_[deforming.model].plays()) return;  // its nodes bend themselves
    Mesh mesh = models_[deforming.model].mesh();
    mesh.positions.assign(positions.begin(), positions.end());
    recomputeNormals(mesh);
    nodeOf(deforming.model).mesh = std::make_shared<const Mesh>(std::move(mesh));
}

// What only the time moves.
void SceneSolids::placeModels(const SceneFile& scene, double time) {
    for (const size_t m : shown_) nodeOf(m).local = matrixOf(poseOf(scene, m, time, time * double{paramsOf(scene, m).motion.spin}));
    for (ColliderModel& model : models_)
        if (model.plays() && !model.rigid()) model.place(time, nodes_);
}

void SceneSolids::placeNodes(const SceneFile& scene, const FluidWorld& world) {
    const std::vector<Pose> poses = world.drawnPoses();
    for (size_t k = 0; k < rigid_.size(); ++k) nodeOf(rigid_[k].model).local = matrixOf(poses[k]);
    if (!bodyNodes_.empty()) {
        const std::vector<BodyState>& states = world.expectedBodies();
        for (size_t k = 0; k < bodyNodes_.size(); ++k) nodes_.nodes()[bodyNodes_[k]].local = matrixOf(states[k].pose);
    }
    for (const Deforming& d : deforming_) bendNode(d, d.field->positions());
    placeModels(scene, world.time());
    wetNodes(world.wetness().surface.get());
}

// Tells each node where its wetness is stored (Node::wet). `surface` is null if the world has no wetness: then no node has any.
void SceneSolids::wetNodes(const WetSurface* surface) {
    for (size_t n = 0; n < nodes_.nodes().size(); ++n) {
        Node& node = nodes_.nodes()[n];
        node.wet.reset();
        const SceneThing thing = thingOf(n);
        if (surface == nullptr || !node.mesh || thing.kind == SceneThing::Kind::none) continue;
        SolidRef ref{ProbeOn::body, static_cast<uint32_t>(thing.index)};
        if (thing.kind == SceneThing::Kind::collider) ref = solids_.colliders[thing.index];
        const WetSolid* found = surface->find(ref);
        if (found == nullptr) continue;
        const mat4 place = ref.on == ProbeOn::rigid  ? nodeOf(rigid_[ref.index].model).local
                           : ref.on == ProbeOn::body ? nodes_.nodes()[bodyNodes_[ref.index]].local
                                                     : mat4(1.0F);
        node.wet = WetGrid{found->cellsFromWorld(place), found->size, found->firstCell};
    }
}

size_t SceneSolids::recordedCorners() const {
    size_t corners = 0;
    for (const Deforming& d : deforming_) corners += d.rest.size();
    return corners;
}

bool SceneSolids::fits(const RecordedFrame& frame) const {
    return frame.places.size() == recordedPlaces() && frame.corners.size() == recordedCorners();
}

void SceneSolids::placesInto(RecordedFrame& frame, std::span<const BodyState> bodies) const {
    for (const Rigid& r : rigid_) frame.places.push_back(nodeOf(r.model).local);
    for (size_t k = 0; k < bodyNodes_.size(); ++k)
        frame.places.push_back(bodies.empty() ? nodes_.nodes()[bodyNodes_[k]].local : matrixOf(bodies[k].pose));
    for (const Deforming& d : deforming_)
        frame.corners.insert(frame.corners.end(), d.field->positions().begin(), d.field->positions().end());
}

// A frame of other solids than the first has is no frame of this recording: nothing moves then.
void SceneSolids::placeNodes(const SceneFile& scene, const RecordedFrame& frame) {
    if (!fits(frame)) return;
    auto place = frame.places.begin();
    for (const Rigid& r : rigid_) nodeOf(r.model).local = *place++;
    for (const size_t node : bodyNodes_) nodes_.nodes()[node].local = *place++;
    auto next = frame.corners.begin();
    for (const Deforming& d : deforming_) {
        bendNode(d, std::span(next, d.rest.size()));
        next += static_cast<std::ptrdiff_t>(d.rest.size());
    }
    placeModels(scene, frame.time);
}

}  // namespace rivulet
