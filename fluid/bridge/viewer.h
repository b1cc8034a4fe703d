// Viewer: a scene that a person looks at: stepped, drawn, with panels and an orbit camera. It knows no window: it takes InputEvents and
// draws into a framebuffer, so that a test can drive it as a person would.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/input_events.h"
#include "engine/app/ui_layer.h"
#include "engine/gpu/timer.h"
#include "engine/ui/profiler_panel.h"
#include "engine/ui/timeline_panel.h"
#include "fluid/bridge/backend.h"
#include "fluid/bridge/cooperation.h"
#include "fluid/bridge/fluid_panel.h"
#include "fluid/bridge/fluid_upload.h"
#include "fluid/bridge/haste.h"
#include "fluid/bridge/run_stats.h"
#include "fluid/bridge/scene_renderer.h"
#include "fluid/bridge/session.h"
#include "fluid/bridge/voxel_panel.h"

namespace rivulet {

struct ViewerOptions {
    std::string backend = "auto";
    std::string device = {};         // of cl, as makeDevice
    std::string cooperate = "off";   // a row of plans(), or auto, which tries them at the start
    void* clipboard = nullptr;       // as UiLayer
    int width = 1280, height = 720;  // pixels, of what auto tries
};

class Viewer {
  public:
    // Needs a current OpenGL 4.5 context until destroyed. Error: as Session and SceneRenderer.
    static Result<std::unique_ptr<Viewer>> create(const SceneFile& scene, const ViewerOptions& options, const Log& log);

    // One picture. `seconds`: on the wall since the last. Steps the water when a sixtieth of a second has gone by, at most once: a slow
    // machine shows slow water, not fewer pictures. With fluid.fixedStep the water has all of the time, but fluid.longestFrame. A window of
    // 0 pixels: stepped, not drawn. Error (failed): out of GPU memory.
    Status frame(const InputEvents& input, double seconds, GLuint framebuffer);

    bool paused() const { return paused_; }
    uint64_t steps() const { return steps_; }
    const SceneFile& scene() const { return session_->scene(); }
    Session& session() { return *session_; }
    const std::string& message() const { return message_; }  // what the last edit was refused for; "" = nothing

    // From now on keeps the record of the run; starts anew with every new session.
    void record();
    RunStats finishRecord();          // after record()
    void settle() { work_->drop(); }  // what is under way on another thread is done then: before session() is read between frames
    const Timeline& timeline() const { return timeline_; }

  private:
    void takeKeys(const InputEvents& input);
    void moveCamera(const InputEvents& input);
    void touch(const InputEvents& input);  // a click that is no drag puts a drop on a skin
    bool drawPresets();                    // whether one was chosen
    bool drawPanels();                     // whether a new session is wanted
    void takeEdits(bool recreate);
    Status step(double seconds);
    Status stepped(double ms, double seconds);
    void begin();  // a new session's cooperation
    Status drawWater(Session& session, int width, int height, const std::function<void()>& uploaded);
    Status draw(const InputEvents& input, GLuint framebuffer);

    // Said to the person, from whichever thread.
    struct Notices {
        std::mutex mutex;
        std::vector<std::string> sentences;
    };
    std::shared_ptr<Notices> notices_ = std::make_shared<Notices>();
    Log log_;
    Timeline timeline_{size_t{1} << 16};
    std::unique_ptr<Device> device_;
    std::unique_ptr<Session> session_;
    Plan plan_ = Plan::alone;
    std::unique_ptr<Cooperation> work_;
    double due_ = 0;  // s simulated, that are to be stepped while this frame is drawn
    std::unique_ptr<SceneRenderer> renderer_;
    FluidUpload upload_;
    UiLayer ui_;
    ProfilerPanel profiler_;
    TimelinePanel timelinePanel_;
    VoxelPanel voxels_;
    gpu::Timer uiTimer_;
    Haste haste_;
    GlFacts gl_;
    SceneFile draft_;    // what the panel edits; becomes the session's when it makes sense
    SceneFile settled_;  // as it was before the edit that is under way
    std::string message_;
    bool paused_ = false, stepOnce_ = false, showPanels_ = true, showHelp_ = false, edited_ = false;
    vec2 pressedAt_{0.0F};  // where the left button went down; window coordinates
    double waiting_ = 0;    // s on the wall that the water has not been stepped for
    double uiMs_ = 0;
    double deviceMs_ = 0;  // of the passes last heard of
    std::optional<RunRecorder> recorder_;
    uint64_t steps_ = 0;
    int repicked_ = 0;  // by the session's budget

    explicit Viewer(UiLayer ui) : ui_(std::move(ui)) {}
};

}  // namespace rivulet
