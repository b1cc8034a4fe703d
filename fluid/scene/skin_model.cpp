#include "fluid/scene/skin_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

Bounds boundsOf(const Model& model, const std::vector<mat4>& world) {
    Bounds all;
    for (const ModelPart& part : model.parts)
        for (const vec3& p : part.mesh.positions) all.add(transformPoint(world[static_cast<size_t>(part.node)], p));
    return all;
}

// Transforms a part into the model's frame: positions, normals, morphs.
void place(ModelPart& part, const mat4& to) {
    part.mesh = transformed(part.mesh, to);
    for (MorphTarget& morph : part.morphs)
        for (vec3& offset : morph.offsets) offset = mat3(to) * offset;
    for (Bone& bone : part.bones) bone.fromMesh = bone.fromMesh * glm::inverse(to);
}

// The part that a person would call the skin: by its name, else the largest.
size_t likelySkin(const Model& model) {
    for (const char* word : {"skin", "face", "head", "body"})
        for (size_t p = 0; p < model.parts.size(); ++p)
            for (std::string name : {model.parts[p].name, model.parts[p].materialName}) {
                std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
                const bool other = name.find("back") != std::string::npos || name.find("hair") != std::string::npos;
                if (name.find(word) != std::string::npos && !other) return p;
            }
    size_t best = 0;
    double most = -1;
    for (size_t p = 0; p < model.parts.size(); ++p) {
        const Mesh& m = model.parts[p].mesh;
        double area = 0;
        for (size_t t = 0; t + 2 < m.indices.size(); t += 3) {
            const dvec3 a(m.positions[m.indices[t]]), b(m.positions[m.indices[t + 1]]), c(m.positions[m.indices[t + 2]]);
            area += glm::length(glm::cross(b - a, c - a));
        }
        if (area > most) {
            most = area;
            best = p;
        }
    }
    return best;
}

Result<size_t> skinOf(const Model& model, const FlowParams& params, SkinPart which) {
    if (model.parts.size() == 1) return size_t{0};
    std::vector<std::string> names;
    for (size_t p = 0; p < model.parts.size(); ++p) {
        const ModelPart& part = model.parts[p];
        if (part.name == params.part || part.materialName == params.part) return p;
        names.push_back(part.materialName.empty() ? part.name : part.materialName);
    }
    if (which == SkinPart::likely) return likelySkin(model);
    return badInput(fmt::format("{} has no part `{}`; there are {}", params.mesh, params.part, fmt::join(names, ", ")));
}

// The file of marks; "" = there is none.
Result<std::string> marksFile(const FlowParams& params, const std::string& sceneFolder, const std::string& meshPath) {
    if (!params.marks.empty()) return findAsset(params.marks, sceneFolder);
    fs::path beside(meshPath);
    beside.replace_extension(".json");
    std::error_code ignored;
    if (!fs::exists(beside, ignored)) beside = beside.parent_path() / "landmarks.json";
    return fs::exists(beside, ignored) ? beside.string() : std::string();
}

// Where a face looks, across `up` and the line between its eyes; if they are not both marked, where it would by its file's axes.
vec3 lookOf(const FaceMarks& marks) {
    vec3 middle[2];
    for (size_t side = 0; side < 2; ++side) {
        const EyeMarks& eye = marks.eyes[side];
        if (!eye.tear && eye.lowerLid.empty()) return marks.forward;
        middle[side] = eye.lowerLid.empty() ? *eye.tear : vec3(0.0F);
        for (const vec3& p : eye.lowerLid) middle[side] += p / static_cast<float>(eye.lowerLid.size());
    }
    const vec3 look = glm::cross(middle[0] - middle[1], marks.up);
    const float length = glm::length(look);
    return length > 0 ? look / length : marks.forward;
}

std::string noticeOf(const FlowParams& params, const SkinMarks& m) {
    const auto anyOf = [&](MarkOf kind) {
        return std::any_of(m.tears.begin(), m.tears.end(), [kind](MarkOf k) { return k == kind; }) ||
               std::any_of(m.lids.begin(), m.lids.end(), [kind](MarkOf k) { return k == kind; });
    };
    const char* much = m.file.empty() ? "has no marks of its eyes" : "lacks marks of an eye";
    if (anyOf(MarkOf::found))
        return fmt::format("{} {}: they were found at its {}; `rivulet flow-check` shows them", params.mesh, much,
                           m.found.by == FoundFace::By::balls ? "eyeballs" : "eye openings");
    if (anyOf(MarkOf::proportions))
        return fmt::format(
            "{} {}, and its skin has no openings: they were estimated by the proportions of a face; `rivulet flow-check --out FILE` "
            "writes them, to be corrected",
            params.mesh, much);
    return anyOf(MarkOf::none) ? fmt::format("{} {}. {}", params.mesh, much, m.found.missing) : std::string();
}

}  // namespace

Result<SkinModel> loadSkinModel(const FlowParams& params, const std::string& sceneFolder, SkinPart which) {
    SkinModel made;
    Result<std::string> path = findAsset(params.mesh, sceneFolder);
    if (!path) return path.error();
    made.path = *path;
    Result<Model> model = importModel(made.path);
    if (!model) return model.error();
    made.model = std::move(*model);
    const std::vector<mat4> world = made.model.worldMatrices();
    const Transform asked{params.position, params.rotation, params.scale};
    made.to = params.fitSize > 0 ? Transform::fitted(boundsOf(made.model, world), params.fitSize, params.position, params.rotation)
                                 : asked.matrix();
    made.to = glm::translate(mat4(1.0F), -params.position) * made.to;
    for (ModelPart& part : made.model.parts) place(part, made.to * world[static_cast<size_t>(part.node)]);
    Result<size_t> skin = skinOf(made.model, params, which);
    if (!skin) return skin.error();
    made.skin = *skin;
    return made;
}

std::string partName(const Model& model, size_t part) {
    const std::string& material = model.parts[part].materialName;
    const auto same = std::count_if(model.parts.begin(), model.parts.end(),
                                    [&](const ModelPart& p) { return p.name == material || p.materialName == material; });
    return !material.empty() && same == 1 ? material : model.parts[part].name;
}

bool needsMarks(const FlowParams& params) {
    return std::any_of(params.sources.begin(), params.sources.end(),
                       [](const FlowSourceParams& s) { return s.kind == "corner" || s.kind == "brim"; });
}

Result<SkinMarks> skinMarks(const FlowParams& params, const std::string& sceneFolder, const SkinModel& skin, Seek seek) {
    SkinMarks m;
    Result<std::string> file = marksFile(params, sceneFolder, skin.path);
    if (!file) return file.error();
    m.file = *file;
    if (!m.file.empty()) {
        Result<FaceMarks> read = readFaceMarks(m.file);
        if (!read) return read.error();
        m.marks = *read;
        // Without `up` the scene's: its `rotation` has set the face upright.
        if (m.marks.knowsUp) m.marks.up = glm::normalize(mat3(skin.to) * m.marks.up);
        m.marks.forward = glm::normalize(mat3(skin.to) * m.marks.forward);
    }
    bool all = true;
    for (size_t side = 0; side < 2; ++side) {
        EyeMarks& eye = m.marks.eyes[side];
        if (eye.tear) eye.tear = transformPoint(skin.to, *eye.tear);
        for (vec3& p : eye.lowerLid) p = transformPoint(skin.to, p);
        m.tears[side] = eye.tear ? MarkOf::file : MarkOf::none;
        m.lids[side] = eye.lowerLid.size() >= 2 ? MarkOf::file : MarkOf::none;
        all = all && m.tears[side] == MarkOf::file && m.lids[side] == MarkOf::file;
    }
    if (!m.file.empty() && !m.marks.knowsForward) m.marks.forward = lookOf(m.marks);
    if (seek == Seek::never || (seek == Seek::ifMarksAreMissing && all)) return m;
    m.found = findFace(skin.model.parts, skin.skin);
    if (m.found.found()) {
        const MarkOf how = m.found.by == FoundFace::By::proportions ? MarkOf::proportions : MarkOf::found;
        if (m.file.empty()) {
            m.marks.up = m.found.up;
            m.marks.forward = m.found.forward;
        }
        for (size_t side = 0; side < 2; ++side) {
            EyeMarks& eye = m.marks.eyes[side];
            if (m.tears[side] == MarkOf::none) {
                eye.tear = m.found.eyes[side].tear;
                m.tears[side] = how;
            }
            if (m.lids[side] == MarkOf::none) {
                eye.lowerLid = m.found.eyes[side].lowerLid;
                m.lids[side] = how;
            }
        }
    }
    m.notice = noticeOf(params, m);
    return m;
}

vec3 uprightRotation(const FlowParams& params, const vec3& up, const vec3& forward) {
    // Rows: the face's left, up and forward become x, y and z. Taken apart into turns about x, then y, then z.
    const mat3 upright = glm::transpose(mat3(glm::cross(up, forward), up, forward));
    const mat3 m = upright * mat3(Transform{vec3(0.0F), params.rotation, 1.0F}.matrix());
    const float sinY = std::clamp(-m[0][2], -1.0F, 1.0F);
    vec3 turn(std::atan2(m[1][2], m[2][2]), std::asin(sinY), std::atan2(m[0][1], m[0][0]));
    if (std::abs(sinY) > 0.9999F) turn = vec3(std::atan2(-m[2][1], m[1][1]), turn.y, 0);
    const vec3 degrees = glm::round(turn / kDegree * 10.0F) / 10.0F;
    return degrees + 0.0F;  // no -0
}

}  // namespace rivulet
