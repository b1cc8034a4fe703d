#include "fluid/viewer/scene_run.h"

#include <algorithm>
#include <utility>

#include "engine/core/assert.h"
#include "fluid/session/cpu_fallback.h"

namespace rivulet {

void SceneRun::begin(Plan plan, std::vector<CooperationStats::Tried> tried, const Log& log, const std::atomic<bool>* stop) {
    plan_ = plan;
    tried_ = std::move(tried);
    log_ = log;
    stop_ = stop;
    timeline_.restart();  // times of what auto tried may be on their way
}

void SceneRun::adopt(std::unique_ptr<Session> session, std::unique_ptr<Device> device) {
    drop();
    session_ = std::move(session);
    if (device) {  // nothing is on the other any more
        device_ = std::move(device);
        device_->stopOn(stop_);
        traceKernels(*device_, timeline_);
    }
    constexpr double kAnswers = 500;  // ms of steps a frame: a window that does not answer for longer seems to hang
    session_->limitFrames(kAnswers);
    work_ = std::make_unique<Cooperation>(*session_, plan_, &timeline_, log_);
    due_ = 0;
    repicked_ = 0;
    if (recorder_) record();
}

SceneRun::Result SceneRun::step(double seconds, const std::vector<PassTime>& drawn) {
    constexpr double kStep = 1.0 / kFramesPerSecond;  // on the wall
    const double simulated = session_->scene().timeScale;
    waiting_ = std::min(waiting_ + std::max(seconds, 0.0), 2 * kStep);
    bool due = waiting_ >= kStep;
    if (due) waiting_ -= kStep;
    // With fixed steps the world keeps the rest of each frame's time and shows the state in between: it is given every frame's time.
    const bool fixed = session_->scene().fluid.fixedStep > 0 && !stepOnce_ && session_->replaying() == nullptr;
    if (fixed) {
        due = seconds > 0;
        waiting_ = 0;
    }
    if ((paused_ || !due) && !stepOnce_) return std::optional<Stepped>();
    stepOnce_ = false;
    due_ = simulated * (fixed ? seconds : kStep);
    if (work_->plan() == Plan::behind) return std::optional<Stepped>();  // while it is drawn
    if (!work_->started() || fixed) {                                    // what was found ahead is of a step as long as the last
        work_->drop();
        return stepped(work_->step(due_, false, deviceMs_), seconds, drawn);
    }
    return stepped(work_->finish(), seconds, drawn);
}

SceneRun::Result SceneRun::finish(double seconds, const std::vector<PassTime>& drawn, bool drop) {
    if (work_->plan() == Plan::behind && work_->started()) return stepped(work_->finish(), seconds, drawn);
    if (drop) work_->drop();
    return std::optional<Stepped>();
}

void SceneRun::stepOn() {
    const bool behind = work_->plan() == Plan::behind && steps_ < mostSteps_;
    if (due_ > 0 && (behind || (work_->plan() == Plan::thesis && !paused_))) work_->start(due_, false, deviceMs_);
    due_ = 0;
}

// `seconds`: on the wall, of the frame.
SceneRun::Result SceneRun::stepped(double ms, double seconds, const std::vector<PassTime>& drawn) {
    if (session_->interrupted()) return std::optional<Stepped>();
    ++steps_;
    Stepped out{.ms = ms, .deviceMs = 0, .passes = {}, .toCpu = false, .repicked = false};
    const rivulet::Result<bool> moved = keepRunning(*session_, device_, log_);
    if (!moved) return moved.error();
    if (*moved) {
        traceKernels(*device_, timeline_);
        out.toCpu = true;
        if (recorder_) recorder_->follow(session_->world());
    }
    if (onStepped_)
        if (Status called = onStepped_(*session_); !called) return called.error();
    const int repicked = session_->budget() ? session_->budget()->repicked() : 0;
    out.repicked = std::exchange(repicked_, repicked) != repicked;
    out.passes = device_->takeTimes();
    deviceMs_ = 0;
    for (const PassTime& pass : out.passes) deviceMs_ += pass.ms;
    out.deviceMs = deviceMs_;
    if (recorder_) {
        recorder_->stepped(ms, out.passes);
        recorder_->drawn(0, 1000 * seconds, drawn);
    }
    return std::optional(std::move(out));
}

void SceneRun::record() { recorder_.emplace(session_->world(), session_->fields(), true, &session_->flows()); }

void SceneRun::transferred(const TransferFacts& facts) {
    if (recorder_) recorder_->transferred(facts);
}

const Timeline& SceneRun::wholeTimeline() {
    device_->finish();
    (void)device_->takeTimes();
    return timeline_;
}

RunStats SceneRun::finishRecord() {
    ASSERT(recorder_, "record() comes first");
    work_->drop();
    (void)wholeTimeline();
    RunStats stats = recorder_->finish(session_->scene().name);
    stats.cooperation = work_->stats();
    stats.cooperation.tried = tried_;
    return stats;
}

}  // namespace rivulet
