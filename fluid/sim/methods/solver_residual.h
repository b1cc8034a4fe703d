// Residual of an iterative pressure solver, and the number of iterations that it needs. The cpu has both at once. A GPU decides on the
// device when to stop: queued iterations beyond that skip their sweeps over particles, and the host reads the result some frames late.
#pragma once

#include <memory>

#include "fluid/sim/world/step_context.h"

namespace rivulet {

class SolverResidual {
  public:
    // `defines`: of fluid/methods/residual; they select the quantity that it sums.
    static Result<SolverResidual> create(Device& device, std::span<const Define> defines);

    // Residual of the last step that was read, the mean over all particles, a fraction; and the iterations of a step. A GPU: the mean over
    // the steps that were read together.
    double value() const { return last_->value; }
    double iterations() const { return iterations_; }

    // Measures `of` (see fluid/methods/residual). Returns the residual; on a GPU an older one.
    double measure(StepContext& context, const Buffer& of);
    // A GPU: the number of iterations, 1 to `most`, that the last residual read requires.
    int plannedIterations(double tolerance, int most);

    // For kernels that return at once after the solver has converged: see fluid/methods/solver_progress. On the cpu it is never set.
    const Buffer& progress() const { return progress_; }
    // After iteration `k`, from 0: true if the residual of `of` has reached its goal, see goalAt() of solver_stop.h; `reach`: the longest
    // path of a particle in a step, m. A GPU: always false; the device decides.
    bool converged(StepContext& context, const Buffer& of, double tolerance, double reach, int k);
    // A GPU: the number of iterations to queue, 1 to `most`.
    int iterationsToQueue(int most);
    // A GPU, after the last iteration: requests the result for the host.
    void readLater(StepContext& context);
    // Returns to the initial state, for a world that is reset.
    void reset();

  private:
    struct Readback {
        double value = 0;
        int steps = 0;                    // since the host last read them
        double iterations = 0, most = 0;  // sum and maximum over these steps
        bool fresh = false, tooFew = false;
    };
    Kernel kernel_, advance_;
    Buffer rows_, progress_;
    // Until a residual is read: pressure begins at zero.
    static constexpr int kPlanned = 30, kQueued = 1000;
    int planned_ = kPlanned, queued_ = kQueued;
    double before_ = 0;  // cpu: residual of the previous iteration
    double iterations_ = 0;
    std::shared_ptr<Readback> last_ = std::make_shared<Readback>();
};

}  // namespace rivulet
