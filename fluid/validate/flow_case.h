// Shared by the cases of flow on skins: a timed run that can be stopped, and shapes that drops run down.
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
    double share = 0;                // of the case that is finished
    bool stopped = false;

    // One step. false: stop.
    bool step(SurfaceFlow& flow, const SurfaceFlowInputs& inputs, double seconds = kStep);
    void found(std::string what, const char* unit, double measured, double reference, double error, std::optional<double> tolerance);
};

// Parts of a case in order, each with the share of the case that is finished after it.
using FlowPart = std::pair<double, std::function<Status()>>;
Result<Outcome> runParts(Under& u, std::span<const FlowPart> parts);

// m^3, the largest drop that a vertical wall holds (Furmidge 1962).
double furmidgeVolume(const SurfaceFlowParams& params);

// A path down a shape: from `from` until the drop is below `level` (m).
struct PathCase {
    const char* name;
    Shape shape;
    vec3 from;
    float level;
};
std::vector<PathCase> pathCases();

// The ledger of a minute (quick: ten seconds) on a ball that expands and contracts, with gusts. Each of two sources emits `picolitres` ten
// times a second; the volumes on the skin, released and dried are compared with the volume emitted.
void breathe(Under& u, SurfaceFlow& flow, const Shape& rest, uint32_t picolitres, std::optional<double> tolerance);

// The figures of thesis mode, as far as they are meaningful. Only reported.
Result<Outcome> runFlowThesis(const CaseSettings& settings);

}  // namespace rivulet
