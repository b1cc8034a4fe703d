// Writes the stability envelope into docs/: a table, a plot, and a page that explains them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "engine/core/file.h"
#include "fluid/validate/envelope.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

namespace {

std::string inCsv(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '"') safe += '"';
        safe += c == '\n' ? ' ' : c;
    }
    return '"' + safe + '"';
}

std::string csvOf(std::span<const EnvelopeFinding> findings, const std::string& machine) {
    std::string text = fmt::format(
        "# Where methods fail: predicted and measured with fluid.limits off; the same with the limits on. {}\n# An empty measured: no "
        "failure up to reached.\n"
        "row,method,swept,unit,predicted,measured,reached,ratio,criterion,asked,finite,bounded,nothingLost,steps,notice\n",
        machine);
    for (const EnvelopeFinding& f : findings)
        text += fmt::format("{},{},{},{},{:.5g},{},{:.5g},{:.4g},{},{:.5g},{},{},{},{},{}\n", f.row, f.method, inCsv(f.what), f.unit,
                            f.predicted, f.measured ? fmt::format("{:.5g}", *f.measured) : "", f.reached, f.ratio(), inCsv(f.criterion),
                            f.limited.asked, f.limited.finite, f.limited.bounded, f.limited.nothingLost, f.limited.steps,
                            inCsv(f.limited.notice));
    return text;
}

// One tick per row, one colour per method: the measured over the predicted limit.
Plot plotOf(std::span<const EnvelopeFinding> findings) {
    Plot plot{.title = "Where methods fail, limits off", .x = "", .y = "measured over predicted", .curves = {}, .logY = true};
    Curve none{"no failure up to here", false, {}};
    std::map<std::string, Curve> methods;
    for (const EnvelopeFinding& f : findings) {
        if (plot.ticks.empty() || plot.ticks.back() != f.row) plot.ticks.push_back(f.row);
        const auto at = static_cast<double>(plot.ticks.size() - 1);
        if (!f.measured) {
            none.points.emplace_back(at, f.reached / f.predicted);
            continue;
        }
        Curve& c = methods[f.method];
        c.name = f.method;
        c.line = false;
        c.points.emplace_back(at, f.ratio());
    }
    for (const auto& [name, curve] : methods) plot.curves.push_back(curve);
    if (!none.points.empty()) plot.curves.push_back(none);
    if (!plot.ticks.empty()) plot.curves.push_back({"as predicted", true, {{-0.5, 1}, {static_cast<double>(plot.ticks.size()) - 0.5, 1}}});
    return plot;
}

std::string withUnit(double value, const std::string& unit) {
    if (unit == "s") return fmt::format("{:.3g} ms", 1000 * value);
    return unit.empty() ? fmt::format("{:.3g}", value) : fmt::format("{:.3g} {}", value, unit);
}

// The measured limit and its ratio to the predicted one, in words.
std::string verdictOf(const EnvelopeFinding& f) {
    if (!f.measured) return fmt::format("never, up to {}", withUnit(f.reached, f.unit));
    return fmt::format("{}, {:.2g} times the prediction", withUnit(*f.measured, f.unit), f.ratio());
}

std::string limitsOf(const EnvelopeFinding::Limited& l) {
    std::string text = l.holds() ? "holds" : "";
    const auto lacks = [&text](bool is, const char* word) {
        if (!is) text += fmt::format("{}{}", text.empty() ? "" : ", ", word);
    };
    lacks(l.finite, "not finite");
    lacks(l.bounded, "fails");
    lacks(l.nothingLost, "loses particles");
    return text;
}

std::string pageOf(std::span<const EnvelopeFinding> findings, const std::string& machine, bool picture) {
    std::string text = fmt::format(
        "# Where methods fail\n\n"
        "Written by the program ({}), from [stability.csv](stability.csv). Each section is a scene in `assets/stability`. With "
        "`fluid.limits` off a step is as long as requested and no speed is limited. One parameter is increased until the scene fails; the "
        "table compares this value with the limit that the literature predicts. Predicted limits are sufficient conditions: a scene "
        "usually holds up to a few times the limit, and where one fails sooner the reason is given. Then the limits are switched on, and "
        "the same scene runs with twice the value at which it failed.\n\n",
        machine);
    if (picture) text += "![predicted and measured](stability.svg)\n\n";
    size_t failed = 0, early = 0, hold = 0;
    for (const EnvelopeFinding& f : findings) {
        failed += f.measured ? 1 : 0;
        early += f.measured && f.ratio() < 1 ? 1 : 0;
        hold += f.limited.holds() ? 1 : 0;
    }
    text += fmt::format("{} of {} sweeps failed, {} of them below the predicted limit; with the limits on {} of {} hold.\n\n", failed,
                        findings.size(), early, hold, findings.size());
    for (const EnvelopeRow& row : envelope().rows) {
        const auto of = [&row](const EnvelopeFinding& f) { return f.row == row.name; };
        const auto first = std::find_if(findings.begin(), findings.end(), of);
        if (first == findings.end()) continue;
        std::string doc = row.doc;
        doc[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(doc[0])));
        text += fmt::format("## {}\n\n{}. Predictor: {}. Failure: {}.\n\n", row.name, doc, row.predictor, first->criterion);
        if (row.remark[0] != '\0') text += fmt::format("{}\n\n", row.remark);
        text +=
            "| method | swept | predicted | failed, limits off | limits on | requested | steps | notices |\n"
            "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
        for (const EnvelopeFinding& f : findings)
            if (of(f))
                text +=
                    fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", f.method, f.what, withUnit(f.predicted, f.unit),
                                verdictOf(f), limitsOf(f.limited), withUnit(f.limited.asked, f.unit), f.limited.steps, f.limited.notice);
        text += '\n';
    }
    text.pop_back();
    return text;
}

}  // namespace

Status writeEnvelope(const std::string& folder, std::span<const EnvelopeFinding> findings, const std::string& machine) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return failed(fmt::format("the folder {} cannot be created: {}", folder, error.message()));
    if (Status wrote = writeFileAtomic(folder + "/stability.csv", csvOf(findings, machine)); !wrote) return wrote;
    const Status drawn = drawPlot(plotOf(findings), folder + "/stability.svg");
    if (Status wrote = writeFileAtomic(folder + "/stability.md", pageOf(findings, machine, static_cast<bool>(drawn))); !wrote) return wrote;
    return drawn;
}

}  // namespace rivulet
