// SceneOpening: a scene that is made ready on a thread of its own, while another goes on being shown.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "engine/app/shared_gl.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

struct OpenedScene {
    std::unique_ptr<Device> device;
    std::unique_ptr<Session> session;
    std::unique_ptr<SceneRenderer> renderer;  // null: nobody asked for one
};

class SceneOpening {
  public:
    struct Request {
        SceneFile scene;
        std::unique_ptr<Device> device;  // cpu or gl, that nothing else is on
        std::string backend;             // as openSession's `asked`
        bool renderer = false;           // whether its surroundings are others than those that are shown
        SharedGl gl;
        Log log;  // told from the other thread
    };
    explicit SceneOpening(Request request);
    ~SceneOpening();  // gives up, and waits

    bool ready(double seconds = 0);  // waits for so long
    // Once, when it is ready, on the thread whose context shares with the request's. Error: as openSession; it was given up.
    Result<OpenedScene> take();
    void giveUp();

    struct Step {
        std::string what = "waiting for what was given up";  // or "voxels of rocks.obj"
        double share = 0;                                    // of all that is done, 0..1
    };
    Step step() const;
    const SceneFile& scene() const { return request_.scene; }

  private:
    Result<OpenedScene> work();

    Request request_;
    mutable std::mutex mutex_;
    std::condition_variable told_;
    Step step_;
    bool givenUp_ = false, done_ = false;
    std::optional<Result<OpenedScene>> result_;
    std::thread thread_;  // last: it uses all of these
};

// Whether the renderer of one scene cannot draw the other's surroundings.
bool needsOtherRenderer(const SceneFile& one, const SceneFile& other);

}  // namespace rivulet
