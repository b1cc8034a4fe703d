#include "fluid/scene/flow_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/flow/flow_maps.h"

namespace rivulet {

namespace {

constexpr float kEyes = 0.063F, kHead = 0.24F;  // m, of an adult: between the eyes, and high
constexpr float kUpright = 0.7F;                // least cosine between a face's up and +Y

struct Unit {
    const char* name;
    float metres;
};
constexpr Unit kUnits[] = {{"metres", 1}, {"centimetres", 0.01F}, {"millimetres", 0.001F}, {"inches", 0.0254F}};

// The unit in which the distance between the eyes is a person's, else the one in which the height is a head's.
const Unit* unitOf(float height, float eyes) {
    for (const Unit& u : kUnits)
        if (eyes > 0 && eyes * u.metres > 0.048F && eyes * u.metres < 0.082F) return &u;
    if (eyes > 0) return nullptr;
    for (const Unit& u : kUnits)
        if (height * u.metres > 0.12F && height * u.metres < 0.5F) return &u;
    return nullptr;
}

std::string axisOf(const vec3& v) {
    constexpr float kAlong = 0.94F;
    const char* names[] = {"X", "Y", "Z"};
    for (int k = 0; k < 3; ++k)
        if (std::abs(v[k]) > kAlong) return fmt::format("{}{}", v[k] > 0 ? '+' : '-', names[k]);
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x, v.y, v.z);
}

std::string listOf(const std::vector<std::string>& names, size_t most) {
    if (names.size() <= most) return fmt::format("{}", fmt::join(names, ", "));
    return fmt::format("{} and {} more", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(most), ", "),
                       names.size() - most);
}

std::string counted(size_t n, const char* one, const char* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

std::string lengthText(double metres) {
    if (metres < 0.01) return fmt::format("{:.2g} mm", 1000 * metres);
    return metres < 1 ? fmt::format("{:.1f} cm", 100 * metres) : fmt::format("{:.2f} m", metres);
}

std::string pointText(const vec3& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z); }

class Checker {
  public:
    Checker(FlowCheck& check, const FlowParams& params, const SkinModel& skin) : c_(check), params_(params), skin_(skin) {}

    void unitAndAxes() {
        const FoundFace& face = c_.marks.found;
        const bool known = face.found();
        const vec3 up = known ? face.up : c_.marks.marks.up;
        float low = 1.0e30F, high = -1.0e30F;
        Bounds box;
        for (const ModelPart& part : skin_.model.parts)
            for (const vec3& p : part.mesh.positions) {
                low = std::min(low, glm::dot(p, up));
                high = std::max(high, glm::dot(p, up));
                box.add(p);
            }
        const vec3 size = box.size();
        c_.height = known ? high - low : std::max({size.x, size.y, size.z});
        c_.eyeDistance = known ? face.eyeDistance() : 0;
        std::string measured = fmt::format("The mesh is {:.3g} {}", c_.height, known ? "high" : "long at most");
        if (known) measured += fmt::format(", and its eyes are {:.3g} apart", c_.eyeDistance);
        const Unit* unit = unitOf(c_.height, c_.eyeDistance);
        c_.scale = unit != nullptr ? unit->metres : 0;
        if (unit == kUnits) {
            row("unit", fmt::format("{}: metres, as a scene needs.", measured));
        } else if (unit != nullptr) {
            row("unit",
                fmt::format("{}: that looks like {}. A scene is in metres, and a head is 0.2 to 0.35 m high.", measured, unit->name));
            need(fmt::format("Set \"scale\": {:.6g} in the scene's flow (here: --scale {:.6g}).", params_.scale * unit->metres,
                             params_.scale * unit->metres));
        } else {
            c_.scale = known ? kEyes / c_.eyeDistance : kHead / c_.height;
            row("unit",
                fmt::format("{}: that is no head in metres, centimetres, millimetres or inches. A head is 0.2 to 0.35 m high.", measured));
            need(fmt::format("Set \"scale\": {:.3g} in the scene's flow (here: --scale {:.3g}), if the mesh is a head of common size.",
                             params_.scale * c_.scale, params_.scale * c_.scale));
        }
        c_.wanted.scale = params_.scale * (unit == kUnits ? 1.0F : c_.scale);
        if (params_.fitSize > 0) c_.wanted.scale = params_.scale;
        if (!known) {
            row("axes", "Not known, because no face was found. A scene needs +Y up; for its camera, faces look along +Z.");
            return;
        }
        const vec3 turn = uprightRotation(params_, face.up, face.forward);
        row("axes",
            fmt::format(
                "Up is {}, and the face looks along {}.{}", axisOf(face.up), axisOf(face.forward),
                face.up.y > kUpright && face.forward.z < kUpright ? " Scenes have the camera at +Z: turn the mesh or the camera." : ""));
        if (face.up.y > kUpright) return;
        const std::string text = fmt::format("{:g}, {:g}, {:g}", turn.x, turn.y, turn.z);
        need(fmt::format("Set \"rotation\": [{}] in the scene's flow (here: --rotation={}), so that tears run down the face.", text,
                         fmt::format("{:g},{:g},{:g}", turn.x, turn.y, turn.z)));
        c_.wanted.rotation = turn;
        c_.turn = glm::transpose(mat3(glm::cross(face.up, face.forward), face.up, face.forward));
    }

    void parts(bool chosen) {
        std::vector<std::string> names;
        for (const ModelPart& part : skin_.model.parts) names.push_back(nameOf(part));
        if (names.size() == 1) {
            row("parts", "One, which the liquid runs over.");
            return;
        }
        row("parts", fmt::format("{}: {}. The liquid runs over `{}`; the others are drawn.", names.size(), listOf(names, 12), c_.part));
        if (chosen)
            need(fmt::format("Set \"part\": \"{}\" in the scene's flow (here: --part {}), or the name of another part.", c_.part, c_.part));
    }

    Status triangles() {
        const Mesh& mesh = skin_.model.parts[skin_.skin].mesh;
        Result<FlowMesh> flow = makeFlowMesh(mesh.view());
        if (!flow) return badInput(fmt::format("{}: {}", params_.mesh, flow.error().message));
        c_.triangles = flow->triangleCount();
        c_.openEdges = flow->report.openEdges;
        const std::string faults = flow->report.sentence();
        row("triangles", fmt::format("{} in {}. {}", flow->report.triangles, counted(flow->report.components, "piece", "pieces"),
                                     faults.empty() ? "No faults." : faults));
        return uvs(*flow, mesh.view());
    }

    void morphs() {
        for (const MorphTarget& m : skin_.model.parts[skin_.skin].morphs) c_.morphs.push_back(m.name);
        row("morphs", c_.morphs.empty()
                          ? "None: the face cannot move, and tears run all the same."
                          : fmt::format("{}: {}. A scene moves them by its \"expression\".", c_.morphs.size(), listOf(c_.morphs, 12)));
    }

    void marks() {
        row("tears", saidOf("point where a tear begins", "points where tears begin", c_.marks.tears));
        row("lower lids", saidOf("lid's edge", "lids' edges", c_.marks.lids));
        const FoundFace& f = c_.marks.found;
        if (f.by == FoundFace::By::balls)
            row("eyes", fmt::format("Two eyeballs with a radius of {:.3g}, in {}.", f.eyes[0].radius, fmt::join(f.balls, " and ")));
        else if (f.by == FoundFace::By::holes)
            row("eyes", "Two holes of the skin, without eyeballs behind them: one will look into the head.");
        else if (f.by == FoundFace::By::proportions)
            row("eyes", "Neither eyeballs nor openings: the eyes are a part of the skin.");
        else
            row("eyes", f.missing);
        row("nose", f.nose ? fmt::format("Its tip is at {}.", pointText(*f.nose)) : "Not found; no flow needs it.");
        row("jaw", f.chin ? fmt::format("The chin's lowest point is at {}.", pointText(*f.chin)) : "Not found; no flow needs it.");
        if (has(MarkOf::none))
            need(
                "Give the marks that are missing in a JSON file beside the mesh, with the mesh's name, or named by \"marks\" in the "
                "scene's flow "
                "(here: --marks FILE). --out FILE writes a form to fill in.");
        else if (has(MarkOf::proportions))
            need(
                "Look at the marks that were estimated: --out FILE writes them. Correct the numbers where they are not at the lids, and "
                "name the "
                "file by \"marks\" in the scene's flow (here: --marks FILE).");
        offSkin();
    }

  private:
    void row(const char* label, std::string sentence) { c_.rows.push_back({label, std::move(sentence)}); }
    void need(std::string remedy) { c_.needed.push_back(std::move(remedy)); }
    bool has(MarkOf kind) const {
        const auto is = [kind](MarkOf k) { return k == kind; };
        return std::any_of(c_.marks.tears.begin(), c_.marks.tears.end(), is) || std::any_of(c_.marks.lids.begin(), c_.marks.lids.end(), is);
    }

    Status uvs(const FlowMesh& flow, const MeshView& view) {
        Result<SkinUvs> uvs = skinUvs(flow, view, std::clamp(params_.mapSize, 256, 2048));
        if (!uvs) return badInput(fmt::format("{}: {}", params_.mesh, uvs.error().message));
        const UvReport& r = uvs->given;
        c_.uvs = r;
        c_.mapSize = params_.mapSize;
        std::string text;
        const auto say = [&text](const std::string& one) { text += text.empty() ? one : " " + one; };
        if (r.missing) {
            say("None.");
        } else {
            if (r.overlap > 0.001)
                say(fmt::format("Charts overlap: {:.1f} % of the texels that triangles claim belong to another triangle already.",
                                100 * r.overlap));
            if (r.notNumbers > 0) say(fmt::format("{} with UVs that are not finite.", counted(r.notNumbers, "triangle", "triangles")));
            if (r.tooWide > 0) say(fmt::format("{} wider than the map.", counted(r.tooWide, "triangle", "triangles")));
            if (r.noArea > 0) say(fmt::format("{} without area in UV.", counted(r.noArea, "triangle", "triangles")));
            if (r.mirrored > 0) say(fmt::format("{} mirrored, which is no fault.", counted(r.mirrored, "triangle is", "triangles are")));
            if (r.beyond > 0)
                say(fmt::format("{} outside the tile 0 to 1, and wrapped round.", counted(r.beyond, "triangle is", "triangles are")));
            if (r.stretched > 0.005)
                say(fmt::format("On {:.1f} % of the skin the texels are more than 4 times as long as wide.", 100 * r.stretched));
        }
        if (uvs->unwrapped) {
            const UvReport own = checkUvs(flow, uvs->uvs, std::clamp(params_.mapSize, 256, 2048));
            c_.charts = uvs->charts;
            c_.texel = own.texel;
            c_.uvs.widest = own.widest;
            say(fmt::format("The program's own UVs are used instead, with {}.", counted(uvs->charts, "chart", "charts")));
        } else {
            c_.texel = r.texel;
            say(text.empty() ? "No faults. The mesh's own are used." : "The mesh's own are used.");
        }
        // The report is of the size that UVs are tried on.
        const double tried = std::clamp(params_.mapSize, 256, 2048), finer = tried / params_.mapSize;
        c_.texel *= finer;
        c_.uvs.texel = c_.texel;
        c_.uvs.widest *= finer;
        row("UVs", text);
        // In metres, once the mesh is scaled as the check proposes.
        const double metres = params_.fitSize > 0 || c_.scale == 1 ? 1.0 : double{c_.scale};
        const double wide = c_.texel * metres;
        row("map",
            fmt::format("At {0} x {0} texels one texel is {1} wide on the skin, and at most {2} on 95 % of it.{3}", params_.mapSize,
                        lengthText(wide), lengthText(c_.uvs.widest * metres),
                        wide > 0.8e-3 && params_.mapSize < 4096
                            ? fmt::format(" A tear is 2 to 4 mm wide: \"mapSize\": {} would draw it more finely.", 2 * params_.mapSize)
                            : ""));
        return ok();
    }

    std::string saidOf(const char* one, const char* many, const std::array<MarkOf, 2>& of) const {
        const auto how = [this](MarkOf k) -> std::string {
            switch (k) {
                case MarkOf::file:
                    return fmt::format("given by {}", c_.marks.file);
                case MarkOf::found:
                    return "found by the program";
                case MarkOf::proportions:
                    return "estimated from the nose by the proportions of a face";
                case MarkOf::none:
                    break;
            }
            return "not known";
        };
        if (of[0] == of[1]) return fmt::format("Both {} are {}.", many, how(of[0]));
        return fmt::format("The left {} is {}, the right one is {}.", one, how(of[0]), how(of[1]));
    }

    // Marks of another unit or frame lie far off.
    void offSkin() {
        if (c_.marks.file.empty()) return;
        const Result<FlowMesh> flow = makeFlowMesh(skin_.model.parts[skin_.skin].mesh.view());
        if (!flow) return;
        float most = 0;
        for (size_t side = 0; side < 2; ++side) {
            const EyeMarks& eye = c_.marks.marks.eyes[side];
            const auto see = [&](const vec3& p) { most = std::max(most, glm::distance(p, positionOf(*flow, nearestPoint(*flow, p)))); };
            if (c_.marks.tears[side] == MarkOf::file) see(*eye.tear);
            if (c_.marks.lids[side] == MarkOf::file)
                for (const size_t k : {size_t{0}, eye.lowerLid.size() / 2, eye.lowerLid.size() - 1}) see(eye.lowerLid[k]);
        }
        if (most < 0.05F * c_.height) return;
        need(fmt::format(
            "Correct the marks in {}: one lies {:.3g} off the skin, on a mesh of {:.3g}. They must be in the unit and frame of the mesh "
            "file.",
            c_.marks.file, most, c_.height));
    }

    FlowCheck& c_;
    const FlowParams& params_;
    const SkinModel& skin_;
};

// The marks as they stand in a file beside the mesh. Where nothing is known: zeros, on which a check finds fault.
std::string formOf(const FlowCheck& check, const SkinModel& skin) {
    FaceMarks marks = check.marks.marks;
    const mat4 back = glm::inverse(skin.to);
    const mat3 turn(back);
    marks.up = glm::normalize(turn * marks.up);
    marks.forward = glm::normalize(turn * marks.forward);
    for (EyeMarks& eye : marks.eyes) {
        eye.tearUv.reset();
        if (eye.tear) eye.tear = transformPoint(back, *eye.tear);
        for (vec3& p : eye.lowerLid) p = transformPoint(back, p);
        if (!eye.tear) eye.tear = vec3(0.0F);
        if (eye.lowerLid.size() < 2) eye.lowerLid.assign(3, vec3(0.0F));
    }
    return faceMarksText(marks);
}

}  // namespace

Result<FlowCheck> checkFlow(const FlowParams& params, const std::string& sceneFolder, bool partGiven) {
    FlowCheck check;
    FlowParams asked = params;
    Result<SkinModel> skin = loadSkinModel(asked, sceneFolder, partGiven ? SkinPart::named : SkinPart::likely);
    if (!skin) return skin.error();
    check.part = partName(skin->model, skin->skin);
    if (skin->model.parts.size() > 1) asked.part = check.part;
    check.wanted = asked;
    Result<SkinMarks> marks = skinMarks(asked, sceneFolder, *skin, Seek::always);
    if (!marks) return marks.error();
    check.marks = std::move(*marks);
    Checker checker(check, asked, *skin);
    checker.unitAndAxes();
    checker.parts(asked.part != params.part);
    if (Status done = checker.triangles(); !done) return done.error();
    checker.morphs();
    checker.marks();
    check.marksText = formOf(check, *skin);
    return check;
}

SceneFile cryingScene(const FlowCheck& check) {
    const FoundFace& face = check.marks.found;
    SceneFile s;
    s.name = "tears";
    s.doc = fmt::format("Tears on {}, as `rivulet flow-check` proposes.", check.wanted.mesh);
    s.duration = 20;
    s.fluid.blocks.clear();
    FlowParams flow = check.wanted;
    // The eyes come to the origin.
    const float grow = flow.fitSize > 0 ? 1.0F : check.scale;
    const mat3 turn(check.turn);
    const vec3 between = 0.25F * (face.eyes[0].inner + face.eyes[0].outer + face.eyes[1].inner + face.eyes[1].outer);
    if (flow.fitSize == 0) flow.position = -(turn * (grow * between)) + 0.0F;  // no -0
    const vec3 eyes = flow.fitSize == 0 ? vec3(0.0F) : flow.position + turn * between;
    const float size = grow * check.height, apart = grow * check.eyeDistance;
    s.fluid.box.min = eyes - vec3(1.5F * size);
    s.fluid.box.max = eyes + vec3(1.5F * size);
    flow.liquid.brimStarts = 7.8F;  // ul, what a lid holds before it overflows
    flow.look.darkening = 0.3F;
    flow.look.roughness = 0.05F;
    flow.sources.clear();
    FlowSourceParams& brim = flow.sources.emplace_back();
    brim.kind = "brim";
    brim.rate = 150;
    brim.drop = 0.02F;
    brim.swell = 0.6F;
    brim.period = 5;
    s.flow.push_back(flow);
    vec3 towards = turn * face.forward;
    towards = glm::normalize(vec3(towards.x, 0.0F, towards.z) + vec3(0.0F, 0.08F, 0.0F));
    s.camera.target = eyes - vec3(0.0F, 0.45F * apart, 0.0F);
    s.camera.position = s.camera.target + 7.5F * apart * towards;
    s.camera.fieldOfView = 26;
    s.light.direction = towards + vec3(0.5F, 0.55F, 0.0F);
    s.background.showFloor = s.background.showBox = false;
    return s;
}

}  // namespace rivulet
