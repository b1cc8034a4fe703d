#include <fmt/format.h>
#include <json/json.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/outputs.h"
#include "engine/core/file.h"
#include "engine/core/input_file.h"
#include "engine/core/json_text.h"
#include "engine/core/message_line.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/scene/flow_check.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

struct CheckRequest {
    std::string mesh, part, marks, rotation, out, scene, json;
    std::optional<double> scale;
    std::optional<int> mapSize;
};

Status checkRequest(const CheckRequest& request) {
    const NamedFile outputs[] = {{"--out", request.out}, {"--scene", request.scene}, {"--json", request.json}};
    const NamedFile inputs[] = {{"the mesh", request.mesh}, {"--marks", request.marks}};
    if (Status apart = checkOutputs(outputs, inputs); !apart) return apart;
    for (const NamedFile& file : outputs) {
        if (file.path.empty()) continue;
        std::error_code none;
        if (fs::is_directory(file.path, none)) return badInput(fmt::format("the output '{}' is a folder; choose a file name", file.path));
        if (Status writable = checkWritable(file.path); !writable) return writable;
    }
    return ok();
}

Result<FlowParams> paramsOf(const CheckRequest& request) {
    FlowParams params;
    params.mesh = request.mesh;
    params.marks = request.marks;
    if (!request.part.empty()) params.part = request.part;
    if (request.scale) params.scale = static_cast<float>(*request.scale);
    if (request.mapSize) params.mapSize = *request.mapSize;
    if ((params.mapSize & (params.mapSize - 1)) != 0)
        return badInput(fmt::format("--map-size must be a power of two, for example 1024, but is {}", params.mapSize));
    if (!request.rotation.empty()) {
        int end = 0;
        vec3& r = params.rotation;
        if (std::sscanf(request.rotation.c_str(), "%f,%f,%f%n", &r.x, &r.y, &r.z, &end) != 3 ||
            static_cast<size_t>(end) != request.rotation.size() || !isFinite(r) ||
            std::max({std::abs(r.x), std::abs(r.y), std::abs(r.z)}) > 360)
            return badInput(
                fmt::format("--rotation must be three angles in degrees, -360 to 360, for example -90,0,0, but is '{}'", request.rotation));
    }
    return params;
}

const char* wordOf(MarkOf of) {
    switch (of) {
        case MarkOf::file:
            return "file";
        case MarkOf::found:
            return "found";
        case MarkOf::proportions:
            return "proportions";
        case MarkOf::none:
            break;
    }
    return "none";
}

Json::Value numbersOf(const vec3& p) {
    Json::Value list(Json::arrayValue);
    for (int k = 0; k < 3; ++k) list.append(p[k]);
    return list;
}

Json::Value jsonOf(const CheckRequest& request, const FlowCheck& check) {
    Json::Value v(Json::objectValue);
    v["mesh"] = request.mesh;
    v["ready"] = check.ready();
    v["needed"] = v["says"] = Json::Value(Json::arrayValue);
    for (const std::string& one : check.needed) v["needed"].append(one);
    for (const FlowCheckRow& row : check.rows) v["says"].append(row.label + ": " + row.sentence);
    v["height"] = check.height;
    v["eyeDistance"] = check.eyeDistance;
    v["scaleBy"] = check.scale;
    v["part"] = check.part;
    v["triangles"] = Json::UInt64(check.triangles);
    v["openEdges"] = Json::UInt64(check.openEdges);
    v["uvs"]["missing"] = check.uvs.missing;
    v["uvs"]["overlap"] = check.uvs.overlap;
    v["uvs"]["mirrored"] = Json::UInt64(check.uvs.mirrored);
    v["uvs"]["beyond"] = Json::UInt64(check.uvs.beyond);
    v["uvs"]["stretched"] = check.uvs.stretched;
    v["uvs"]["newCharts"] = check.charts;
    v["mapSize"] = check.mapSize;
    v["texel"] = check.texel;
    v["morphs"] = Json::Value(Json::arrayValue);
    for (const std::string& name : check.morphs) v["morphs"].append(name);
    const FoundFace& face = check.marks.found;
    if (face.found()) {
        v["up"] = numbersOf(face.up);
        v["forward"] = numbersOf(face.forward);
    }
    if (face.nose) v["nose"] = numbersOf(*face.nose);
    if (face.chin) v["chin"] = numbersOf(*face.chin);
    v["marksFile"] = check.marks.file;
    for (const auto& [side, at] : {std::pair("left", size_t{0}), std::pair("right", size_t{1})}) {
        Json::Value& eye = v["eyes"][side];
        const EyeMarks& marks = check.marks.marks.eyes[at];
        eye["tearFrom"] = wordOf(check.marks.tears[at]);
        eye["lidFrom"] = wordOf(check.marks.lids[at]);
        if (marks.tear) eye["tear"] = numbersOf(*marks.tear);
        eye["lowerLid"] = Json::Value(Json::arrayValue);
        for (const vec3& p : marks.lowerLid) eye["lowerLid"].append(numbersOf(p));
    }
    return v;
}

// The report: a sentence or more a row, then what is needed.
void print(const CheckRequest& request, const FlowCheck& check) {
    constexpr int kColumn = 12;  // characters
    fmt::print("{}\n", printable(request.mesh));
    for (const FlowCheckRow& row : check.rows) fmt::print("{:<{}}{}\n", row.label, kColumn, printable(row.sentence));
    if (check.ready()) {
        fmt::print("\nReady: a scene's flow can use this mesh.\n");
        return;
    }
    fmt::print("\nNeeded:\n");
    for (size_t k = 0; k < check.needed.size(); ++k) fmt::print("{}. {}\n", k + 1, printable(check.needed[k]));
}

// As a scene in `folder` names a file: a file of that folder by its name, so that both can be moved together.
std::string nameFrom(const fs::path& folder, const std::string& file) {
    const fs::path whole = fs::absolute(file).lexically_normal(),
                   beside = whole.lexically_relative(fs::absolute(folder.empty() ? "." : folder).lexically_normal());
    return beside.empty() || *beside.begin() == ".." ? whole.string() : beside.string();
}

Status writeOutputs(const CheckRequest& request, FlowCheck& check) {
    if (!request.out.empty())
        if (Status written = writeFileAtomic(request.out, check.marksText); !written) return written;
    if (!request.json.empty())
        if (Status written = writeFileAtomic(request.json, jsonText(jsonOf(request, check), 7)); !written) return written;
    if (request.scene.empty()) return ok();
    if (!check.marks.found.found())
        return badInput(fmt::format("{} was not written: no face was found in {}, so its camera and its eyes are not known", request.scene,
                                    request.mesh));
    const fs::path folder = fs::path(request.scene).parent_path();
    const std::string& marks = request.out.empty() ? request.marks : request.out;
    if (!marks.empty()) check.wanted.marks = nameFrom(folder, marks);
    check.wanted.mesh = nameFrom(folder, request.mesh);
    SceneFile scene = cryingScene(check);
    scene.folder = folder.string();
    return saveScene(scene, request.scene);
}

}  // namespace

int flowCheckVerb(const Arguments& arguments) {
    ArgumentReader reader("flow-check",
                          "Says in sentences what a head's mesh needs to carry tears, finds its eyes and lids, and writes them to a file. "
                          "Exit code: 0 ready, 1 something is needed, 2 invalid input.");
    CheckRequest request;
    reader.positional("MESH", "a mesh file: OBJ, glTF, FBX or another format of assimp", request.mesh, true);
    reader.option("--part", "NAME", "part or material that the tears run over; default: skin, or the likeliest", request.part);
    reader.option("--marks", "FILE.json", "marks of the eyes; default: the file beside the mesh, else they are found", request.marks);
    reader.option("--scale", "X", "scale factor of the mesh, as flow.scale of a scene; default: 1", request.scale, 1e-6, 1e6);
    reader.option("--rotation", "X,Y,Z", "rotation about x, then y, then z, in degrees, as flow.rotation of a scene", request.rotation);
    reader.option("--map-size", "N", "texels along a side of the map, a power of two, as flow.mapSize; default: 1024", request.mapSize,
                  FlowMaps::kLeastSize, FlowMaps::kMostSize);
    reader.option("--out", "FILE.json", "also write the marks, in the unit and frame of the mesh file", request.out);
    reader.option("--scene", "FILE.json", "also write a scene in which this mesh cries", request.scene);
    reader.option("--json", "FILE.json", "also write all figures as JSON", request.json);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (Status sense = checkRequest(request); !sense) return report(sense.error());
    const Result<FlowParams> params = paramsOf(request);
    if (!params) return report(params.error());
    Result<FlowCheck> check = checkFlow(*params, "", !request.part.empty());
    if (!check) return report(check.error());
    print(request, *check);
    if (Status written = writeOutputs(request, *check); !written) {
        flushOutput();
        return report(written.error());
    }
    flushOutput();
    return check->ready() ? kDone : kFailed;
}

}  // namespace rivulet
