#include "fluid/session/scene_opening.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <chrono>
#include <exception>
#include <utility>

#include "engine/core/exception_error.h"
#include "engine/gpu/device_gl.h"

namespace rivulet {

SceneOpening::SceneOpening(Request request) : request_(std::move(request)) {
    request_.device->stopOn(&givenUp_);
    thread_ = std::thread([this] {
        Result<OpenedScene> opened = failed("the OpenGL driver cannot make a context current on a second thread");
        if (request_.gl.enter()) {
            opened = work();
            glFinish();  // its objects are visible to the other context
            request_.gl.leave();
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        result_.emplace(std::move(opened));
        done_ = true;
        changed_.notify_all();
    });
}

SceneOpening::~SceneOpening() {
    giveUp();
    if (thread_.joinable()) (void)take();  // an unclaimed scene is destroyed in this context
}

Result<OpenedScene> SceneOpening::work() {
    const OpeningSteps steps = [this](const std::string& next, double share) {
        const std::lock_guard<std::mutex> lock(mutex_);
        step_ = {next, share};
        return !givenUp_.load();
    };
    try {
        OpenedScene opened;
        if (request_.renderer) {
            steps("surroundings", 0);
            const auto surroundings = surroundingsOf(request_.scene);
            if (!surroundings) return surroundings.error();
            auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr, request_.log);
            if (!renderer) return renderer.error();
            opened.renderer = std::move(*renderer);
        }
        auto session = openSession(request_.scene, *request_.device, request_.log, request_.backend, steps);
        if (!session) return session.error();
        if (givenUp_)  // its objects are destroyed in the context that made them
            return failed(fmt::format("opening {} was cancelled", request_.scene.name));
        opened.device = session->instead ? std::move(session->instead) : std::move(request_.device);
        opened.session = std::move(session->session);
        return opened;
    } catch (const std::bad_alloc&) {
        return failed(request_.scene.name + ": the computer has not enough memory for it");
    } catch (...) {  // on this thread nothing else handles it
        return errorOf(std::current_exception());
    }
}

bool SceneOpening::ready(double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return done_; });
}

Result<OpenedScene> SceneOpening::take() {
    thread_.join();
    Result<OpenedScene> opened = std::move(*result_);
    if (opened) opened->device->stopOn(nullptr);
    if (opened && opened->renderer) opened->renderer->contextChanged();
    if (opened && opened->device->backend() == Backend::gl) contextChanged(*opened->device);
    return opened;
}

void SceneOpening::giveUp() { givenUp_ = true; }

SceneOpening::Step SceneOpening::step() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return step_;
}

bool needsOtherRenderer(const SceneFile& one, const SceneFile& other) {
    const BackgroundParams &a = one.background, &b = other.background;
    if (a.surroundings != b.surroundings || a.sky != b.sky) return true;
    if (!a.surroundings.empty()) return a.surroundingsLevel != b.surroundingsLevel || one.folder != other.folder;
    const LightParams &sun = one.light, &then = other.light;
    return a.sky != "studio" && (a.clouds != b.clouds || a.horizon != b.horizon || a.zenith != b.zenith || a.floor != b.floor ||
                                 sun.direction != then.direction || sun.colour != then.colour || sun.intensity != then.intensity);
}

}  // namespace rivulet
