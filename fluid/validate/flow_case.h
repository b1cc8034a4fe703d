// What the cases of flow on skins share: a run that is timed and can be stopped, and shapes that drops run down.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fluid/flow/surface_flow.h"
#include "fluid/validate/flow_shapes.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

constexpr double kStep = 1.0 / 60;  // s
constexpr double kGravity = 9.81;   // m/s^2
constexpr Layout kLayouts[] = {Layout::own, Layout::stretched, Layout::turned, Layout::pieces};

struct Under {
    const CaseSettings& settings;
    Outcome outcome = {};
    double wall = 0, simulated = 0;  // s
    double share = 0;                // of the case that is done
    bool stopped = false;

    // One step. false: stop.
    bool step(SurfaceFlow& flow, const SurfaceFlowInputs& inputs, double seconds = kStep);
    void found(std::string what, const char* unit, double measured, double reference, double error, std::optional<double> tolerance);
};

// One after the other, each with the share of the case that is done behind it.
using FlowPart = std::pair<double, std::function<Status()>>;
Result<Outcome> runParts(Under& u, std::span<const FlowPart> parts);

// m^3, of the drop that an upright wall just holds (Furmidge 1962).
double furmidgeVolume(const SurfaceFlowParams& params);

// A way down: from `from`, until it is below `level` (m).
struct PathCase {
    const char* name;
    Shape shape;
    vec3 from;
    float level;
};
std::vector<PathCase> pathCases();

// The ledger of a minute (quick: ten seconds) on a ball that breathes, with gusts: so many picolitres shed ten times a second and eye, and
// what is on it, has left it and has dried, against what was shed.
void breathe(Under& u, SurfaceFlow& flow, const Shape& rest, uint32_t picolitres, std::optional<double> tolerance);

// The same figures of thesis mode, where they mean something. Only reported.
Result<Outcome> runFlowThesis(const CaseSettings& settings);

}  // namespace rivulet
