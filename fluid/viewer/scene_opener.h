// SceneOpener: makes a scene ready on a thread of its own while another is shown, where the window shares its OpenGL context.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/app/shared_gl.h"
#include "fluid/render/backend.h"
#include "fluid/session/scene_opening.h"

namespace rivulet {

class SceneOpener {
  public:
    // Why a scene is opened.
    enum class Cause {
        edit,        // of the one that is shown
        otherScene,  // than the one that is shown
        written,     // the file of the one that is shown was
    };
    struct Work {
        std::unique_ptr<SceneOpening> opening;
        Cause cause = Cause::edit;
        SceneFile before;  // an edit that fails goes back to it
    };
    using Share = std::function<Result<SharedGl>()>;

    // `share`: makes a context that shares with the current one; none: aside() is false. `clDevice`: as makeDevice.
    void begin(Share share, std::string clDevice, const GlFacts& gl, const Log& log);
    // Whether a thread can open scenes; the first call makes its context. With `trouble`, a failure is final and why is returned there.
    bool aside(std::string* trouble = nullptr);
    // Where aside(). A scene that is being opened is given up.
    void start(SceneFile scene, Cause cause, const SceneFile& before, Backend backend, const std::string& asked, bool renderer);
    void giveUp();                                    // what is under way, if anything is
    const Work* work() const { return work_.get(); }  // null: nothing is being opened
    bool edits() const { return work_ && work_->cause == Cause::edit; }
    bool ready(double seconds = 0) { return work_ && work_->opening->ready(seconds); }  // waits up to that long
    Work take();
    void collect();  // frees what was given up and has ended
    // The first scene, with a renderer, on `device`: `pump` is called about 20 times a second; false: it is given up. Error: as
    // openSession; (failed) it was given up. Where aside().
    Result<OpenedScene> openFirst(const SceneFile& scene, std::unique_ptr<Device> device, const std::string& backend,
                                  const std::function<bool(const SceneOpening&)>& pump);
    // A bar with what is done, `height` from the top, a share of the window's, in the middle of what is right of `left`, px. Whether
    // "cancel" was pressed.
    static bool drawProgress(const SceneOpening& work, float height, float left);

  private:
    Share share_;
    std::string clDevice_;
    GlFacts gl_;
    Log log_;
    SharedGl context_;  // of the thread that opens scenes; before what uses it
    std::unique_ptr<Work> work_;
    std::vector<std::unique_ptr<SceneOpening>> givenUp_;  // and still running
};

}  // namespace rivulet
