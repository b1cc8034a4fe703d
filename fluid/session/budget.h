// Budget: a scene limits the cost of a frame and the compression of water. The cheapest setting within both limits is picked from the
// measured chart (assets/reference/speed_accuracy.csv), in milliseconds of this machine, and picked again when a run exceeds them.
//
// The error that is limited is that of density, which every scene has. The chart's other errors (fronts, periods, pressures) belong to its
// cases alone.
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

// The size of a scene, for its cost.
struct SceneSize {
    double particlesAt = 0, spacing = 0;  // count at this spacing, m; it scales with the cube
    double most = 0;                      // fluid.maxParticles; 0 = no limit
    double fastest = 0;                   // m/s, reached by falling: FluidWorld::fastestFall
    double finest = 0;                    // m, the finest spacing that may be picked
    double particles(double at) const;    // at another spacing
};

// ns per particle and sweep over neighbours, everything included: of a method, on a machine.
struct SweepCost {
    std::string method;
    double ns = 0;
};

struct BudgetPick {
    const ChartSetting* setting = nullptr;
    double spacing = 0;                           // m
    double particles = 0;                         // expected
    double frameMs = 0, densityError = 0;         // expected; the error a fraction
    bool holdsFrame = false, holdsError = false;  // by the chart
};

// Of the settings that keep compression within maxDensityError in all cases of the chart with a free surface: the one that holds frameMs at
// the finest spacing, from size.finest on; of several at the same spacing the cheapest. If none keeps the error, the one nearest to it; if
// 500 particles still exceed frameMs, those. nullopt: there are no particles, or the chart has no rows of these methods.
std::optional<BudgetPick> pickSetting(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                      const BudgetParams& budget);

// ms per frame of a setting at a spacing; nullopt: the chart or `costs` lack it. From the chart's dam break: its sweeps per step, and its
// steps by the spacings that the fastest particle travels in a frame.
std::optional<double> frameCost(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                const ChartSetting& setting, double spacing);

// Sets a setting's method and values in a scene: the Params that settings name. All others keep the scene's values, its spacing too.
void applySetting(const ChartSetting& setting, SceneFile& scene);

// Observes a run, one simulated second at a time.
class Budget {
  public:
    Budget(const BudgetParams& budget, std::vector<ChartRow> chart, std::vector<SweepCost> costs, const SceneSize& size,
           const BudgetPick& pick);

    // `seconds` were simulated in `ms`, with this mean compression (a fraction). Returns whether setting() has changed, to another of the
    // same method: method and spacing are `fixed`. `sentence`: a notice; "" = none.
    bool frame(double ms, double seconds, double densityError, std::string& sentence);
    const ChartSetting& setting() const { return *pick_.setting; }
    int repicked() const { return repicked_; }  // how often

    // The pick and its measured cost and error so far: lines of text.
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
    std::string why_;  // the limits cannot be held
    Mean second_, all_;
    int secondsDone_ = 0;
    double worstMs_ = 0, worstError_ = 0;  // of whole seconds
};

// For a scene with a budget: steps it for half a second with each method of the chart, picks, sets the pick in the scene (spacing included)
// and logs it. Nothing where the scene has no budget, or no water to measure. Error: as Session::create.
Result<std::optional<Budget>> openBudget(SceneFile& scene, Device& device, const Log& log);

}  // namespace rivulet
