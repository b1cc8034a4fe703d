// Viewer: a scene that a person looks at: stepped, drawn, with panels and an orbit camera. It knows no window: it takes InputEvents and
// draws into a framebuffer, so that a test can drive it as a person would.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/capture.h"
#include "engine/app/input_events.h"
#include "engine/app/ui_layer.h"
#include "engine/gpu/timer.h"
#include "engine/ui/param_panel.h"
#include "engine/ui/profiler_panel.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/adaptive_quality.h"
#include "fluid/session/cooperation.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/scene_opening.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "fluid/viewer/fluid_panel.h"
#include "fluid/viewer/hot_reload.h"
#include "fluid/viewer/inspector.h"
#include "fluid/viewer/manipulator.h"
#include "fluid/viewer/notices.h"
#include "fluid/viewer/pour_brush.h"
#include "fluid/viewer/scene_browser.h"
#include "fluid/viewer/viewer_options.h"
#include "fluid/viewer/welcome_screen.h"

namespace rivulet {

// A scene's name as the beginning of a file's.
std::string fileName(std::string sceneName);

class Viewer {
  public:
    // Needs a current OpenGL 4.5 context until destroyed. Error: as Session and SceneRenderer; (failed): the window was closed.
    static Result<std::unique_ptr<Viewer>> create(const SceneFile& scene, const ViewerOptions& options, const Log& log);

    ~Viewer();  // a video in the making is closed

    // One picture. `seconds`: on the wall since the last. Steps the water when a sixtieth of a second has gone by, at most once: a slow
    // machine shows slow water, not fewer pictures. With fluid.fixedStep the water has all of the time, but fluid.longestFrame. A window of
    // 0 pixels: stepped, not drawn. Error (failed): out of GPU memory.
    Status frame(const InputEvents& input, double seconds, GLuint framebuffer);

    bool paused() const { return paused_; }
    uint64_t steps() const { return steps_; }
    void stepAtMost(uint64_t steps) { mostSteps_ = steps; }  // a plan that steps ahead of the picture begins none beyond
    const SceneFile& scene() const { return session_->scene(); }
    Session& session() { return *session_; }
    Inspector& watch() { return watch_; }
    const Manipulator& hand() const { return hand_; }
    const PourBrush& brush() const { return brush_; }
    void chooseThing(const Manipulator::Thing& thing) { hand_.choose(thing); }
    const SceneRenderer& renderer() const { return *renderer_; }
    // ms on the CPU for the last frame's panels: making them, and telling OpenGL of them.
    struct PanelCost {
        double made = 0, told = 0;
    };
    const PanelCost& panelCost() const { return panelCost_; }
    const std::string& message() const { return message_; }  // what the last edit was refused for; "" = nothing
    const HotReload& reload() const { return reload_; }
    bool greets() const { return welcomeScreen_.shown(); }

    // Shows another scene, this one until that is ready; a mistake in it is a message.
    void open(SceneFile scene) { startOpening(std::move(scene), true); }
    const SceneOpening* opening() const { return opening_ ? opening_->work.get() : nullptr; }  // null: nothing is being opened

    // From now on keeps the record of the run; starts anew with every new session.
    void record();
    // Told after each step, before anything steps on, until another session begins. Its Error ends frame().
    void onStepped(std::function<Status(const Session&)> told) { told_ = std::move(told); }
    RunStats finishRecord();  // after record()
    // What is under way on another thread is done then, and counted: before session() is read between frames. Error: as frame().
    Status settle();
    const Timeline& timeline() const { return timeline_; }
    const Timeline& wholeTimeline();  // the same, after settle(): waits for the GPU, the times of its last frames are there then

  private:
    static VisitFn visiting(SceneFile& scene);
    void takeKeys(const InputEvents& input);
    void takeKeysAlways(const InputEvents& input);
    void moveCamera(const InputEvents& input);
    void closeTopmost();                                    // of what Escape closes
    void turnBrush();                                       // on, with room for what it pours, or off
    bool handle(const InputEvents& input, bool& recreate);  // whether the hand has the mouse
    void touch(const InputEvents& input);                   // a click that is no drag puts a drop on a skin
    bool drawPresets();                                     // whether one was chosen
    bool drawPanels();                                      // whether a new session is wanted
    void takeEdits(bool recreate);
    // `other`: it is not the one that is shown, edited; `written`: its file was.
    void startOpening(SceneFile scene, bool other, bool written = false);
    void takeWritten(double seconds);
    void rememberOpened(bool written);
    std::string madeOf(SceneFile scene) const;
    void finishOpening();  // when it is ready
    void giveUpOpening();
    Status showsSoon(const Session& next) const;
    Result<OpenedScene> openShowing(const SceneFile& scene, const ViewerOptions& options, const std::string& backend);
    static bool drawProgress(const SceneOpening& work, float height);  // a share of the window's; whether "cancel" was pressed
    void adopt(OpenedScene opened, bool other);
    void refuse(const Error& error, bool other, const SceneFile& before);
    void drawOpening();
    void takeDropped(const InputEvents& input);
    void drawSaving();
    void drawSaid(double seconds);  // what the panels would say, for as long as reading it takes
    void chooseScene();
    Result<std::string> freePath(const char* kind) const;
    Status toggleVideo();
    Status film();         // the picture that was drawn
    Status takePicture();  // into a file of its own beside where the program runs
    Status step(double seconds);
    Status stepped(double ms, double seconds);
    void begin();  // a new session's cooperation
    Status drawWater(Session& session, int width, int height, const std::function<void()>& uploaded);
    void drawUi();
    Status draw(const InputEvents& input, GLuint framebuffer);

    struct Opening {
        std::unique_ptr<SceneOpening> work;
        bool other = false;
        SceneFile before;  // what an edit that fails goes back to
    };
    std::shared_ptr<Notices> notices_ = std::make_shared<Notices>();
    Log log_;
    Timeline timeline_{size_t{1} << 16};
    std::unique_ptr<Device> device_;
    std::unique_ptr<Session> session_;
    Plan plan_ = Plan::alone;
    std::vector<CooperationStats::Tried> tried_;  // by --cooperate auto
    std::unique_ptr<Cooperation> work_;
    double longestStep_ = 0;  // s
    double due_ = 0;          // s simulated, that are to be stepped while this frame is drawn
    std::unique_ptr<SceneRenderer> renderer_;
    FluidUpload upload_;
    UiLayer ui_;
    ProfilerPanel profiler_;
    Inspector watch_;
    gpu::Timer uiTimer_;
    AdaptiveQuality adaptiveQuality_;
    GlFacts gl_;
    SceneFile draft_;    // what the panel edits; becomes the session's when it makes sense
    SceneFile settled_;  // as it was before the edit that is under way
    ParamMemory params_;
    std::string openedText_;      // JSON of the scene as it was opened or saved last, but for the view
    std::string message_, said_;  // said_: what drawSaid() shows
    double saidFor_ = 0;          // s
    bool paused_ = false, stepOnce_ = false, showPanels_ = true, showHelp_ = false, edited_ = false;
    vec2 laidOutFor_{0.0F};  // the window's size that the panel was put into, in ImGui's coordinates
    vec2 pressedAt_{0.0F};   // where the left button went down; window coordinates
    double waiting_ = 0;     // s on the wall that the water has not been stepped for
    double uiMs_ = 0;
    PanelCost panelCost_;
    double deviceMs_ = 0;  // of the passes last heard of
    std::optional<RunRecorder> recorder_;
    uint64_t steps_ = 0, mostSteps_ = UINT64_MAX;
    std::function<Status(const Session&)> told_;
    SceneBrowser browser_;
    Manipulator hand_;
    PourBrush brush_;
    bool anew_ = false;  // a key has asked for what needs a new world
    WelcomeScreen welcomeScreen_;
    std::optional<VideoWriter> video_;
    ivec2 videoSize_{0};
    std::string videoPath_;
    uint64_t filmed_ = 0;                    // pictures
    bool stepShown_ = false;                 // a step was made that no video has yet
    std::string savePath_, saveTrouble_;     // where the scene is to go, asked for while saving_; why it did not
    bool saving_ = false, refocus_ = false;  // refocus_: what was refused is typed on
    float zoom_ = 1;                         // of the panels, as the person likes it
    std::future<Status> written_;            // the picture taken last
    int repicked_ = 0;                       // by the session's budget
    std::optional<SceneFile> left_;          // the scene before this, that was edited and not saved
    std::string asked_, clDevice_;           // as --backend, --device
    std::function<Result<SharedGl>()> share_;
    SharedGl elsewhere_;  // of the thread that opens scenes
    std::unique_ptr<Opening> opening_;
    std::vector<std::unique_ptr<SceneOpening>> givenUp_;  // and not done yet
    HotReload reload_{ShaderFiles::developer().root()};
    bool reopening_ = false;  // what is being opened is the shown scene, whose file was written

    explicit Viewer(UiLayer ui) : ui_(std::move(ui)) {}
};

}  // namespace rivulet
