// Cooperation: who simulates while who draws. The plans are rows; a frame is start(), drawing, finish(), whatever the plan.
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
    alone,   // a frame is stepped, then drawn
    thesis,  // the next step's cells are found on the CPU while the GPU draws the step just done (thesis 2.3)
    behind,  // the cpu steps on while gl draws the frame before
};
struct PlanRow {
    const char* name;  // as --cooperate takes it, but for auto
    const char* doc;
    Plan plan;
};
Table<PlanRow> plans();

inline constexpr const char* kDrawingLane = "gl: drawing";

class Cooperation {
  public:
    // Lanes of `timeline`, null: none: "main", and "cpu: ahead" of what another thread does meanwhile. A plan that the session cannot
    // follow, or could do nothing for, becomes alone, and `log` says why.
    Cooperation(Session& session, Plan plan, Timeline* timeline, const Log& log);
    ~Cooperation();  // what is under way on another thread is done then
    Cooperation(const Cooperation&) = delete;
    Cooperation& operator=(const Cooperation&) = delete;

    // The next step of the session, of `seconds`; `wait`, `deviceMs` as Session::step. What is to be drawn meanwhile has been uploaded.
    // Until finish() nothing else of the session may be called, but what drawing reads: solids(), scene(), flows().
    void start(double seconds, bool wait, double deviceMs = 0);
    // The session is stepped then: ms on the wall that it took, those of finding cells included. 0: nothing was started.
    double finish();
    // Both at once, where nothing is drawn meanwhile: whatever the plan, it would gain nothing.
    double step(double seconds, bool wait, double deviceMs = 0);
    void drop();  // as finish, but steps no further than has been stepped already
    bool started() const { return started_; }
    bool helped() const { return helped_; }  // of thesis: whether cells could be found ahead
    Timeline* timeline() const { return timeline_; }
    CooperationStats stats() const;      // of its own frames that the timeline still knows
    Plan plan() const { return plan_; }  // thesis becomes alone when the cpu takes over

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
    std::deque<double> frames_;  // s of hostSeconds(), when each began, of those that the timeline still knows
    std::future<void> ahead_;    // what runs meanwhile
    struct Cells;
    std::unique_ptr<Cells, void (*)(Cells*)> cells_;
};

void traceKernels(Device& device, Timeline& timeline);  // into a lane "cl: kernels"
// As a file for chrome://tracing; of a run that was longer than the timeline remembers, the log says so. Error (failed): not writable.
Status writeTrace(const std::string& path, const Timeline& timeline, const Log& log);

}  // namespace rivulet
