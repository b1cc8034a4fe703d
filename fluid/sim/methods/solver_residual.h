// What an iterative pressure solver leaves, and how many iterations that asks for: known at once on the cpu. On a GPU, where nothing waits
// for it, the device itself finds out when they are enough, and what was queued beyond that skips its sweeps over particles; here it is
// known some frames late.
#pragma once

#include <memory>

#include "fluid/sim/world/step_context.h"

namespace rivulet {

class SolverResidual {
  public:
    // `defines`: of fluid/methods/residual, which says what it sums.
    static Result<SolverResidual> create(Device& device, std::span<const Define> defines);

    // What the last step known left, the mean over all particles, a fraction; and the iterations of a step. A GPU: those are the mean over
    // the steps that came to be known together.
    double value() const { return last_->value; }
    double iterations() const { return iterations_; }

    // Measures `of` (see fluid/methods/residual). cpu: and returns it. A GPU: it is known later, and what is returned is older.
    double measure(StepContext& context, const Buffer& of);
    // A GPU: how many iterations, 1 to `most`, the last one known asks for.
    int planned(double tolerance, int most);

    // For kernels that do nothing once iterations are enough: see fluid/methods/solver_progress. On the cpu it never says so.
    const Buffer& progress() const { return progress_; }
    // After iteration `k`, from 0: whether `of` after what has just been applied is at its goal, see goalAt() of solver_stop.h; `reach`:
    // how far the fastest may go in a step, m. A GPU: the device knows.
    bool enough(StepContext& context, const Buffer& of, double tolerance, double reach, int k);
    // A GPU: how many iterations, 1 to `most`, are worth queueing.
    int worthQueueing(int most);
    // A GPU, after the last of them: so that the host knows later.
    void readLater(StepContext& context);
    // As new, for a world that begins again.
    void forget();

  private:
    struct Known {
        double value = 0;
        int steps = 0;                    // since the host last asked
        double iterations = 0, most = 0;  // of them: the sum, of any
        bool fresh = false, tooFew = false;
    };
    Kernel kernel_, advance_;
    Buffer rows_, progress_;
    // Until one is known: pressure begins from nothing.
    static constexpr int kPlanned = 30, kQueued = 1000;
    int planned_ = kPlanned, queued_ = kQueued;
    double before_ = 0;  // cpu: of the iteration before
    double iterations_ = 0;
    std::shared_ptr<Known> last_ = std::make_shared<Known>();
};

}  // namespace rivulet
