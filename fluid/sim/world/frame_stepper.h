// Divides the time of a host's frames into steps: fixed steps and their remainder, and the time budget of a frame's steps.
#pragma once

#include <chrono>

namespace rivulet {

class FrameStepper {
  public:
    // A frame as it is stepped: pieces of the same length, each with a step limit of its own.
    struct Frame {
        int pieces = 0;
        double length = 0;  // s, of a piece
        double before = 0;  // s, what was left over of frames before: the frame's end is before + seconds from the newest state
    };
    // `seconds` > 0; `fixedStep` s, 0: none, and the whole frame is stepped. `budgetMs`: what its steps may take, 0: as long as they do.
    // `whole`: a frame without fixed steps is one piece, however long.
    Frame begin(double seconds, double fixedStep, double budgetMs, bool whole = false);
    // Whether another piece of work may follow `done` (>= 1) equal pieces; called between them, on the cpu.
    bool mayGoOn(int done) const { return budgetMs_ <= 0 || fits(elapsedMs(), done); }
    // The same before the work, from what is known of earlier frames' substeps: of a GPU, whose work is not done when it has been asked
    // for.
    bool mayPlan(int done) const { return budgetMs_ <= 0 || workSubsteps_ <= 0 || (done + 1) * workMs_ <= budgetMs_ * workSubsteps_; }
    // Records that a Device took `ms` for `substeps`. They need not be of the same frame: older frames fade.
    void know(double ms, int substeps);
    // `stepped` s of the frame were. Of fixed steps a part stays for the next frame; whole ones that were not made are dropped.
    // Returns what was dropped, s.
    double end(double stepped);

    double pending() const { return pending_; }  // s asked for, and kept for the next frame
    // 0..1: how far the present lies between the last fixed step's start and its end, seen one step late. 1 without fixed steps.
    float share() const { return fixedStep_ > 0 ? static_cast<float>(pending_ / fixedStep_) : 1.0F; }
    void reset(double pending = 0) {
        pending_ = pending;
        workMs_ = workSubsteps_ = 0;
    }

  private:
    using Clock = std::chrono::steady_clock;
    double elapsedMs() const { return std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
    bool fits(double ms, int done) const { return ms + ms / done <= budgetMs_; }

    Clock::time_point start_;
    double budgetMs_ = 0, seconds_ = 0, fixedStep_ = 0, pending_ = 0;
    double workMs_ = 0, workSubsteps_ = 0;
};

}  // namespace rivulet
