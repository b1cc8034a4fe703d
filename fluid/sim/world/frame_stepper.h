// Divides the time of a host's frames into steps: fixed steps and their remainder, and the time budget of a frame's steps.
#pragma once

#include <chrono>

namespace rivulet {

class FrameStepper {
    using Clock = std::chrono::steady_clock;

  public:
    // Division of a frame: pieces of the same length, each with its own step limit.
    struct Frame {
        int pieces = 0;
        double length = 0;  // s, of a piece
        double before = 0;  // s, remainder of earlier frames: the frame ends before + seconds after the newest state
    };
    // `seconds` > 0; `fixedStep` s, 0: none, and the whole frame is stepped. `budgetMs`: limit for the time of its steps, 0: no limit.
    // `whole`: a frame without fixed steps is one piece of any length.
    Frame begin(double seconds, double fixedStep, double budgetMs, bool whole = false);
    // True if one more piece of work fits the budget after `done` (>= 1) equal pieces, by the time measured in this frame; for the cpu.
    bool fitsMeasured(int done) const { return budgetMs_ <= 0 || fits(elapsedMs(), done); }
    // The same by the times of earlier frames' substeps: for a GPU, which has not finished the work when it is queued.
    bool fitsPredicted(int done) const { return budgetMs_ <= 0 || workSubsteps_ <= 0 || (done + 1) * workMs_ <= budgetMs_ * workSubsteps_; }
    // Records that a Device took `ms` for `substeps`. They may belong to different frames: the weight of older frames decreases.
    void recordTime(double ms, int substeps);
    // Ends a frame of which `stepped` s were simulated. A part of a fixed step stays for the next frame; whole steps that were not made are
    // dropped. Returns the dropped time, s.
    double end(double stepped);

    // Since begin(), if the frame has a budget.
    double elapsedMs() const { return std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }

    double pending() const { return pending_; }  // s requested, and kept for the next frame
    // 0..1: position of the displayed time between the start and the end of the last fixed step, one step late. 1 without fixed steps.
    float share() const { return fixedStep_ > 0 ? static_cast<float>(pending_ / fixedStep_) : 1.0F; }
    void reset(double pending = 0) {
        pending_ = pending;
        workMs_ = workSubsteps_ = 0;
    }

  private:
    bool fits(double ms, int done) const { return ms + ms / done <= budgetMs_; }

    Clock::time_point start_;
    double budgetMs_ = 0, seconds_ = 0, fixedStep_ = 0, pending_ = 0;
    double workMs_ = 0, workSubsteps_ = 0;
};

}  // namespace rivulet
