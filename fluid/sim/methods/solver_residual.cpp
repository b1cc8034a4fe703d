#include "fluid/sim/methods/solver_residual.h"

#include <algorithm>
#include <cmath>

#include "shaders/fluid/methods/solver_stop.h"
#include "shaders/fluid/world/stats_row.h"

namespace rivulet {

namespace {
constexpr uint32_t kGroup = 256;  // of fluid/methods/solver_progress
}

Result<SolverResidual> SolverResidual::create(Device& device, std::span<const Define> defines) {
    SolverResidual r;
    Result<Kernel> found = device.kernel("fluid/methods/residual", defines);
    if (!found) return found.error();
    r.kernel_ = *found;
    Result<Buffer> rows = device.allocate((STATS_THREADS + 1) * sizeof(float));
    if (!rows) return rows.error();
    r.rows_ = std::move(*rows);
    Result<Buffer> progress = device.allocate(sizeof(vec4));
    if (!progress) return progress.error();
    r.progress_ = std::move(*progress);
    if (device.backend() == Backend::cpu) return r;
    const Define group{"LOCAL_SIZE", std::to_string(kGroup)};
    Result<Kernel> advance = device.kernel("fluid/methods/solver_progress", std::span(&group, 1));
    if (!advance) return advance.error();
    r.advance_ = *advance;
    return r;
}

double SolverResidual::measure(StepContext& c, const Buffer& of) {
    c.device.run(kernel_, c.params, {&c.grid.cellStart(), &of, &rows_, &progress_}, STATS_THREADS);
    c.device.readLater(rows_, rows_.bytes(), [last = last_](std::span<const std::byte> bytes) {
        const float* values = reinterpret_cast<const float*>(bytes.data());
        double total = 0;
        for (uint32_t t = 0; t < STATS_THREADS; ++t) total += double{values[t]};
        last->value = total / std::max(1.0, double{values[STATS_THREADS]});
        last->fresh = true;
    });
    return last_->value;
}

int SolverResidual::plannedIterations(double tolerance, int most) {
    if (last_->fresh) {
        // An iteration reduces the residual to about 0.7: three iterations for each factor of e. The number decreases by a quarter of that,
        // because the residual is some frames old and several frames report the same one.
        const double over = std::clamp(last_->value / tolerance, 1e-9, 1e30);
        if (over > 1) planned_ += static_cast<int>(std::ceil(std::min(3 * std::log(over), 100.0)));
        if (over < 0.5) planned_ -= std::max(static_cast<int>(-0.75 * std::log(over)), 1);
        last_->fresh = false;
    }
    return planned_ = std::clamp(planned_, 1, most);
}

bool SolverResidual::converged(StepContext& c, const Buffer& of, double tolerance, double reach, int k) {
    // A flag, not the iteration's number: a device caches few different blocks of params.
    const uint32_t iteration = k > 0 ? 1 : 0;
    const double wayOf1 = double{c.params.dt} / reach;  // of a speed of 1 m/s
    if (c.device.backend() == Backend::cpu) {
        const double found = measure(c, of);
        const float ahead = residualAhead(static_cast<float>(found), static_cast<float>(before_), iteration);
        before_ = found;
        iterations_ = k + 1;
        return ahead <= goalAt(static_cast<float>(tolerance), static_cast<float>(c.fastest * wayOf1));
    }
    StepParams s = c.params;
    s.iteration = iteration;
    c.device.run(kernel_, s, {&c.grid.cellStart(), &of, &rows_, &progress_}, STATS_THREADS);
    s.force = vec4(static_cast<float>(tolerance), static_cast<float>(wayOf1), 0.0F, 0.0F);
    c.device.run(advance_, s, {&rows_, &c.stats, &progress_}, kGroup);
    return false;
}

int SolverResidual::iterationsToQueue(int most) {
    // A quarter and eight more than the largest number that a step has needed since the last call, but at most a tenth less than before;
    // twice as many if those queued were too few.
    if (last_->steps > 0) {
        queued_ = last_->tooFew ? 2 * queued_ : std::max(static_cast<int>(1.25 * last_->most) + 8, 9 * queued_ / 10);
        iterations_ = last_->iterations / last_->steps;
        *last_ = {.value = last_->value};
    }
    return queued_ = std::clamp(queued_, 1, most);
}

void SolverResidual::reset() {
    planned_ = kPlanned;
    queued_ = kQueued;
    before_ = iterations_ = 0;
    last_ = std::make_shared<Readback>();  // results in flight belong to the state before the reset
}

void SolverResidual::readLater(StepContext& c) {
    c.device.readLater(progress_, progress_.bytes(), [last = last_](std::span<const std::byte> bytes) {
        const vec4& p = *reinterpret_cast<const vec4*>(bytes.data());
        last->value = double{p.x};
        ++last->steps;
        last->iterations += double{p.y};
        last->most = std::max(last->most, double{p.y});
        last->tooFew |= !(p.z > 0);
    });
}

}  // namespace rivulet
