#include "fluid/scene/flow_component.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include "engine/core/table.h"
#include "engine/scene/import_model.h"
#include "fluid/flow/unwrap.h"
#include "fluid/scene/head_look.h"
#include "fluid/scene/move_pictures.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;
constexpr float kBrimStep = 6.0e-4F;  // m, between the places of a brim
constexpr int kMostBrimPlaces = 400;
constexpr const char *kBrimMorphs[] = {"brimLeft", "brimRight"}, *kBlinkMorphs[] = {"blinkLeft", "blinkRight"};
constexpr double kReddened = 20 * kMicrolitre;  // of tears, after which eyes are about as red as they become

vec3 along(const std::vector<vec3>& line, float way) {
    for (size_t k = 1; k < line.size(); ++k) {
        const float step = glm::distance(line[k - 1], line[k]);
        if (way <= step || k + 1 == line.size()) return glm::mix(line[k - 1], line[k], step > 0 ? std::min(way / step, 1.0F) : 0.0F);
        way -= step;
    }
    return line.front();
}

// True if `list` ("M_Iris*, M_EyeBlend") names a part, by its own name or its material's.
bool named(std::string_view list, const ModelPart& part) {
    while (!list.empty()) {
        std::string_view one = list.substr(0, list.find(','));
        list.remove_prefix(std::min(one.size() + 1, list.size()));
        while (one.starts_with(' ')) one.remove_prefix(1);
        const bool like = one.ends_with('*');
        if (like) one.remove_suffix(1);
        for (const std::string& name : {part.name, part.materialName})
            if (!one.empty() && (like ? name.starts_with(one) : name == one)) return true;
    }
    return false;
}

// Splits vertices, so that each has one UV of `uvs` (3 per triangle of `mesh`, which was made from the part). Returns the old vertex of
// each.
std::vector<uint32_t> split(ModelPart& part, const FlowMesh& mesh, const std::vector<vec2>& uvs) {
    Mesh fresh;
    fresh.name = part.mesh.name;
    std::map<std::tuple<uint32_t, float, float>, uint32_t> known;
    std::vector<std::vector<uint32_t>> become(part.mesh.positions.size());
    std::vector<Grip> grips;
    std::vector<uint32_t> old;
    for (size_t t = 0; t < mesh.triangleCount(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            uint32_t from = mesh.given[mesh.corner[3 * t + k]];
            for (size_t c = 0; c < 3; ++c)
                if (const uint32_t i = part.mesh.indices[3 * size_t{mesh.source[t]} + c];
                    part.mesh.positions[i] == mesh.rest[mesh.corner[3 * t + k]])
                    from = i;
            const vec2 uv = uvs[3 * t + k];
            const auto [at, added] = known.try_emplace({from, uv.x, uv.y}, static_cast<uint32_t>(fresh.positions.size()));
            if (added) {
                fresh.positions.push_back(part.mesh.positions[from]);
                if (!part.mesh.normals.empty()) fresh.normals.push_back(part.mesh.normals[from]);
                fresh.uvs.push_back(uv);
                if (!part.grips.empty()) grips.push_back(part.grips[from]);
                become[from].push_back(at->second);
                old.push_back(from);
            }
            fresh.indices.push_back(at->second);
        }
    for (MorphTarget& morph : part.morphs) {
        std::vector<std::pair<uint32_t, vec3>> moved;
        for (size_t k = 0; k < morph.vertices.size(); ++k)
            for (const uint32_t v : become[morph.vertices[k]]) moved.emplace_back(v, morph.offsets[k]);
        std::sort(moved.begin(), moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        morph.vertices.clear();
        morph.offsets.clear();
        for (const auto& [v, offset] : moved) {
            morph.vertices.push_back(v);
            morph.offsets.push_back(offset);
        }
    }
    part.mesh = std::move(fresh);
    part.grips = std::move(grips);
    return old;
}

// Marble scatters all colours alike, some millimetres deep (Jensen et al. 2001).
Material marbleOf(const Material& own) {
    static const auto look = [] {
        auto made = std::make_shared<SkinLook>();
        made->scatter = vec3(2.2e-3F, 2.6e-3F, 2.4e-3F);
        made->translucency = 0.4F;
        made->pores = 0.25F;
        return made;
    }();
    Material marble;
    marble.baseColour = vec3(0.56F, 0.545F, 0.51F);
    marble.roughness = 0.5F;
    marble.doubleSided = own.doubleSided;
    marble.skin = look;
    return marble;
}

float lengthOf(const std::vector<vec3>& line) {
    float sum = 0;
    for (size_t k = 1; k < line.size(); ++k) sum += glm::distance(line[k - 1], line[k]);
    return sum;
}

}  // namespace

Result<std::unique_ptr<FlowComponent>> FlowComponent::create(const FlowParams& params, const std::string& sceneFolder, Device& device,
                                                             Scene& scene, const Log& log) {
    std::unique_ptr<FlowComponent> made(new FlowComponent());
    FlowComponent& c = *made;
    c.params_ = params;
    c.device_ = &device;
    c.log_ = log;
    Result<SkinModel> loaded = loadSkinModel(params, sceneFolder);
    if (!loaded) return loaded.error();
    Result<FoundFace> face = c.takeMarks(*loaded, sceneFolder);
    if (!face) return face.error();
    Model& model = loaded->model;
    if (Status dressed = dressHead(model, fs::path(loaded->path).parent_path().string()); !dressed) return dressed.error();
    wetFoundEyes(model, loaded->skin, *face);
    ModelPart& skin = model.parts[loaded->skin];
    if (Status laid = c.layOut(skin, log); !laid) return laid.error();
    if (Status added = c.addParts(model, &skin, scene); !added) return added.error();
    if (Status ready = c.prepareFlow(skin.mesh); !ready) return ready.error();
    c.lookIntoLids();
    if (Status masked = c.readRegions(sceneFolder, skin.mesh); !masked) return masked.error();
    c.apply(params);
    c.placeNode(scene);
    return made;
}

// The face that was sought for them, if it was.
Result<FoundFace> FlowComponent::takeMarks(const SkinModel& skin, const std::string& sceneFolder) {
    Result<SkinMarks> marks = skinMarks(params_, sceneFolder, skin, needsMarks(params_) ? Seek::ifMarksAreMissing : Seek::never);
    if (!marks) return marks.error();
    marks_ = marks->marks;
    if (!marks->notice.empty()) log_.notice(marks->notice);
    if (constexpr float kUpright = 0.7F; marks->found.found() && marks->found.up.y < kUpright) {
        const vec3 turn = uprightRotation(params_, marks->found.up, marks->found.forward);
        log_.notice(fmt::format("{} stands on its side or its head, and tears run down -Y: set its rotation to {}, {}, {}", params_.mesh,
                                turn.x, turn.y, turn.z));
    }
    return std::move(marks->found);
}

// Usable UVs: the mesh's, or new ones, for which its vertices are split at the edges of charts.
Status FlowComponent::layOut(ModelPart& skin, const Log& log) {
    Result<FlowMesh> mesh = makeFlowMesh(skin.mesh.view());
    if (!mesh) return badInput(fmt::format("{}: {}", params_.mesh, mesh.error().message));
    if (const std::string found = mesh->report.sentence(); !found.empty()) log.info(fmt::format("{}: {}", params_.mesh, found));
    Result<SkinUvs> uvs = skinUvs(*mesh, skin.mesh.view(), std::clamp(params_.mapSize, 256, 2048));
    if (!uvs) return badInput(fmt::format("{}: {}", params_.mesh, uvs.error().message));
    if (!uvs->notice.empty()) log.notice(fmt::format("{}: {}", params_.mesh, uvs->notice));
    if (uvs->unwrapped) {
        const std::vector<vec2> given = cornerUvs(*mesh, skin.mesh.view());
        if (!given.empty()) {
            if (movePictures(skin.material, given, uvs->uvs, std::clamp(params_.mapSize, 256, 2048)))
                log.notice(fmt::format("{}: its pictures were drawn anew on the new UVs; a normal map is left out", params_.mesh));
            maskUvs_ = std::move(skin.mesh.uvs);  // of the vertices before the split
        }
        maskOf_ = split(skin, *mesh, uvs->uvs);
        mesh = makeFlowMesh(skin.mesh.view());
        if (!mesh) return mesh.error();
    }
    uvs_ = cornerUvs(*mesh, skin.mesh.view());
    return ok();
}

Status FlowComponent::addParts(Model& model, const ModelPart* skin, Scene& scene) {
    std::vector<std::string> morphNames;
    for (const ModelPart& part : model.parts)
        for (const MorphTarget& m : part.morphs) morphNames.push_back(m.name);
    for (const ExpressionParams& e : params_.expression)
        if (!e.morph.empty() && std::find(morphNames.begin(), morphNames.end(), e.morph) == morphNames.end()) {
            const std::string near = nearestName(e.morph, morphNames);
            return badInput(fmt::format("{} has no morph target `{}`{}", params_.mesh, e.morph,
                                        near.empty() ? std::string() : fmt::format("; did you mean {}?", near)));
        }
    Node group;
    group.name = params_.mesh;
    group_ = scene.add(std::move(group));
    layer_ = std::make_shared<Layer>();
    const std::vector<mat4> stand = model.worldMatrices();
    std::vector<vec3> eyes;
    for (const ModelPart& part : model.parts)
        if (part.material.eye) eyes.push_back(part.material.eye->centre);
    findBlinks(*skin);
    for (ModelPart& part : model.parts) {
        Node node;
        node.name = part.name;
        node.parent = group_;
        node.material = part.material;
        node.visible = !named(params_.hide, part);
        if (named(params_.skinParts, part)) {
            auto look = std::make_shared<SkinLook>();
            node.material.skin = look;
        }
        if (&part == skin) {
            node.layer = layer_;
            if (!part.material.colour && !node.material.skin) {
                node.material = params_.material;
                node.material.blended = params_.material.opacity < 1;
            }
        }
        std::optional<EyeTurns> turns = &part != skin ? takeEyeTurns(part, eyes) : std::nullopt;
        if (!part.morphs.empty() || !part.grips.empty()) {
            Result<Deformer> deformer = Deformer::create(*device_, part);
            if (!deformer) return deformer.error();
            Deformed d;
            d.deformer = std::make_shared<Deformer>(std::move(*deformer));
            d.morphs = part.morphs.size();
            for (const ExpressionParams& e : params_.expression) {
                const auto at =
                    std::find_if(part.morphs.begin(), part.morphs.end(), [&](const MorphTarget& m) { return m.name == e.morph; });
                d.morphOf.push_back(at == part.morphs.end() ? -1 : static_cast<int>(at - part.morphs.begin()));
            }
            for (size_t side = 0; side < 2; ++side)
                for (size_t m = 0; m < part.morphs.size(); ++m)
                    if (&part != skin && part.morphs[m].name == kBrimMorphs[side]) d.brimMorph[side] = static_cast<int>(m);
            if (!part.grips.empty()) d.bones = model.boneMatrices(part, stand);
            d.deformer->run({}, d.bones);
            node.deformer = d.deformer;
            if (&part == skin) skinDeformer_ = d.deformer;
            deformed_.push_back(std::move(d));
        }
        node.mesh = std::make_shared<const Mesh>(part.mesh);
        looks_.push_back({node.material, node.visible});
        const int at = scene.add(std::move(node));
        if (turns) turningEyes_.push_back({at, std::move(*turns)});
    }
    return ok();
}

Status FlowComponent::prepareFlow(const Mesh& skin) {
    Result<FlowMesh> mesh = makeFlowMesh(skin.view());
    if (!mesh) return mesh.error();
    for (size_t side = 0; side < 2; ++side)
        if (marks_.eyes[side].tear) tears_[side] = nearestPoint(*mesh, *marks_.eyes[side].tear);
    for (const FlowSourceParams& source : params_.sources)
        if (const std::string fault = faultOf(source); source.rate > 0 && !fault.empty()) return badInput(fault);
    // The thesis has no lids: liquid of a brim begins below the corner of the eye.
    const std::vector<SkinBrim> along = thesis() ? std::vector<SkinBrim>() : brims(*mesh);
    Result<SurfaceFlow> flow = thesis() ? SurfaceFlow::createThesis(*device_, std::move(*mesh), uvs_, params_.liquid, params_.thesis)
                                        : SurfaceFlow::create(*device_, std::move(*mesh), params_.liquid, along);
    if (!flow) return badInput(fmt::format("{}: {}", params_.mesh, flow.error().message));
    flow_.emplace(std::move(*flow));
    placed_.emplace(*flow_, [this](double time) { return worldAt(time); });
    if (thesis()) return ok();  // its picture needs the UVs
    Result<FlowMaps> maps = FlowMaps::create(*flow_, std::exchange(uvs_, {}), params_.mapSize);
    if (!maps) return badInput(fmt::format("{}: {}", params_.mesh, maps.error().message));
    maps_.emplace(std::move(*maps));
    maps_->leaveOutHanging(true);  // a scene draws them with SkinFlows::pendants()
    return ok();
}

// One place about every half millimetre along each lower lid. Spilled liquid begins on the skin below.
std::vector<SkinBrim> FlowComponent::brims(const FlowMesh& mesh) {
    std::vector<SkinBrim> all;
    for (size_t side = 0; side < 2; ++side) {
        const std::vector<vec3>& lid = marks_.eyes[side].lowerLid;
        brimBegin_[side + 1] = brimBegin_[side];
        if (lid.size() < 2) continue;
        const float length = lengthOf(lid);
        SkinBrim brim;
        brim.picolitres = static_cast<uint32_t>(double{params_.liquid.brimStarts} * kMicrolitre);
        const int places = std::clamp(static_cast<int>(std::min(length / kBrimStep, 1.0e6F)), 4, kMostBrimPlaces);
        for (int k = 0; k < places; ++k) {
            const vec3 x = along(lid, length * (static_cast<float>(k) + 0.5F) / static_cast<float>(places));
            brim.places.push_back(nearestPoint(mesh, x));
            brim.spills.push_back(nearestPoint(mesh, x - 0.0025F * marks_.up + 0.0015F * marks_.forward));
        }
        brimBegin_[side + 1] += static_cast<uint32_t>(places);
        emitted_ += uint64_t{brim.picolitres / static_cast<uint32_t>(places)} * static_cast<uint32_t>(places);
        all.push_back(std::move(brim));
    }
    return all;
}

Status FlowComponent::readRegions(const std::string& sceneFolder, const Mesh& skin) {
    const FlowMesh& mesh = flow_->mesh();
    oily_.assign(mesh.rest.size(), 255);
    if (!params_.regions.mask.empty()) {
        Result<std::string> path = findAsset(params_.regions.mask, sceneFolder);
        if (!path) return path.error();
        const Result<std::shared_ptr<const Image>> read = importImage(*path);
        if (!read) return read.error();
        const Image& mask = **read;
        // A mask lies over the UVs of the file.
        std::vector<vec2> uvs = skin.uvs;
        if (!maskOf_.empty()) {
            uvs.clear();
            for (const uint32_t v : maskOf_)
                if (v < maskUvs_.size()) uvs.push_back(maskUvs_[v]);
        }
        if (uvs.empty()) return badInput(fmt::format("{} has no UVs, so the mask {} cannot be used", params_.mesh, params_.regions.mask));
        std::vector<float> grip;
        grip.reserve(mesh.rest.size());
        for (size_t p = 0; p < mesh.rest.size(); ++p) {
            vec2 uv = uvs[mesh.given[p]] - glm::floor(uvs[mesh.given[p]]);
            if (!std::isfinite(uv.x + uv.y)) uv = vec2(0.0F);
            const auto x = std::min(static_cast<size_t>(uv.x * static_cast<float>(mask.width)), static_cast<size_t>(mask.width) - 1);
            const auto y = std::min(static_cast<size_t>(uv.y * static_cast<float>(mask.height)), static_cast<size_t>(mask.height) - 1);
            const uint8_t* texel = &mask.rgba[4 * (y * static_cast<size_t>(mask.width) + x)];
            const float factor[] = {params_.regions.oily, params_.regions.dry, params_.regions.hair, params_.regions.lip};
            float g = 1;
            for (size_t k = 0; k < 4; ++k) g *= 1 + (factor[k] - 1) * static_cast<float>(texel[k]) / 255.0F;
            grip.push_back(g);
            oily_[p] = texel[0];
        }
        flow_->setGrip(grip);
    }
    // Sweat appears mostly where a skin is oily.
    double sum = 0;
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
        const uint32_t* c = &mesh.corner[3 * size_t{t}];
        const double area = 0.5 * double{glm::length(glm::cross(mesh.rest[c[1]] - mesh.rest[c[0]], mesh.rest[c[2]] - mesh.rest[c[0]]))};
        sum += area * (0.03 + (oily_[c[0]] + oily_[c[1]] + oily_[c[2]]) / 765.0);
        areaTo_.push_back(sum);
    }
    return ok();
}

void FlowComponent::apply(const FlowParams& params) {
    // Values that determine the size of tables or the files read keep their value, also while a panel edits them.
    const FlowParams before = std::exchange(params_, params);
    params_.mode = before.mode;
    params_.mesh = before.mesh;
    params_.part = before.part;
    params_.position = before.position;
    params_.mapSize = before.mapSize;
    params_.regions = before.regions;
    for (size_t e = 0; e < std::min(before.expression.size(), params_.expression.size()); ++e)
        params_.expression[e].morph = before.expression[e].morph;
    // The reader of the scene has already checked the values.
    (void)flow_->setParams(params.liquid);
    if (thesis()) (void)flow_->setThesis(params.thesis);
    layer_->look = params.look;
    while (sources_.size() < params.sources.size()) {
        Source fresh;
        fresh.random = std::mt19937(static_cast<uint32_t>(11 + 7 * sources_.size()));
        sources_.push_back(fresh);
    }
}

bool FlowComponent::needsNew(const FlowParams& params) const {
    return params.expression.size() != params_.expression.size() || (needsMarks(params) && !needsMarks(params_));
}

void FlowComponent::noticeOnce(const std::string& sentence) {
    if (std::find(noticed_.begin(), noticed_.end(), sentence) != noticed_.end()) return;
    noticed_.push_back(sentence);
    log_.notice(sentence);
}

Status FlowComponent::step(double time, double seconds, const vec3& gravity, std::vector<AirDrop>& air) {
    const double then = time + seconds;
    placed_->moveTo(then);
    around_ = {};
    acted_ += seconds * double{params_.pace};
    bend(acted_);
    emit(time, seconds, air);
    const dmat4& toWorld = placed_->toWorld();
    SurfaceFlowInputs inputs{.gravity = gravity, .wind = params_.wind, .toWorld = toWorld};
    if (skinDeformer_) inputs.moved = &skinDeformer_->positions();
    if (Status moved = flow_->step(inputs, seconds); !moved) return moved;
    lookIntoLids();
    if (flow_->refused() > 0)
        noticeOnce("a skin has no free drop slots: further drops are discarded and counted as drained; raise flow.liquid.capacity");
    for (const LeftDrop& d : flow_->takeLeft()) {
        AirDrop& drop = air.emplace_back(
            AirDrop{dvec3(toWorld * glm::dvec4(dvec3(d.position), 1)), glm::dmat3(toWorld) * dvec3(d.velocity), d.picolitres});
        if (d.hung) drop.hung = placed_->hung(*d.hung);
    }
    return ok();
}

// Asks how full the lids are, for what is drawn only: the answer may come some steps later.
void FlowComponent::lookIntoLids() {
    if (brimBegin_[2] == 0) return;
    const double holds = double{params_.liquid.brimHolds} * kMicrolitre;
    const std::array<bool, 2> there = {brimBegin_[1] > 0, brimBegin_[2] > brimBegin_[1]};
    flow_->brimsLater([full = std::weak_ptr(lidsFull_), holds, there](std::span<const uint64_t> content) {
        const std::shared_ptr<std::array<float, 2>> into = full.lock();
        if (!into) return;
        size_t brim = 0;
        for (size_t side = 0; side < 2; ++side)
            if (there[side]) (*into)[side] = std::min(static_cast<float>(static_cast<double>(content[brim++]) / holds), 1.0F);
    });
}

void FlowComponent::findBlinks(const ModelPart& skin) {
    for (size_t side = 0; side < 2; ++side)
        for (size_t m = 0; m < skin.morphs.size(); ++m) {
            if (skin.morphs[m].name != kBlinkMorphs[side]) continue;
            const std::vector<float> shares = sharesOfBlink(skin.morphs, m);
            for (const ExpressionParams& e : params_.expression) {
                const auto at =
                    std::find_if(skin.morphs.begin(), skin.morphs.end(), [&](const MorphTarget& t) { return t.name == e.morph; });
                blinkShares_[side].push_back(at == skin.morphs.end() ? 0 : shares[static_cast<size_t>(at - skin.morphs.begin())]);
            }
        }
}

// The weight of each of params_.expression at a time. A blink takes the lids the rest of their way, from wherever the others have left
// them.
std::vector<float> FlowComponent::weightsAt(double time) const {
    std::vector<float> weights;
    for (const ExpressionParams& e : params_.expression) weights.push_back(params_.expressive * static_cast<float>(e.at(time)));
    for (size_t side = 0; side < 2; ++side) {
        const std::vector<float>& shares = blinkShares_[side];
        const auto blinks = [&](size_t e) { return params_.expression[e].morph == kBlinkMorphs[side]; };
        float moved = 0;
        const size_t rows = std::min(weights.size(), shares.size());
        for (size_t e = 0; e < rows; ++e)
            if (!blinks(e)) moved += weights[e] * shares[e];
        for (size_t e = 0; e < rows; ++e)
            if (blinks(e)) weights[e] *= std::max(1 - moved, 0.0F);
    }
    return weights;
}

// Sets the expression at a time.
void FlowComponent::bend(double time) {
    const std::vector<float> expression = weightsAt(time);
    for (Deformed& d : deformed_) {
        std::vector<float> weights(d.morphs, 0.0F);
        for (size_t e = 0; e < std::min(d.morphOf.size(), expression.size()); ++e)
            if (d.morphOf[e] >= 0) weights[static_cast<size_t>(d.morphOf[e])] += expression[e];
        for (size_t side = 0; side < 2; ++side)
            if (d.brimMorph[side] >= 0) weights[static_cast<size_t>(d.brimMorph[side])] += (*lidsFull_)[side];
        d.deformer->run(weights, d.bones);
    }
}

dmat4 FlowComponent::worldAt(double time) const { return glm::translate(dmat4(1.0), dvec3(params_.position)) * params_.motion.at(time); }

void FlowComponent::placeNode(Scene& scene) const {
    scene.nodes()[static_cast<size_t>(group_)].local = mat4(placed_->toWorld());
    const std::vector<float> expression = weightsAt(acted_);
    for (const TurningEye& eye : turningEyes_) {
        vec3 turn(0.0F);
        for (size_t e = 0; e < expression.size(); ++e)
            if (const auto found = eye.turns.turns.find(params_.expression[e].morph); found != eye.turns.turns.end())
                turn += expression[e] * found->second;
        scene.nodes()[static_cast<size_t>(eye.node)].local = eye.turns.at(turn);
    }
    const double wept = 1 - std::exp(-static_cast<double>(emitted_) / kReddened);
    for (size_t k = 0; k < looks_.size(); ++k) {
        Node& node = scene.nodes()[static_cast<size_t>(group_) + 1 + k];
        const Look& look = looks_[k];
        const bool thin = look.material.blended || look.material.strand > 0;  // hair, corneas, films
        node.material = params_.marble && !thin ? marbleOf(look.material) : look.material;
        node.visible = look.visible && !(params_.marble && thin);
        node.material.flush = params_.redness * static_cast<float>(0.5 + 0.5 * wept);
    }
}

Status FlowComponent::draw() {
    if (!texture_) {
        Result<FlowLayer> made = FlowLayer::create(params_.mapSize);
        if (!made) return made.error();
        texture_.emplace(std::move(*made));
    }
    layer_->texels = &texture_->texture();
    if (thesis()) {
        drawThesis();
        return ok();
    }
    maps_->draw(*flow_);
    texture_->update(*maps_);
    return ok();
}

// (22) and (23) on the host, a baseline: reads the drops back, which waits for a GPU. A particle's mass gives its height, by the contact
// angle.
void FlowComponent::drawThesis() {
    std::vector<ThesisParticle> particles;
    double largest = 0;  // m^3
    for (const SkinDrop& d : flow_->drops()) {
        particles.push_back({uvAt(uvs_, d.at), static_cast<float>(d.volume * double{params_.liquid.density})});
        largest = std::max(largest, d.volume);
    }
    const float mass = static_cast<float>(std::max(largest, 1.0e-15) * double{params_.liquid.density});
    picture_ = thesisPicture(particles, params_.mapSize, params_.thesis.disc, mass);
    texture_->update(picture_, capHeight(largest, 0.5 * double{params_.liquid.advancing + params_.liquid.receding}));
}

}  // namespace rivulet
