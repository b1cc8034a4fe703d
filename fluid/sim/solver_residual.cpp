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
        // An iteration leaves about seven tenths of what it finds: three for each factor of e; down again by ones.
        const double over = last_->value / tolerance;
        planned_ += over > 1 ? static_cast<int>(std::ceil(std::min(3 * std::log(over), 100.0))) : over < 0.5 ? -1 : 0;
        last_->fresh = false;
    }
    return planned_ = std::clamp(planned_, 1, most);
}

}  // namespace rivulet
