// Viewer: an interactive scene with panels and an orbit camera, stepped and drawn. It does not depend on a window: it takes InputEvents and
// draws into a framebuffer, so that a test can operate it as a user does.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "fluid/viewer/commands.h"
#include "fluid/viewer/fluid_panel.h"
#include "fluid/viewer/hot_reload.h"
#include "fluid/viewer/inspector.h"
#include "fluid/viewer/manipulator.h"
#include "fluid/viewer/message_bar.h"
#include "fluid/viewer/mouse_view.h"
#include "fluid/viewer/notices.h"
#include "fluid/viewer/panel_layer.h"
#include "fluid/viewer/pour_brush.h"
#include "fluid/viewer/save_dialog.h"
#include "fluid/viewer/scene_browser.h"
#include "fluid/viewer/scene_draft.h"
#include "fluid/viewer/scene_opener.h"
#include "fluid/viewer/scene_picture.h"
#include "fluid/viewer/scene_recording.h"
#include "fluid/viewer/scene_run.h"
#include "fluid/viewer/screen_capture.h"
#include "fluid/viewer/tear_points.h"
#include "fluid/viewer/viewer_options.h"
#include "fluid/viewer/welcome_screen.h"

namespace rivulet {

// Why nothing of a scene can be changed at the moment.
inline constexpr const char* kReplayed = "a recording is shown, which fixes all values: press simulate in its timeline to change them";

class Viewer {
  public:
    // Needs a current OpenGL 4.5 context until destroyed. Error: as Session and SceneRenderer; (failed): the window was closed.
    static Result<std::unique_ptr<Viewer>> create(const SceneFile& scene, const ViewerOptions& options, const Log& log);

    ~Viewer();  // an unfinished video is closed

    // Draws one picture. `seconds`: wall time since the last one. Steps the water at most once, when a sixtieth of a second has passed: a
    // slow machine shows slow water instead of fewer pictures. With fluid.fixedStep the water gets the whole time, up to
    // fluid.longestFrame. A window of 0 pixels: stepped, not drawn. Error (failed): out of GPU memory.
    Status frame(const InputEvents& input, double seconds, unsigned framebuffer);

    bool paused() const { return run_.paused(); }
    uint64_t steps() const { return run_.steps(); }
    void stepAtMost(uint64_t steps) { run_.stepAtMost(steps); }  // limit for plans that step ahead of the picture
    const SceneFile& scene() const { return session().scene(); }
    Session& session() const { return run_.session(); }
    Inspector& watch() { return watch_; }
    const Manipulator& hand() const { return hand_; }
    const PourBrush& brush() const { return brush_; }
    void chooseThing(const Manipulator::Thing& thing) { hand_.choose(thing); }
    const SceneRenderer& renderer() const { return picture_.renderer(); }
    const PanelLayer::Cost& panelCost() const { return ui_.cost(); }
    const std::string& message() const { return message_; }  // the reason why the last edit was refused; "" = accepted
    const HotReload& reload() const { return reload_; }
    bool greets() const { return welcomeScreen_.shown(); }

    // Opens another scene; the current one is shown until it is ready. An error in it becomes the message.
    void open(SceneFile scene) { startOpening(std::move(scene), Cause::otherScene); }
    const SceneOpening* opening() const { return opener_.work() ? opener_.work()->opening.get() : nullptr; }  // null: none

    // Starts to record the run; the record starts again with every new session.
    void record() { run_.record(); }
    // Called after each step, before the next one, until another session begins. Its Error ends frame().
    void onStepped(std::function<Status(const Session&)> call) { run_.onStepped(std::move(call)); }
    RunStats finishRecord();  // after record()
    // Ends and counts a step under way on another thread: call it before session() is read between frames. Error: as frame().
    Status settle() { return take(run_.finish(0, renderer().times(), true)); }
    const Timeline& timeline() { return run_.timeline(); }
    const Timeline& wholeTimeline();  // the same, after settle(): waits for the GPU, so that the times of the last frames are in it

  private:
    using Cause = SceneOpener::Cause;

    explicit Viewer(UiLayer ui) : ui_(std::move(ui)) {}
    Status start(const SceneFile& scene, const ViewerOptions& options);
    Status take(SceneRun::Result stepped);
    Status draw(const InputEvents& input, unsigned framebuffer);
    void report(const Status& status);  // as the message, if it is an Error

    // viewer_input.cpp
    void takeKeys(const InputEvents& input);
    void run(Command command);
    void turnBrush();                                       // switches the brush on, with memory for its jet, or off
    void undo();                                            // undoes the last move of a thing, or the change of scene that lost edits
    bool handle(const InputEvents& input);                  // true if the manipulator uses the mouse
    void takeMouse(const InputEvents& input, bool greets);  // also shows what the mouse holds
    void takeDropped(const InputEvents& input);

    void replay(size_t frame, bool runs);  // of the recording of this run
    void simulate();                       // again, after a replay

    // viewer_panels.cpp
    void drawPanels();
    void drawScenePanel();
    FluidPanelState panelState() const;
    void drawPresets();
    void drawTimeline(float left, float right);
    void drawCost();
    void drawDialogs(const InputEvents& input, double seconds);
    void saved(const std::string& path);
    void chooseScene();

    // viewer_scenes.cpp
    Result<OpenedScene> openShowing(const SceneFile& scene, const ViewerOptions& options, const std::string& backend,
                                    std::unique_ptr<Device> device);
    void takeEdits(bool recreate);
    void takeWritten(double seconds);
    void rememberOpened(bool written);
    void startOpening(SceneFile scene, Cause cause);
    void finishOpening();  // when it is ready
    void giveUpOpening();
    // s that a frame of the edited session would take, estimated from the present time per particle and step; 0: not longer than now.
    double costOf(const Session& next) const;
    bool tooExpensive(OpenedScene& opened, const SceneFile& made, const SceneFile& before);
    void adoptEdit(OpenedScene opened, SceneFile made);
    void adopt(OpenedScene opened, Cause cause);
    void refuse(const Error& error, Cause cause, const SceneFile& before);

    std::shared_ptr<Notices> notices_ = std::make_shared<Notices>();
    Log log_;
    GlFacts gl_;
    std::string asked_, clDevice_;          // as --backend, --device
    double stepMs_ = 0;                     // of the last steps of this scene
    double longestStep_ = 0, askStep_ = 0;  // s
    SceneRun run_;
    ScenePicture picture_;
    PanelLayer ui_;
    SceneDraft draft_;
    SceneOpener opener_;
    HotReload reload_{ShaderFiles::developer().root()};
    struct Waiting {         // for a yes or no
        OpenedScene opened;  // empty where it is opened again after a yes
        SceneFile made, before;
        std::string sentence;
    };
    std::optional<Waiting> waiting_;  // an edit that is expensive
    bool accepted_ = false;           // the edit that is opened next is made whatever it costs
    std::optional<SceneFile> left_;   // the scene before this one, if it was edited and not saved
    bool edited_ = false;             // the draft, in this frame
    bool anew_ = false;               // the edit needs a new session
    Manipulator hand_;
    PourBrush brush_;
    SkinClick skinClick_;
    TearPoints tearPoints_;
    ProfilerPanel profiler_;
    Inspector watch_;
    SceneBrowser browser_;
    SaveDialog save_;
    WelcomeScreen welcomeScreen_;
    ScreenCapture capture_;
    SceneRecording recording_;
    MessageBar messageBar_;
    std::string message_;
    bool showPanels_ = true, showHelp_ = false;
    float panelRight_ = 0;   // px: where the picture begins beside the panel
    vec2 laidOutFor_{0.0F};  // the window's size that the panel was put into, in ImGui's coordinates
};

}  // namespace rivulet
