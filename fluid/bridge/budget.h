// Budget: a scene says what a frame may take and how far density may be off; the cheapest setting that holds both is picked from the
// measured chart (docs/speed_accuracy.csv), in this machine's milliseconds, and picked anew where a run shows that it does not hold.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "fluid/bridge/scene_file.h"
#include "fluid/validate/chart.h"

namespace rivulet {

// What a scene is made of, as far as its cost goes.
struct SceneSize {
    double particlesAt = 0, spacing = 0;  // so many at this spacing, m; their number goes by its cube
    double fastest = 0;                   // m/s, what its water reaches by falling: FluidWorld::fastestFall
    double finest = 0;                    // m, particles no nearer than this
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
    double frameMs = 0, densityError = 0;         // expected
    bool holdsFrame = false, holdsError = false;  // by the table
};

// The cheapest of the settings that keep density within `maxDensityError` in all cases of the chart with a free surface, at the finest
// spacing, from size.finest on, with which a frame takes at most `frameMs`. Where none keeps it, the one that comes nearest; where the
// frame cannot be held with kFewest particles either, those. nullopt: the chart has no rows of these methods.
std::optional<BudgetPick> pickSetting(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                      const BudgetParams& budget);

// What a setting costs a frame at a spacing, ms; nullopt: the chart or `costs` do not know it.
std::optional<double> frameCost(std::span<const ChartRow> chart, std::span<const SweepCost> costs, const SceneSize& size,
                                const ChartSetting& setting, double spacing);

// Watches a run, a second of its frames at a time.
class Budget {
  public:
    // Of what was picked for `scene`, whose own values hold where a setting says nothing.
    Budget(const SceneFile& scene, std::vector<ChartRow> chart, std::vector<SweepCost> costs, const SceneSize& size,
           const BudgetPick& pick);

    // Puts the setting's values into a scene; not its spacing.
    void apply(SceneFile& scene) const;

    // A frame took `ms`, and density was so far off (mean compression). Whether setting() has changed: values that are not fixed alone.
    // `sentence`: what there is to say; "" = nothing.
    bool frame(double ms, double densityError, std::string& sentence);
    const ChartSetting& setting() const { return *pick_.setting; }
    int repicked() const { return repicked_; }  // how often

    // What was picked, and how it has held so far: lines of text.
    std::string report() const;

  private:
    bool again(double ms, double densityError, std::string& sentence);

    BudgetParams budget_;
    FluidParams given_;
    std::vector<ChartRow> chart_;
    std::vector<SweepCost> costs_;
    SceneSize size_;
    BudgetPick pick_;
    std::set<const ChartSetting*> missed_;
    int repicked_ = 0;
    bool saidWhy_ = false;
    std::string why_;
    // Of the second under way; of all of them.
    double ms_ = 0, error_ = 0, allMs_ = 0, allError_ = 0, worstMs_ = 0, worstError_ = 0;
    int frames_ = 0, allFrames_ = 0;
};

// Picks for a scene that has a budget, by half a second of stepping it with each method of the chart, and puts what it picked into the
// scene, spacing and all; nothing where the scene has no budget. Says what it picked. Error: as Session::create; the program was built
// without a chart.
Result<std::optional<Budget>> openBudget(SceneFile& scene, Device& device, const Log& log);

}  // namespace rivulet
