// Autotune: plans of cooperation, tried on a scene, in turns, to find the fastest here. `--cooperate auto` and chapter 2's bench share it.
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

// A plan on a device, and what a frame took of it.
struct PlanTried {
    std::string backend;  // as --backend
    Plan plan = Plan::alone;
    Spread frameMs = {};                         // on the wall, over the turns
    std::vector<double> turns = {};              // and of each turn
    double stepMs = 0, drawMs = 0;               // on the wall of the main thread, medians; what waits for another thread included
    double overlapMs = 0;                        // a frame: of drawing, and what another thread did meanwhile
    std::map<std::string, double> passes = {};   // ms a frame, the device's kernels, means
    std::map<std::string, double> drawing = {};  // the same of the passes that draw
};
std::string nameOf(const PlanTried& tried);  // "cpu", "gl, thesis", "cpu, behind"

// Draws the session as it is, until it is drawn; calls `uploaded` once nothing more is read of its world. `passes`: what it took.
using DrawFrame = std::function<Status(Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes)>;

class Autotune {
  public:
    // From the scene's start. Error: as Session::create.
    static Result<Autotune> create(const SceneFile& scene, Device& device, Plan plan, const Log& log);
    // One turn: `frames` frames, each stepped and drawn, after one that is not counted. Error: it cannot be drawn; (failed) the device has
    // failed.
    Status run(const DrawFrame& draw, int frames);
    void forget();           // what was counted so far
    bool couldHelp() const;  // whether the plan had something to do; of what has run
    double lastMs() const;   // of the last turn's fastest frame
    const Session& session() const { return *session_; }
    PlanTried told() const;

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
    const GlFacts& gl;  // of the context that is current
    const DrawFrame& draw;
    Log log = {};
    std::string clDevice = {};  // as makeDevice
    double seconds = 10;        // about: no turn begins later, once each plan has had one
    std::function<void(double share, const std::string& plan)> progress = [](double, const std::string&) {};
};
// Every plan on every device that there is, the fastest first; those that are compared take turns, and who is far behind drops out. A
// device that cannot open the scene, or fails, and a plan that could do nothing are left out. Error: the scene cannot be opened, or drawn;
// it has a budget, which picks another setting on each device (badInput).
Result<std::vector<PlanTried>> tryPlans(const PlanRequest& request);
// What a frame of one takes beyond another's, a fraction: the median over the turns of their ratio in each.
double beyond(const PlanTried& own, const PlanTried& other);
// The choice, in words; `named`: the backend that was asked for, which it may leave.
std::string sentenceOf(std::span<const PlanTried> tried, std::string_view named);
// For --stats.
std::vector<CooperationStats::Tried> statsOf(std::span<const PlanTried> tried);

}  // namespace rivulet
