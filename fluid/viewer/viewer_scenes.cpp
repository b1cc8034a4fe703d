// Viewer: edits, changed files, and other scenes.
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "fluid/session/cpu_fallback.h"
#include "fluid/viewer/viewer.h"

namespace rivulet {

// An edit that is not valid is refused with a sentence, and the last valid scene stays.
void Viewer::takeEdits(bool recreate) {
    Status sense = checkScene(draft_.scene);
    if (!sense && !recreate) {
        message_ = sense.error().message;  // a drag may pass through it: the draft stays as it is
        SceneFile seen = scene();
        seen.camera = draft_.scene.camera;
        session().apply(seen);
        return;
    }
    recreate = recreate || (!opener_.edits() && session().needsNew(draft_.scene));
    if (recreate && session().replaying() != nullptr) {
        message_ = kReplayed;
        session().apply(draft_.settled);
        draft_.scene = scene();
        return;
    }
    if (!recreate) {
        message_.clear();
        session().apply(draft_.scene);
        if (session().budget()) draft_.scene.fluid = scene().fluid;  // what a budget holds, an edit does not change
        return;
    }
    if (sense)
        startOpening(draft_.scene, Cause::edit);
    else
        refuse(sense.error(), Cause::edit, draft_.settled);
}

// Live values are applied to the running session.
void Viewer::takeWritten(double seconds) {
    std::optional<SceneFile> written = reload_.look(seconds, draft_.scene, picture_.renderer(), run_.device());
    if (!written) return;
    SceneFile now = scene();
    if (session().budget()) now.fluid = reload_.before().fluid;  // what a budget has picked
    const bool same = fixedValues(visiting(*written)) == fixedValues(visiting(now)) && !session().needsNew(*written);
    if (!same && session().replaying() != nullptr) return reload_.refuse(kReplayed);
    if (!same) {
        draft_.scene.camera = written->camera;
        return startOpening(std::move(*written), Cause::written);
    }
    session().apply(*written);
    draft_.scene = draft_.settled = scene();
    message_.clear();
    rememberOpened(true);
}

// `written`: a reset returns to the content of the file, not to the shown scene, which may have been edited.
void Viewer::rememberOpened(bool written) { draft_.remember(written ? reload_.opened() : draft_.scene, session().budget().has_value()); }

void Viewer::refuse(const Error& error, Cause cause, const SceneFile& before) {
    if (cause == Cause::written) return reload_.refuse(error.message);
    message_ = error.message;
    if (cause == Cause::otherScene) return;
    SceneFile back = before;  // a drag has gone through it
    back.camera = draft_.scene.camera;
    session().apply(back);
    draft_.scene = scene();
    if (draft_.scene.pour.litres <= 0) brush_.turn(false);
}

void Viewer::startOpening(SceneFile scene, Cause cause) {
    const bool accepted = std::exchange(accepted_, false);
    if (cause != Cause::otherScene) scene.room = std::max(scene.room, session().world().particles().count);
    notices_->clear();
    message_.clear();
    const SceneFile before = opener_.edits() ? opener_.work()->before : waiting_ ? waiting_->before : draft_.settled;
    waiting_.reset();
    opener_.giveUp();
    const bool renderer = needsOtherRenderer(this->scene(), scene);
    const std::string asked = cause == Cause::edit ? "cpu" : asked_;
    std::string trouble;
    const bool aside = opener_.aside(&trouble);
    if (!trouble.empty()) log_.notice(trouble + ": the window waits while a scene is opened");
    if (aside) {
        opener_.start(std::move(scene), cause, before, run_.device().backend(), asked, renderer);
        constexpr double kAtOnce = 0.05;  // s: too short to be seen
        if (opener_.ready(kAtOnce)) finishOpening();
        return;
    }
    OpenedScene opened;
    if (renderer) {
        const auto surroundings = surroundingsOf(scene);
        if (!surroundings) return refuse(surroundings.error(), cause, before);
        auto made = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr, log_);
        if (!made) return refuse(made.error(), cause, before);
        opened.renderer = std::move(*made);
    }
    Result<OpenedSession> fresh = openSession(scene, run_.device(), log_, asked);
    if (!fresh) return refuse(fresh.error(), cause, before);
    opened.session = std::move(fresh->session);
    opened.device = std::move(fresh->instead);
    if (cause == Cause::edit && !accepted && tooExpensive(opened, scene, before)) {
        if (waiting_) waiting_->opened = {};  // it is on the device that goes on stepping, which may be lost meanwhile
        return;
    }
    adopt(std::move(opened), cause);
}

void Viewer::finishOpening() {
    SceneOpener::Work done = opener_.take();
    Result<OpenedScene> opened = done.opening->take();
    if (!opened) return refuse(opened.error(), done.cause, done.before);
    if (done.cause != Cause::edit) return adopt(std::move(*opened), done.cause);
    if (!tooExpensive(*opened, done.opening->scene(), done.before)) adoptEdit(std::move(*opened), done.opening->scene());
}

// Meanwhile the camera may have moved, or a slider.
void Viewer::adoptEdit(OpenedScene opened, SceneFile made) {
    const SceneFile wanted = draft_.scene;
    adopt(std::move(opened), Cause::edit);
    SceneFile now = wanted;
    const bool same = fixedValues(visiting(made)) == fixedValues(visiting(now)) && !session().needsNew(wanted);
    if (same) session().apply(wanted);
    draft_.scene = same ? scene() : wanted;
    if (!same) startOpening(wanted, Cause::edit);
}

double Viewer::costOf(const Session& next) const {
    const uint32_t now = session().world().particles().count, then = next.world().particles().count;
    const double ms = stepMs_, finer = session().world().params().spacing / next.world().params().spacing;
    if (now == 0 || then <= now || !(ms > 0)) return 0;
    return 1.0e-3 * ms * then / now * std::max(finer, 1.0);
}

// Whether the edit is not adopted now: it is refused, because it would freeze the window, or waits for a yes.
bool Viewer::tooExpensive(OpenedScene& opened, const SceneFile& made, const SceneFile& before) {
    const double seconds = costOf(*opened.session);
    if (seconds < std::min(askStep_, longestStep_)) return false;
    const uint32_t particles = opened.session->world().particles().count;
    if (seconds >= longestStep_) {
        const std::string why = fmt::format(
            "{} particles would take about {:.0f} s a frame here: this would freeze the window; change refused; run the scene with --set "
            "instead",
            particles, seconds);
        refuse(failed(why), Cause::edit, before);
        return true;
    }
    std::string sentence = fmt::format("This change makes {} particles: a frame would take about {:.1f} s here, instead of {:.2f} s.",
                                       particles, seconds, 1.0e-3 * stepMs_);
    waiting_.emplace(Waiting{std::move(opened), made, before, std::move(sentence)});
    return true;
}

void Viewer::giveUpOpening() {
    const bool edit = opener_.edits();
    const SceneFile before = opener_.work()->before;
    opener_.giveUp();
    if (edit) refuse({}, Cause::edit, before);
}

// The old session is destroyed only now. An edit of the objects in the water keeps the water.
void Viewer::adopt(OpenedScene opened, Cause cause) {
    const bool other = cause == Cause::otherScene;
    const Status recorded = recording_.end(log_);
    recording_.forget();
    waiting_.reset();
    run_.drop();
    if (!other && Session::sameWater(scene(), opened.session->scene()))
        if (Status gone = opened.session->continueFrom(session()); !gone) log_.notice(gone.error().message);
    hand_.release();
    tearPoints_.release();
    if (other) {
        if (draft_.edited(session().budget().has_value())) {
            left_ = draft_.scene;
            log_.notice(fmt::format("{} has unsaved changes: Ctrl+Z returns to it", draft_.scene.name));
        }
        save_.forgetPath();  // or it would be offered for the next scene
        run_.pause(false);
    }
    if (cause != Cause::edit) {
        hand_ = {};
        brush_ = {};
    }
    run_.adopt(std::move(opened.session), std::move(opened.device));
    if (opened.renderer) picture_.adopt(std::move(opened.renderer), run_.timeline());
    const CameraParams camera = draft_.scene.camera;
    draft_.scene = scene();  // a budget may have picked
    if (cause == Cause::written) {
        draft_.scene.camera = camera;  // it may have moved meanwhile
        session().apply(draft_.scene);
    } else if (other) {
        reload_.follow(draft_.scene);
    }
    draft_.settled = draft_.scene;
    if (cause != Cause::edit) rememberOpened(cause == Cause::written);
    if (draft_.scene.pour.litres <= 0) brush_.turn(false);
    message_.clear();
    report(recorded);
    profiler_.clear();
    stepMs_ = 0;
    watch_.clear();
    if (run_.endOnStepped()) log_.notice("the recording ends here: it cannot go on with another scene or with new water");
}

Result<OpenedScene> Viewer::openShowing(const SceneFile& scene, const ViewerOptions& options, const std::string& backend,
                                        std::unique_ptr<Device> device) {
    bool goesOn = true;
    auto last = std::chrono::steady_clock::now();
    return opener_.openFirst(scene, std::move(device), backend, [&](const SceneOpening& work) {
        const bool open = options.showing([&](const InputEvents& input, GLuint framebuffer) {
            const auto now = std::chrono::steady_clock::now();
            ui_.begin(input, std::chrono::duration<double>(now - last).count());
            last = now;
            glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
            glViewport(0, 0, input.framebuffer.x, input.framebuffer.y);
            glClearColor(0.055F, 0.07F, 0.085F, 1);
            glClear(GL_COLOR_BUFFER_BIT);
            if (SceneOpener::drawProgress(work, 0.5F, 0)) goesOn = false;
            ui_.draw(framebuffer, input.framebuffer.x, input.framebuffer.y);
        });
        return open && goesOn;
    });
}

}  // namespace rivulet
