// What an iterative pressure solver leaves, and how many iterations that asks for: known at once on the cpu, on a GPU some frames late,
// where nothing waits for it.
#pragma once

#include <memory>

#include "fluid/sim/step_context.h"

namespace rivulet {

class SolverResidual {
  public:
    // `defines`: of fluid/residual, which says what it sums.
    static Result<SolverResidual> create(Device& device, std::span<const Define> defines);

    // The mean over all particles, a fraction, as last known.
    double value() const { return last_->value; }
    // Measures `of` (see fluid/residual). cpu: and returns it. A GPU: it is known later, and what is returned is older.
    double measure(StepContext& context, const Buffer& of);
    // A GPU: how many iterations, 1 to `most`, the last one known asks for.
    int planned(double tolerance, int most);

  private:
    struct Known {
        double value = 0;
        bool fresh = false;
    };
    Kernel kernel_;
    Buffer rows_;
    int planned_ = 30;  // until one is known: pressure begins from nothing
    std::shared_ptr<Known> last_ = std::make_shared<Known>();
};

}  // namespace rivulet
