// SceneRun: the session on screen: stepped at the speed of the wall clock, depending on the plan while the picture is drawn, and recorded
// on request.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "fluid/render/fluid_upload.h"
#include "fluid/session/cooperation.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/scene_opening.h"
#include "fluid/session/session.h"

namespace rivulet {

class SceneRun {
  public:
    // A plan, and the trials that --cooperate auto chose it by.
    // `stop`: of all devices (Device::stopOn).
    void begin(Plan plan, std::vector<CooperationStats::Tried> tried, const Log& log, const std::atomic<bool>* stop = nullptr);
    // Continues with this session, on `device`; null: on the same device as before.
    void adopt(std::unique_ptr<Session> session, std::unique_ptr<Device> device);
    void drop() { work_.reset(); }  // drops a step in progress, before the session is replaced
    Session& session() const { return *session_; }
    Device& device() const { return *device_; }
    Timeline& timeline() { return timeline_; }
    Plan plan() const { return work_->plan(); }

    bool paused() const { return paused_; }
    void pause(bool yes) { paused_ = yes; }
    void stepOnce() { paused_ = stepOnce_ = true; }
    uint64_t steps() const { return steps_; }
    void stepAtMost(uint64_t steps) { mostSteps_ = steps; }

    struct Stepped {
        double ms = 0;                 // on the wall
        double deviceMs = 0;           // of the passes below
        std::vector<PassTime> passes;  // that ended since the last step
        bool toCpu = false;            // the device failed: the cpu continues
        bool repicked = false;         // a frame budget has chosen other values
    };
    using Result = rivulet::Result<std::optional<Stepped>>;  // nothing: there was no step
    // `seconds`: on the wall, since the last frame. `drawn`: the times of the last picture, for the record. Error: the cpu failed too, or
    // what onStepped() returned.
    Result step(double seconds, const std::vector<PassTime>& drawn);
    // Ends a step that another thread has made meanwhile. With `drop`, a step that is only prepared is cancelled.
    Result finish(double seconds, const std::vector<PassTime>& drawn, bool drop);
    void stepOn();  // the picture has read the session: another thread may step

    void onStepped(std::function<Status(const Session&)> call) { onStepped_ = std::move(call); }
    bool endOnStepped() { return std::exchange(onStepped_, {}) != nullptr; }  // whether there was one
    void record();
    bool recording() const { return recorder_.has_value(); }
    void transferred(const TransferFacts& facts);
    RunStats finishRecord();
    // All pending times of the device have arrived.
    const Timeline& wholeTimeline();

  private:
    Result stepped(double ms, double seconds, const std::vector<PassTime>& drawn);

    Log log_;
    const std::atomic<bool>* stop_ = nullptr;
    Timeline timeline_{size_t{1} << 16};
    std::unique_ptr<Device> device_;
    std::unique_ptr<Session> session_;
    Plan plan_ = Plan::alone;
    std::vector<CooperationStats::Tried> tried_;
    std::unique_ptr<Cooperation> work_;
    double waiting_ = 0;   // s of wall time not yet stepped
    double due_ = 0;       // s to simulate while this frame is drawn
    double deviceMs_ = 0;  // of the last step's passes
    int repicked_ = 0;     // by the session's budget
    bool paused_ = false, stepOnce_ = false;
    uint64_t steps_ = 0, mostSteps_ = UINT64_MAX;
    std::function<Status(const Session&)> onStepped_;
    std::optional<RunRecorder> recorder_;
};

}  // namespace rivulet
