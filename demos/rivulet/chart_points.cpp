#include "demos/rivulet/chart_points.h"

#include <fmt/format.h>

#include <filesystem>

#include "engine/core/file.h"
#include "engine/core/json_parse.h"
#include "engine/core/json_text.h"
#include "engine/core/number.h"

namespace rivulet {

namespace {

constexpr int kExactDigits = 17;

// The arguments that select the cases: "taylor_green --quick".
std::string chartArguments(const ChartRequest& request) {
    std::string words;
    for (const std::string& name : request.names) words += ' ' + name;
    if (request.quick) words += " --quick";
    return words;
}

// Reads the numbers of a JSON object from its text.
class PointReader {
  public:
    PointReader(const Json::Value& object, std::string_view text) : object_(object), text_(text) {}
    double number(const char* name) {
        const Json::Value& value = object_[name];
        double x = 0;
        const auto begin = static_cast<size_t>(std::max<ptrdiff_t>(value.getOffsetStart(), 0));
        const auto end = static_cast<size_t>(std::max<ptrdiff_t>(value.getOffsetLimit(), 0));
        if (!value.isNumeric() || !parseNumber(text_.substr(begin, end - begin), x)) sound_ = false;
        return x;
    }
    std::string word(const char* name) {
        if (object_[name].isString()) return object_[name].asString();
        sound_ = false;
        return {};
    }
    bool sound() const { return sound_; }

  private:
    const Json::Value& object_;
    std::string_view text_;
    bool sound_ = true;
};

Result<ChartPoint> readPoint(const ChartRequest& request, size_t k, const std::string& file) {
    const Result<std::string> text = readFile(file);
    if (!text)
        return badInput(fmt::format("point {} of {} is missing: {}; run the sweep until all its tasks have ended", k, chartPoints(request),
                                    text.error().message));
    const Result<Json::Value> root = parseJson(*text, file);
    if (!root) return root.error();
    const Error other = badInput(fmt::format("{} is not point {} of the chart{}; give the cases and --quick that --sweep was given", file,
                                             k, chartArguments(request)));
    if (!root->isObject()) return other;
    PointReader reader(*root, *text);
    ChartPoint point;
    if (reader.word("chart") != chartArguments(request) || reader.number("point") != static_cast<double>(k)) return other;
    if (root->isMember("refused")) point.refused = reader.word("refused");
    if (root->isMember("iterations"))
        point.viscosity = {static_cast<int>(reader.number("iterations")), static_cast<int>(reader.number("stepsPerFrame")),
                           reader.number("viscosity"), reader.number("periodError"), reader.number("wallPerSecond")};
    if (root->isMember("case"))
        point.row = {reader.word("case"),
                     reader.word("what"),
                     reader.word("setting"),
                     reader.number("spacing"),
                     static_cast<uint32_t>(reader.number("particles")),
                     reader.number("error"),
                     reader.number("wallPerSecond"),
                     reader.number("sweepsPerSecond"),
                     reader.number("stepsPerSecond"),
                     reader.number("compression"),
                     reader.number("fastest"),
                     false};
    if (!reader.sound() || (point.row && chartSettings().find(point.row->setting) == nullptr)) return other;
    return point;
}

}  // namespace

std::string sweepOfChart(const ChartRequest& request) {
    const size_t points = chartPoints(request);
    return fmt::format(
        "{{\n"
        "  \"doc\": \"The points of the chart speed against accuracy. Then: rivulet chart{0} --points DIR\",\n"
        "  \"command\": \"chart{0} --point {{point}} --json {{task}}/stats.json\",\n"
        "  \"parameters\": {{\"point\": {{\"from\": 0, \"to\": {1}, \"count\": {2}}}}}\n"
        "}}\n",
        chartArguments(request), points - 1, points);
}

std::string chartPointText(const ChartRequest& request, size_t k, const ChartPoint& point) {
    Json::Value object;
    object["chart"] = chartArguments(request);
    object["point"] = static_cast<Json::UInt64>(k);
    if (!point.refused.empty()) object["refused"] = point.refused;
    if (point.viscosity) {
        object["iterations"] = point.viscosity->iterations;
        object["stepsPerFrame"] = point.viscosity->stepsPerFrame;
        object["viscosity"] = point.viscosity->viscosity;
        object["periodError"] = point.viscosity->periodError;
        object["wallPerSecond"] = point.viscosity->wallPerSecond;
    }
    if (point.row) {
        object["case"] = point.row->name;
        object["what"] = point.row->what;
        object["setting"] = point.row->setting;
        object["spacing"] = point.row->spacing;
        object["particles"] = point.row->particles;
        object["error"] = point.row->error;
        object["wallPerSecond"] = point.row->wallPerSecond;
        object["sweepsPerSecond"] = point.row->sweepsPerSecond;
        object["stepsPerSecond"] = point.row->stepsPerSecond;
        object["compression"] = point.row->compression;
        object["fastest"] = point.row->fastest;
    }
    return jsonText(object, kExactDigits);
}

Result<Chart> chartOfSweep(const ChartRequest& request, const std::string& folder) {
    Chart chart;
    for (size_t k = 0; k < chartPoints(request); ++k) {
        const Result<ChartPoint> point =
            readPoint(request, k, (std::filesystem::path(folder) / "tasks" / std::to_string(k) / "stats.json").string());
        if (!point) return point.error();
        addPoint(chart, *point);
    }
    markFront(chart.rows);
    return chart;
}

}  // namespace rivulet
