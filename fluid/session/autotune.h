// Autotune: measures the plans of cooperation on a scene, in turns, to find the fastest on this machine. `--cooperate auto` and the
// benchmark of the thesis's chapter 2 share it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/timeline.h"
#include "fluid/render/backend.h"
#include "fluid/session/cooperation.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"

namespace rivulet {

// A plan on a device, and the measured cost of a frame.
struct PlanTried {
    std::string backend;  // as --backend
    Plan plan = Plan::alone;
    Spread frameMs = {};                         // on the wall, over the turns
    std::vector<double> turns = {};              // of each turn
    double stepMs = 0, drawMs = 0;               // wall time of the main thread, medians; waits for another thread included
    double overlapMs = 0;                        // per frame: time in which drawing and another thread's work overlapped
    std::map<std::string, double> passes = {};   // ms per frame, the device's kernels, means
    std::map<std::string, double> drawing = {};  // the same of the render passes
};
std::string nameOf(const PlanTried& tried);  // "cpu", "gl, thesis", "cpu, behind"

// Draws the session's current state and waits for it; calls `uploaded` when its world is no longer read. `passes`: receives the times.
using DrawFrame = std::function<Status(Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes)>;

class Autotune {
  public:
    // From the scene's start. Error: as Session::create.
    static Result<Autotune> create(const SceneFile& scene, Device& device, Plan plan, const Log& log);
    // One turn: `frames` frames, each stepped and drawn, after one that is not counted. Error: drawing fails; (failed) the device has
    // failed.
    Status run(const DrawFrame& draw, int frames);
    void forget();           // discards the turns so far
    bool couldHelp() const;  // whether the plan had work to do in the turns so far
    double lastMs() const;   // of the last turn's fastest frame
    const Session& session() const { return *session_; }
    PlanTried result() const;

  private:
    Autotune() = default;

    PlanTried tried_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<Timeline> timeline_;
    std::unique_ptr<Cooperation> work_;
    std::vector<double> frame_, step_, draw_;  // ms a frame, of each turn
    double lastMs_ = 0;
    int frames_ = 0;
};

struct PlanRequest {
    const SceneFile& scene;
    const GlFacts& gl;  // of the current context
    const DrawFrame& draw;
    Log log = {};
    std::string clDevice = {};  // as makeDevice
    double seconds = 10;        // about: after this no turn begins, once each plan has had one
    std::function<void(double share, const std::string& plan)> progress = [](double, const std::string&) {};
};
// Measures every plan on every available device, the fastest first. Candidates take turns; one that is far behind is dropped. A device that
// cannot open the scene, or fails, and a plan with nothing to do are left out. Error: the scene cannot be opened or drawn; it has a budget,
// which would pick another setting on each device (badInput).
Result<std::vector<PlanTried>> tryPlans(const PlanRequest& request);
// By how much a frame of `own` costs more than one of `other`, a fraction: the median over the turns of their ratio.
double beyond(const PlanTried& own, const PlanTried& other);
// The choice as a sentence; `named`: the backend that was requested, which the choice may differ from.
std::string sentenceOf(std::span<const PlanTried> tried, std::string_view named);
// For --stats.
std::vector<CooperationStats::Tried> statsOf(std::span<const PlanTried> tried);

}  // namespace rivulet
