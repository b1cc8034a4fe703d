// Cooperation: who simulates while who draws. The plans are rows; a frame is start(), drawing, finish(), whatever the plan.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/timeline.h"
#include "fluid/bridge/backend.h"
#include "fluid/bridge/run_stats.h"
#include "fluid/bridge/session.h"

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
    // follow becomes alone, and `log` says why.
    Cooperation(Session& session, Plan plan, Timeline* timeline, const Log& log);
    ~Cooperation();  // what is under way on another thread is done then
    Cooperation(const Cooperation&) = delete;
    Cooperation& operator=(const Cooperation&) = delete;

    // The next step of the session, of `seconds`; `wait`, `deviceMs` as Session::step. What is to be drawn meanwhile has been uploaded.
    // Until finish() nothing else of the session may be called, but what drawing reads: solids(), scene(), flows().
    void start(double seconds, bool wait, double deviceMs = 0);
    // The session is stepped then: ms on the wall that it took, those of finding cells included. 0: nothing was started.
    double finish();
    void drop();  // as finish, but steps no further than has been stepped already
    bool started() const { return started_; }
    bool helped() const { return helped_; }  // of thesis: whether cells could be found ahead
    Timeline* timeline() const { return timeline_; }
    CooperationStats stats() const;
    Plan plan() const { return plan_; }

  private:
    void wait();
    void findCells();

    Session* session_;
    Plan plan_;
    Timeline* timeline_;
    Log log_;
    bool started_ = false, wait_ = false, told_ = false, helped_ = false;
    int frames_ = 0;
    double seconds_ = 0, deviceMs_ = 0, aheadMs_ = 0;
    std::future<void> ahead_;  // what runs meanwhile
    struct Cells;
    std::unique_ptr<Cells, void (*)(Cells*)> cells_;
};

void traceKernels(Device& device, Timeline& timeline);  // into a lane "cl: kernels"

// A plan on a device, and what a frame took of it.
struct PlanTried {
    std::string backend;  // as --backend
    Plan plan = Plan::alone;
    double frameMs = 0;            // on the wall, median
    std::vector<PassTime> passes;  // ms a frame, of the simulation; drawing's as "render: ..."
};
std::string nameOf(const PlanTried& tried);  // "cpu", "gl, thesis", "cpu, behind"

// Draws the session as it is, its view uploaded; calls `uploaded` between the two. The time that it takes is the frame's.
using DrawFrame = std::function<Status(Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes)>;

// `clDevice`: as makeDevice. A device that cannot open the scene, or fails, and a plan that could do nothing are left out.
// Tries every plan on every device that there is, each from the scene's start, for `frames` frames after as many that are not counted;
// the fastest first. Error: the scene cannot be opened, or drawn.
Result<std::vector<PlanTried>> tryPlans(const SceneFile& scene, const GlFacts& gl, const DrawFrame& draw, const Log& log, int frames = 6,
                                        const std::string& clDevice = {});
// The choice, in words; `named`: the backend that was asked for, which it may leave.
std::string sentenceOf(std::span<const PlanTried> tried, std::string_view named);

}  // namespace rivulet
