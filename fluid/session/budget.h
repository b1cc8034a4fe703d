// Budget: a scene says what a frame may take and how far water may be compressed; the cheapest setting that holds both is picked from the
// measured chart (assets/reference/speed_accuracy.csv), in this machine's milliseconds, and picked anew where a run shows that it does not
// hold.
//
// The error that a scene tolerates is that of density, which every scene has and shows; what else the chart knows (fronts, periods,
// pressures) is of its cases alone.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "fluid/scene/scene_file.h"
#include "fluid/session/chart_table.h"

namespace rivulet {

// What a scene is made of, as far as its cost goes.
struct SceneSize {
    double particlesAt = 0, spacing = 0;  // so many at this spacing, m; their number goes by its cube
    double most = 0;                      // fluid.maxParticles; 0 = as many as there are
    double fastest = 0;                   // m/s, what its water reaches by falling: FluidWorld::fastestFall
    double finest = 0;                    // m, particles no nearer than this
    double particles(double at) const;    // at another spacing
};

// ns that a particle costs a sweep over neighbours, and all that goes with it: of a method, on a machine.
struct SweepCost {
    std::string method;
    double ns = 0;
};

struct BudgetPick {
    const ChartSetting* setting = nullptr;
    double spacing = 0;                           // m
    double particles = 0;                         // about
    double frameMs = 0, densityError = 0;         // expected; the error a fraction
    bool holdsFrame = false, holdsError = false;  // by the table
};

// Of the settings that keep compression within maxDensityError in all cases of the chart with a free surface the one that a frame takes at
// most frameMs with at the finest spacing, from size.finest on; of several at the same spacing the cheapest. Where none keeps it, the one
// that comes nearest; where 500 particles still take longer, those. nullopt: there are no particles, or the chart has no rows of these
// methods.
std::optional<BudgetPick> pickSetting(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                      const BudgetParams& budget);

// What a setting costs a frame at a spacing, ms; nullopt: the chart or `costs` do not know it. By the chart's dam break: its sweeps a step,
// and its steps by how many spacings the fastest goes in a frame.
std::optional<double> frameCost(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                const ChartSetting& setting, double spacing);

// Takes a setting's method and values into a scene: the Params that settings name; all others stay the scene's, its spacing, too.
void applySetting(const ChartSetting& setting, SceneFile& scene);

// Watches a run, a simulated second at a time.
class Budget {
  public:
    Budget(const BudgetParams& budget, std::vector<ChartRow> chart, std::vector<SweepCost> costs, const SceneSize& size,
           const BudgetPick& pick);

    // `seconds` were simulated, which took `ms`; so far was density off then (mean compression, a fraction). Whether setting() has changed,
    // to another of the same method: the rest is `fixed`. `sentence`: what there is to say; "" = nothing.
    bool frame(double ms, double seconds, double densityError, std::string& sentence);
    const ChartSetting& setting() const { return *pick_.setting; }
    int repicked() const { return repicked_; }  // how often

    // What was picked, and how it has held so far: lines of text.
    std::string report() const;

  private:
    struct Mean {
        double ms = 0, error = 0, seconds = 0;  // sums, the error's by time
        double frameMs() const;
        double densityError() const { return seconds > 0 ? error / seconds : 0; }
    };
    bool again(double ms, double densityError, std::string& sentence);
    bool holds(double ms, double densityError) const;

    BudgetParams budget_;
    std::vector<ChartRow> chart_;
    std::vector<SweepCost> costs_;
    SceneSize size_;
    BudgetPick pick_;
    std::set<const ChartSetting*> missed_;
    int repicked_ = 0;
    std::string why_;  // it cannot be held
    Mean second_, all_;
    int secondsDone_ = 0;
    double worstMs_ = 0, worstError_ = 0;  // of whole seconds
};

// Picks for a scene that has a budget, by half a second of stepping it with each method of the chart, and puts what it picked into the
// scene, spacing and all; nothing where the scene has no budget, or no water to measure. Says what it picked. Error: as Session::create.
Result<std::optional<Budget>> openBudget(SceneFile& scene, Device& device, const Log& log);

}  // namespace rivulet
