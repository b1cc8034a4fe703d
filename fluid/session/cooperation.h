// Cooperation of CPU and GPU: what is simulated while the frame before is drawn. The plans are rows; with each of them a frame is start(),
// drawing, finish().
#pragma once

#include <deque>
#include <future>
#include <memory>

#include "engine/core/log.h"
#include "engine/core/table.h"
#include "engine/core/timeline.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"

namespace rivulet {

enum class Plan {
    alone,   // each frame is simulated, then drawn
    thesis,  // the CPU builds the next step's grid cells while the GPU draws the last step (thesis 2.3)
    behind,  // the cpu steps on while gl draws the frame before
};
struct PlanRow {
    const char* name;  // a value of --cooperate, which also has auto
    const char* doc;
    Plan plan;
};
Table<PlanRow> plans();

inline constexpr const char* kDrawingLane = "gl: drawing";

class Cooperation {
  public:
    // Lanes of `timeline` (may be null): "main", and "cpu: ahead" for the other thread. A plan that the session does not support, or
    // that would have nothing to do, becomes alone; the log gives the reason.
    Cooperation(Session& session, Plan plan, Timeline* timeline, const Log& log);
    ~Cooperation();  // waits for the other thread
    Cooperation(const Cooperation&) = delete;
    Cooperation& operator=(const Cooperation&) = delete;

    // Starts the next step, of `seconds`; `wait`, `deviceMs` as Session::step. The frame to be drawn must be uploaded before. Until
    // finish() only solids(), scene() and flows() of the session may be called, which drawing reads.
    void start(double seconds, bool wait, double deviceMs = 0);
    // Completes the step. Returns ms of wall time, finding cells included. 0: no step was started.
    double finish();
    // Both, where nothing is drawn at the same time: no plan would gain anything.
    double step(double seconds, bool wait, double deviceMs = 0);
    void drop();  // as finish, but without completing the step
    bool started() const { return started_; }
    bool helped() const { return helped_; }  // plan thesis: cells could be found ahead
    Timeline* timeline() const { return timeline_; }
    CooperationStats stats() const;      // of those of its frames that the timeline still holds
    Plan plan() const { return plan_; }  // thesis becomes alone after a fallback to the cpu

  private:
    void wait();
    void begin(double seconds, bool wait, double deviceMs);
    void findCells();
    double advance();
    void count();

    Session* session_;
    Plan plan_;
    Timeline* timeline_;
    Log log_;
    bool started_ = false, wait_ = false, helped_ = false;
    double seconds_ = 0, deviceMs_ = 0, aheadMs_ = 0, startedAt_ = 0;
    std::deque<double> frames_;  // s of hostSeconds(), when each began, of those that the timeline still holds
    std::future<void> ahead_;    // the other thread's work
    struct Cells;
    std::unique_ptr<Cells, void (*)(Cells*)> cells_;
};

void traceKernels(Device& device, Timeline& timeline);  // into a lane "cl: kernels"
// Writes a file for chrome://tracing. If the run was longer than the timeline holds, the log reports it. Error (failed): not writable.
Status writeTrace(const std::string& path, const Timeline& timeline, const Log& log);

}  // namespace rivulet
