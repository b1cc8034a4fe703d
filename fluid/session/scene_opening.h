// SceneOpening: opens a scene on its own thread while another scene is still shown.
#pragma once

#include <atomic>
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
    std::unique_ptr<SceneRenderer> renderer;  // null: none was requested
};

class SceneOpening {
  public:
    struct Request {
        SceneFile scene;
        std::unique_ptr<Device> device;  // cpu or gl, used by nothing else
        std::string backend;             // as openSession's `asked`
        bool renderer = false;           // whether one is needed: its surroundings differ from those shown
        SharedGl gl;
        Log log;  // called from the other thread
    };
    explicit SceneOpening(Request request);
    ~SceneOpening();  // cancels, and waits

    bool ready(double seconds = 0);  // waits up to this, s
    // Call it once, when the scene is ready, on the thread whose context shares objects with the request's. The device's stop flag
    // (Device::stopOn) is null afterwards. Error: as openSession; (failed) opening was cancelled.
    Result<OpenedScene> take();
    void giveUp();  // within milliseconds, but for steps that read and voxelise a mesh

    struct Step {
        std::string what = "waiting for a cancelled scene";  // or "voxels of rocks.obj"
        double share = 0;                                    // of all steps that is done, 0..1
    };
    Step step() const;
    const SceneFile& scene() const { return request_.scene; }

  private:
    Result<OpenedScene> work();

    Request request_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    Step step_;
    bool done_ = false;
    std::atomic<bool> givenUp_ = false;  // also interrupts the device
    std::optional<Result<OpenedScene>> result_;
    std::thread thread_;  // last: it uses all of these
};

// Whether the renderer of one scene cannot draw the other's surroundings.
bool needsOtherRenderer(const SceneFile& one, const SceneFile& other);

}  // namespace rivulet
