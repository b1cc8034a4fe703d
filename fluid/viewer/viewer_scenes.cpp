// How a Viewer comes from one scene to the next: edits, files that were written, dropped or chosen; and how a scene is saved.
#include "fluid/viewer/viewer.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "engine/core/json.h"
#include "engine/ui/style.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

namespace {

// As a shell would have it: ~ is the person's own folder.
std::string fullPath(const std::string& typed) {
    const char* home = std::getenv("HOME");
    const bool own = home != nullptr && (typed == "~" || typed.starts_with("~/"));
    return own ? home + typed.substr(1) : typed;
}

}  // namespace

// An edit that makes no sense is refused with a sentence, and the last good scene stays.
void Viewer::takeEdits(bool recreate) {
    Status sense = checkScene(draft_);
    if (!sense && !recreate) {
        message_ = sense.error().message;  // a drag may pass through it: the draft stays as it is
        SceneFile seen = session_->scene();
        seen.camera = draft_.camera;
        session_->apply(seen);
        return;
    }
    recreate = recreate || (!(opening_ && !opening_->other) && session_->needsNew(draft_));
    if (recreate && session_->replaying() != nullptr) {
        message_ = "replaying: this was settled when the run was recorded; run the scene without --replay to change it";
        session_->apply(settled_);
        draft_ = session_->scene();
        return;
    }
    if (!recreate) {
        message_.clear();
        session_->apply(draft_);
        if (session_->budget()) draft_.fluid = session_->scene().fluid;  // what a budget holds, an edit does not change
        return;
    }
    if (sense)
        startOpening(draft_, false);
    else
        refuse(sense.error(), false, settled_);
}

// What is only live is taken as it runs.
void Viewer::takeWritten(double seconds) {
    std::optional<SceneFile> written = reload_.look(seconds, draft_, *renderer_, *device_);
    if (!written) return;
    SceneFile now = session_->scene();
    if (session_->budget()) now.fluid = reload_.before().fluid;  // what a budget has picked
    const bool same = fixedValues(visiting(*written)) == fixedValues(visiting(now)) && !session_->needsNew(*written);
    if (!same && session_->replaying() != nullptr)
        return reload_.refuse("replaying: what was written needs a new run, and this one shows what was recorded");
    if (!same) {
        draft_.camera = written->camera;
        return startOpening(std::move(*written), true, true);
    }
    session_->apply(*written);
    draft_ = settled_ = session_->scene();
    message_.clear();
    rememberOpened(true);
}

// What of a scene is a person's to lose: not the view, and not what a budget picks.
std::string Viewer::madeOf(SceneFile scene) const {
    scene.camera = {};
    if (session_->budget()) scene.fluid = {};
    return writeJson(visiting(scene));
}

// What a reset goes back to. `written`: the file says it, not what is shown, which a person may have edited.
void Viewer::rememberOpened(bool written) {
    SceneFile none, opened = written ? reload_.opened() : draft_;
    if (session_->budget()) opened.fluid = draft_.fluid;  // what it picks
    params_.open(visiting(opened), visiting(none));
    params_.compare(visiting(draft_));
    openedText_ = madeOf(opened);
}

void Viewer::refuse(const Error& error, bool other, const SceneFile& before) {
    if (std::exchange(reopening_, false)) return reload_.refuse(error.message);
    message_ = error.message;
    if (other) return;
    SceneFile back = before;  // a drag has gone through it
    back.camera = draft_.camera;
    session_->apply(back);
    draft_ = session_->scene();
    if (draft_.pour.litres <= 0) brush_.turn(false);
}

void Viewer::startOpening(SceneFile scene, bool other, bool written) {
    reopening_ = written;
    if (!other || written) scene.room = std::max(scene.room, session_->world().particles().count);
    notices_->clear();
    message_.clear();
    const SceneFile before = opening_ && !opening_->other ? opening_->before : settled_;
    if (opening_) {
        opening_->work->giveUp();
        givenUp_.push_back(std::move(opening_->work));
        opening_.reset();
    }
    const Backend backend = device_->backend();
    if (share_ && !elsewhere_) {
        if (Result<SharedGl> made = share_())
            elsewhere_ = std::move(*made);
        else
            log_.notice(made.error().message + ": the window waits while a scene is opened");
        share_ = {};
    }
    const std::string asked = other ? asked_ : "cpu";
    if (elsewhere_) {
        const bool renderer = needsOtherRenderer(session_->scene(), scene);
        opening_ = std::make_unique<Opening>();
        opening_->other = other;
        opening_->before = before;
        opening_->work =
            std::make_unique<SceneOpening>(SceneOpening::Request{.scene = std::move(scene),
                                                                 .device = makeDevice(backendName(backend), gl_, log_, clDevice_),
                                                                 .backend = asked,
                                                                 .renderer = renderer,
                                                                 .gl = elsewhere_,
                                                                 .log = log_});
        constexpr double kAtOnce = 0.05;  // s: nobody sees that the window waited
        if (opening_->work->ready(kAtOnce)) finishOpening();
        return;
    }
    OpenedScene opened;
    if (needsOtherRenderer(session_->scene(), scene)) {
        const auto surroundings = surroundingsOf(scene);
        if (!surroundings) return refuse(surroundings.error(), other, before);
        auto renderer = SceneRenderer::create(ShaderFiles::developer(), *surroundings ? &**surroundings : nullptr);
        if (!renderer) return refuse(renderer.error(), other, before);
        opened.renderer = std::move(*renderer);
    }
    Result<OpenedSession> fresh = openSession(scene, *device_, log_, asked);
    if (!fresh) return refuse(fresh.error(), other, before);
    if (Status soon = other ? ok() : showsSoon(*fresh->session); !soon) return refuse(soon.error(), false, before);
    opened.session = std::move(fresh->session);
    opened.device = std::move(fresh->instead);
    adopt(std::move(opened), other);
}

void Viewer::finishOpening() {
    Opening done = std::move(*opening_);
    opening_.reset();
    Result<OpenedScene> opened = done.work->take();
    if (!opened) return refuse(opened.error(), done.other, done.before);
    const SceneFile wanted = draft_;
    if (Status soon = done.other ? ok() : showsSoon(*opened->session); !soon) return refuse(soon.error(), false, done.before);
    adopt(std::move(*opened), done.other);
    if (done.other) return;
    // Meanwhile the camera may have moved, or a slider.
    SceneFile made = done.work->scene(), now = wanted;
    const bool same = fixedValues(visiting(made)) == fixedValues(visiting(now)) && !session_->needsNew(wanted);
    if (same) session_->apply(wanted);
    draft_ = same ? session_->scene() : wanted;
    if (!same) startOpening(wanted, false);
}

// Error (failed): after this edit the window would stand still, by what a particle and step take now.
Status Viewer::showsSoon(const Session& next) const {
    const uint32_t now = session_->world().particles().count, then = next.world().particles().count;
    const double ms = profiler_.mean("simulate"), finer = session_->scene().fluid.spacing / next.scene().fluid.spacing;
    if (now == 0 || then <= now || !(ms > 0)) return ok();
    const double seconds = 1.0e-3 * ms * then / now * std::max(finer, 1.0);
    if (seconds < longestStep_) return ok();
    return failed(
        fmt::format("{} particles would take some {:.0f} s a picture here, and the window would stand still: it is not done; run "
                    "the scene with --set for that",
                    then, seconds));
}

void Viewer::giveUpOpening() {
    Opening left = std::move(*opening_);
    opening_.reset();
    left.work->giveUp();
    if (!left.other) refuse({}, false, left.before);
    givenUp_.push_back(std::move(left.work));
}

// What it replaces goes only now. An edit of what is in the water leaves the water as it is.
void Viewer::adopt(OpenedScene opened, bool other) {
    work_.reset();
    if ((!other || reopening_) && Session::sameWater(session_->scene(), opened.session->scene()))
        if (Status gone = opened.session->goOnFrom(*session_); !gone) log_.notice(gone.error().message);
    hand_.letGo();
    if (other && !reopening_) {
        if (madeOf(draft_) != openedText_) {
            left_ = draft_;
            log_.notice(fmt::format("{} was changed and not saved: control Z brings it back", draft_.name));
        }
        savePath_.clear();  // or it would be offered for the next scene
        paused_ = false;
    }
    if (other) hand_ = {};
    if (other) brush_ = {};
    session_ = std::move(opened.session);
    if (opened.device) {  // nothing is on the other any more
        device_ = std::move(opened.device);
        traceKernels(*device_, timeline_);
    }
    if (opened.renderer) {
        renderer_ = std::move(opened.renderer);
        renderer_->onSpan(timeline_.lane(kDrawingLane));
        renderer_->hurry(adaptiveQuality_.fast());
    }
    begin();
    const CameraParams camera = draft_.camera;
    draft_ = session_->scene();  // a budget may have picked
    const bool written = std::exchange(reopening_, false);
    if (written) {
        draft_.camera = camera;  // it may have moved meanwhile
        session_->apply(draft_);
    } else if (other) {
        reload_.follow(draft_);
    }
    settled_ = draft_;
    if (other) rememberOpened(written);
    if (draft_.pour.litres <= 0) brush_.turn(false);
    repicked_ = 0;
    message_.clear();
    profiler_.clear();
    watch_.clear();
    if (recorder_) record();
    if (told_) {
        told_ = {};
        log_.notice("what is recorded ends here: another scene, or an edit that needs new water, is no part of it");
    }
}

bool Viewer::drawProgress(const SceneOpening& work, float height) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const SceneOpening::Step step = work.step();
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, height * display.y), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::SetNextWindowBgAlpha(1);  // a panel may lie under it
    ImGui::Begin(
        "opening", nullptr,
        ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());  // without the focus, which a person may need elsewhere
    ImGui::Text("%s: %s", work.scene().name.c_str(), step.what.c_str());
    ImGui::ProgressBar(static_cast<float>(step.share), ImVec2(ImGui::GetFontSize() * 20, 0));
    ImGui::SameLine();
    const bool cancel = ImGui::Button("cancel");
    ImGui::End();
    return cancel;
}

// Over the picture, low in its middle.
void Viewer::drawOpening() {
    if (drawProgress(*opening_->work, 0.86F)) giveUpOpening();
}

Result<OpenedScene> Viewer::openShowing(const SceneFile& scene, const ViewerOptions& options, const std::string& backend) {
    SceneOpening work({.scene = scene, .device = std::move(device_), .backend = backend, .renderer = true, .gl = elsewhere_, .log = log_});
    bool goesOn = true;
    auto last = std::chrono::steady_clock::now();
    constexpr double kPicture = 0.05;  // s: the machine has better things to do
    while (!work.ready(kPicture)) {
        const bool open = options.showing([&](const InputEvents& input, GLuint framebuffer) {
            const auto now = std::chrono::steady_clock::now();
            ui_.begin(input, std::chrono::duration<double>(now - last).count());
            last = now;
            glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
            glViewport(0, 0, input.framebuffer.x, input.framebuffer.y);
            glClearColor(0.055F, 0.07F, 0.085F, 1);
            glClear(GL_COLOR_BUFFER_BIT);
            if (drawProgress(work, 0.5F)) goesOn = false;
            ui_.draw();
        });
        if (!open || !goesOn) return failed(fmt::format("opening {} was cancelled", scene.name));
    }
    return work.take();
}

// A scene is opened, a picture of light surrounds this one, and any other file is a mesh that stands in the middle of the box.
void Viewer::takeDropped(const InputEvents& input) {
    if (input.dropped.empty()) return;
    if (session_->replaying() != nullptr) {
        message_ = "replaying: what was recorded is shown; run the scene without --replay to change it";
        return;
    }
    const auto kindOf = [](const std::string& path) {
        std::string kind = std::filesystem::path(path).extension().string();
        for (char& c : kind) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return kind;
    };
    const auto isScene = [&](const std::string& path) { return kindOf(path) == ".json"; };
    if (const auto at = std::find_if(input.dropped.begin(), input.dropped.end(), isScene); at != input.dropped.end()) {
        if (input.dropped.size() > 1) {
            message_ =
                fmt::format("{} is a scene: drop it alone, or the other files alone", std::filesystem::path(*at).filename().string());
            return;
        }
        Result<SceneFile> scene = loadScene(*at, {});
        if (scene) return open(std::move(*scene));
        message_ = scene.error().message;
        return;
    }
    for (const std::string& path : input.dropped) {
        if (kindOf(path) == ".hdr") {
            draft_.background.surroundings = path;
            continue;
        }
        const BoxParams& box = draft_.fluid.box;
        const vec3 size = box.max - box.min;
        ColliderParams& collider = draft_.colliders.emplace_back();
        collider.mesh = path;
        collider.fitSize = 0.5F * std::min({size.x, size.y, size.z});
        collider.position = vec3(0.5F * (box.min.x + box.max.x), box.min.y + 0.5F * collider.fitSize, 0.5F * (box.min.z + box.max.z));
    }
    takeEdits(true);
    params_.compare(visiting(draft_));
}

// Low in the middle, for who has hidden the panels.
void Viewer::drawSaid(double seconds) {
    std::string now = message_;
    for (const std::string& notice : notices_->all()) now += (now.empty() ? "" : "\n") + notice;
    constexpr double kReading = 12;  // s
    saidFor_ = now == std::exchange(said_, now) ? saidFor_ + seconds : 0;
    if (now.empty() || saidFor_ > kReading || !reload_.message().empty()) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, 0.94F * display.y), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
    ImGui::Begin("said", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::PushTextWrapPos(std::min(0.8F * display.x, 40 * ImGui::GetFontSize()));
    ImGui::TextUnformatted(now.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

void Viewer::drawSaving() {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (savePath_.empty()) savePath_ = fileName(draft_.name) + ".json";
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
    ImGui::Begin("save the scene", &saving_, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 28);
    if (ImGui::IsWindowAppearing()) saveTrouble_.clear();
    if (ImGui::IsWindowAppearing() || refocus_) ImGui::SetKeyboardFocusHere();
    refocus_ = false;
    const bool entered = ImGui::InputText("##path", &savePath_, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemEdited()) saveTrouble_.clear();
    std::string path = fullPath(savePath_);
    if (!path.empty() && std::filesystem::path(path).extension() != ".json") path += ".json";  // by which a scene is known
    std::error_code error;
    const bool there = std::filesystem::exists(path, error);
    const bool pressed = ImGui::Button(there ? "write over it###write" : "save###write");
    ImGui::SameLine();
    if (ImGui::Button("cancel")) saving_ = false;
    if (there) {
        ImGui::SameLine();
        ImGui::TextDisabled("a file of this name is there");
    }
    if (!saveTrouble_.empty()) {
        ImGui::PushTextWrapPos(ImGui::GetFontSize() * 28);
        ImGui::TextColored(refusedColour(), "%s", saveTrouble_.c_str());
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
    if (entered && there) refocus_ = true;
    // Enter alone does not write over a file.
    if (!(pressed || (entered && !there)) || savePath_.empty()) return;
    SceneFile scene = draft_;
    if (Status saved = saveScene(scene, path); !saved) {
        saveTrouble_ = saved.error().message;
        refocus_ = true;
        return;
    }
    savePath_ = path;
    openedText_ = madeOf(draft_);
    saving_ = false;
    if (std::filesystem::equivalent(savePath_, draft_.source.path, error)) {  // from now on the file alone says what the scene is
        draft_.source = {draft_.source.path, {}, {}};
        reload_.follow(draft_);
    }
    log_.notice(fmt::format("the scene is in {}", std::filesystem::absolute(savePath_, error).string()));
}

void Viewer::chooseScene() {
    const std::optional<std::string> path = browser_.draw();
    if (!path) return;
    if (session_->replaying() != nullptr) return browser_.refuse("replaying: what was recorded is shown; run the scene without --replay");
    Result<SceneFile> scene = loadScene(fullPath(*path), {});
    if (!scene) return browser_.refuse(scene.error().message);
    browser_.show(false);
    open(std::move(*scene));
}

}  // namespace rivulet
