// ChartPanel: speed against accuracy: the chart that the program was built with, and the place of the current run on it. A click on a point
// takes that point's method and values into the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/ui/plot.h"
#include "fluid/session/chart_table.h"
#include "fluid/session/session.h"

namespace rivulet {

// The chart's setting that these values are; null: none.
const ChartSetting* settingOf(const FluidParams& params);

// Measurements of the current run: sums that decay over about 0.5 s simulated.
struct ChartMeasured {
    double ms = 0, seconds = 0;  // on the wall; simulated
    double particleSteps = 0;    // substeps times particles
    double compression = 0;      // mean over particles, times simulated seconds
    void add(double addedMs, double addedSeconds, double particles, int substeps, double avgCompression);
    double wallPerSecond() const { return seconds > 0 ? 1e-3 * ms / seconds : 0; }  // s
    double nsPerParticleStep() const { return particleSteps > 0 ? 1e6 * ms / particleSteps : 0; }
    double densityError() const { return seconds > 0 ? compression / seconds : 0; }  // a fraction
};

// The row that a run is compared with: of the case, of the run's setting or else of its method's default, of the nearest number of
// particles. Null: the case was not run with that method.
const ChartRow* rowLike(const std::vector<ChartRow>& chart, std::string_view name, const ChartSetting* setting, std::string_view method,
                        double particles);
// s on the wall per simulated second that the row's case would take if each of its particles cost as much a step as the run's do.
double broughtTo(const ChartRow& row, const ChartMeasured& measured);

class ChartPanel {
  public:
    ChartPanel();
    void stepped(const FluidWorld& world, double ms, double seconds);  // on the wall; simulated
    void clear() { measured_ = {}; }
    // Inside an ImGui window, pixels. Returns whether a point was clicked: `draft` then has its values and needs a new session.
    bool draw(const Session& session, SceneFile& draft, float width, float height);

    // Where the run lies on the chart: what the circle and its caption say.
    struct Here {
        const ChartRow* row = nullptr;      // that its cost is brought to; null: none
        double cost = 0, densityError = 0;  // s on the wall per simulated second of the row's case; a fraction
    };
    const Here& here() const { return here_; }
    static std::string captionOf(const Here& here, const std::string& name);  // of the case of that name

    const ChartMeasured& measured() const { return measured_; }
    struct Placed {
        const ChartRow* row = nullptr;  // null: the current run
        vec2 at{0.0F};                  // window coordinates, when it was last drawn
    };
    const std::vector<Placed>& placed() const { return placed_; }

  private:
    Here hereOf(const Session& session) const;
    double errorOf(const ChartRow& row) const;
    void chooseCase(float width);
    void place(const Session& session, vec2 low, vec2 size);
    void drawAxes(vec2 low, vec2 size) const;
    void drawCurves() const;
    void drawHere(const Session& session, vec2 low, vec2 size) const;
    void drawLegend(const Session& session, float width);
    void tellRow(const ChartRow& row, const Session& session, const SceneFile& draft) const;
    void tellHere(const Session& session) const;
    double spacingFor(const ChartRow& row, const Session& session) const;
    bool take(const ChartRow& row, const Session& session, SceneFile& draft) const;

    std::vector<ChartRow> chart_;
    std::vector<std::string> cases_, methods_;
    std::string machine_;  // that the chart was measured on
    size_t case_ = 0;
    bool ofDensity_ = true;  // the error shown; else the case's own figure
    bool asMany_ = false;    // a click takes the point's number of particles, too
    ChartMeasured measured_;
    PlotAxis cost_, error_;
    Here here_;
    std::vector<Placed> placed_;
};

}  // namespace rivulet
