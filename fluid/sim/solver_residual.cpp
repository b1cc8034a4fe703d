#include "fluid/sim/solver_residual.h"

#include <algorithm>
#include <cmath>

#include "shaders/fluid/stats_row.h"

namespace rivulet {

Result<SolverResidual> SolverResidual::create(Device& device, std::span<const Define> defines) {
    SolverResidual r;
    Result<Kernel> found = device.kernel("fluid/residual", defines);
    if (!found) return found.error();
    r.kernel_ = *found;
    Result<Buffer> rows = device.allocate((STATS_THREADS + 1) * sizeof(float));
    if (!rows) return rows.error();
    r.rows_ = std::move(*rows);
    return r;
}

double SolverResidual::measure(StepContext& c, const Buffer& of) {
    c.device.run(kernel_, c.params, {&c.grid.cellStart(), &of, &rows_}, STATS_THREADS);
    c.device.readLater(rows_, rows_.bytes(), [last = last_](std::span<const std::byte> bytes) {
        const float* values = reinterpret_cast<const float*>(bytes.data());
        double total = 0;
        for (uint32_t t = 0; t < STATS_THREADS; ++t) total += double{values[t]};
        *last = {total / std::max(1.0, double{values[STATS_THREADS]}), true};
    });
    return last_->value;
}

int SolverResidual::planned(double tolerance, int most) {
    if (last_->fresh) {
        // An iteration leaves about seven tenths of what it finds: three for each factor of e; down again by a quarter of that, as what is
        // known is some frames old and several tell the same.
        const double over = std::clamp(last_->value / tolerance, 1e-9, 1e30);
        if (over > 1) planned_ += static_cast<int>(std::ceil(std::min(3 * std::log(over), 100.0)));
        if (over < 0.5) planned_ -= std::max(static_cast<int>(-0.75 * std::log(over)), 1);
        last_->fresh = false;
    }
    return planned_ = std::clamp(planned_, 1, most);
}

}  // namespace rivulet
