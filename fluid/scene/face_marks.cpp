#include "fluid/scene/face_marks.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>

#include "engine/core/file.h"
#include "engine/core/json_parse.h"

namespace rivulet {

namespace {

constexpr float kCentimetre = 0.01F;

// Reads numbers by their text: the tree's own read 0.
struct Reader {
    const std::string& file;
    const std::string& text;

    Error wrong(const Json::Value& at, const char* what) const {
        return badInput(fmt::format("{}{}: {}", file, placeOf(text, static_cast<size_t>(at.getOffsetStart())), what));
    }
    Result<std::vector<float>> numbers(const Json::Value& list, size_t count) const {
        if (!list.isArray() || list.size() != count) return wrong(list, count == 3 ? "three numbers are needed" : "two numbers are needed");
        std::vector<float> all;
        for (const Json::Value& v : list) {
            const char* from = text.data() + v.getOffsetStart();
            float value = 0;
            const auto [end, error] = std::from_chars(from, text.data() + v.getOffsetLimit(), value);
            if (!v.isNumeric() || error != std::errc{} || end == from || !std::isfinite(value)) return wrong(v, "a number is needed");
            all.push_back(value);
        }
        return all;
    }
    Result<vec3> point(const Json::Value& list, float scale) const {
        const Result<std::vector<float>> n = numbers(list, 3);
        if (!n) return n.error();
        return scale * vec3((*n)[0], (*n)[1], (*n)[2]);
    }
};

Status readOwn(const Reader& r, const Json::Value& eyes, FaceMarks& marks) {
    for (const auto& [side, at] : {std::pair("left", size_t{0}), std::pair("right", size_t{1})}) {
        const Json::Value& eye = eyes[side];
        if (!eye.isObject()) return r.wrong(eyes, "`left` and `right` are needed");
        EyeMarks& m = marks.eyes[at];
        if (eye["tear"].isObject()) {
            Result<vec3> tear = r.point(eye["tear"]["position"], 1);
            if (!tear) return tear.error();
            m.tear = *tear;
            if (eye["tear"].isMember("uv")) {
                const Result<std::vector<float>> uv = r.numbers(eye["tear"]["uv"], 2);
                if (!uv) return uv.error();
                m.tearUv = vec2((*uv)[0], (*uv)[1]);
            }
        }
        for (const Json::Value& p : eye["lower_lid_margin"]) {
            Result<vec3> point = r.point(p, 1);
            if (!point) return point.error();
            m.lowerLid.push_back(*point);
        }
    }
    return ok();
}

Status readAxis(const Reader& r, const Json::Value& root, const char* key, vec3& axis, bool& known) {
    if (!root.isMember(key)) return ok();
    Result<vec3> given = r.point(root[key], 1);
    if (!given) return given.error();
    const float length = glm::length(*given);
    if (!(length > 0) || !std::isfinite(length)) return r.wrong(root[key], "a direction with a length is needed");
    axis = *given / length;
    known = true;
    return ok();
}

// Six digits: a tenth of a micrometre on a head in m.
std::string numbersOf(const vec3& p) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", p.x, p.y, p.z); }

Status readLandmarks(const Reader& r, const Json::Value& points, FaceMarks& marks) {
    for (const auto& [side, at] : {std::pair("left", size_t{0}), std::pair("right", size_t{1})}) {
        for (const char* where : {"inner_corner", "lower_lid_inner_third", "lower_lid_outer_third", "outer_corner"}) {
            const Json::Value& mark = points[fmt::format("{}_{}", side, where)];
            if (!mark.isObject()) return r.wrong(points, "the corners of the eyes and the thirds of the lower lids are needed");
            Result<vec3> point = r.point(mark["pos_cm"], kCentimetre);
            if (!point) return point.error();
            marks.eyes[at].lowerLid.push_back(*point);
        }
        // A tear begins on the skin below the lid's edge.
        marks.eyes[at].tear = marks.eyes[at].lowerLid.front() + vec3(0.0F, -0.0025F, 0.001F);
    }
    return ok();
}

}  // namespace

Result<FaceMarks> readFaceMarks(const std::string& path) {
    const Result<std::string> text = readFile(path, size_t{1} << 26U);
    if (!text) return text.error();
    const Result<Json::Value> tree = parseJson(*text, path);
    if (!tree) return tree.error();
    const Reader reader{path, *text};
    FaceMarks marks;
    const Json::Value& root = *tree;
    if (root.isObject() && root["eyes"].isObject()) {
        if (Status read = readOwn(reader, root["eyes"], marks); !read) return read.error();
        if (Status read = readAxis(reader, root, "up", marks.up, marks.knowsUp); !read) return read.error();
        if (Status read = readAxis(reader, root, "forward", marks.forward, marks.knowsForward); !read) return read.error();
    } else if (root.isObject() && root["tear_points"].isObject()) {
        if (Status read = readLandmarks(reader, root["tear_points"], marks); !read) return read.error();
        marks.knowsUp = marks.knowsForward = true;
    } else
        return badInput(fmt::format("{}: has neither `eyes` nor `tear_points`: it marks no face", path));
    return marks;
}

std::string faceMarksText(const FaceMarks& marks) {
    std::string text =
        fmt::format("{{\n  \"up\": {},\n  \"forward\": {},\n  \"eyes\": {{\n", numbersOf(marks.up), numbersOf(marks.forward));
    for (size_t side = 0; side < 2; ++side) {
        const EyeMarks& eye = marks.eyes[side];
        std::vector<std::string> keys;
        if (eye.tear) keys.push_back(fmt::format("\"tear\": {{\"position\": {}}}", numbersOf(*eye.tear)));
        if (!eye.lowerLid.empty()) {
            std::string lid;
            for (const vec3& p : eye.lowerLid) lid += fmt::format("{}\n        {}", lid.empty() ? "" : ",", numbersOf(p));
            keys.push_back(fmt::format("\"lower_lid_margin\": [{}\n      ]", lid));
        }
        text += fmt::format("    \"{}\": {{", side == 0 ? "left" : "right");
        for (size_t k = 0; k < keys.size(); ++k) text += fmt::format("{}\n      {}", k > 0 ? "," : "", keys[k]);
        text += fmt::format("\n    }}{}\n", side == 0 ? "," : "");
    }
    return text + "  }\n}\n";
}

}  // namespace rivulet
