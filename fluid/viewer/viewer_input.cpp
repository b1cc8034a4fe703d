// Viewer: keys, the mouse and dropped files.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "fluid/viewer/viewer.h"

namespace rivulet {

void Viewer::takeKeys(const InputEvents& input) {
    if (input.pressed(key::kEscape)) {  // closes the topmost window, too
        if (waiting_)
            refuse({}, Cause::edit, std::exchange(waiting_, std::nullopt)->before);
        else if (save_.shown())
            save_.show(false);
        else if (browser_.shown())
            browser_.show(false);
        else
            showHelp_ = false;
    }
    for (const Command command : commandsOf(input, ui_.wantsKeyboard())) run(command);
}

void Viewer::run(Command command) {
    constexpr float kZoom = 1.25F;
    switch (command) {
        case Command::pause:
            return run_.pause(!run_.paused());
        case Command::step:
            return run_.stepOnce();
        case Command::restart:
            report(recording_.end(log_));
            return session().reset();
        case Command::pour:
            return turnBrush();
        case Command::panels:
            showPanels_ = !showPanels_;
            return hand_.choose({});
        case Command::help:
            showHelp_ = !showHelp_;
            return;
        case Command::scenes:
            return browser_.show(!browser_.shown());
        case Command::release:
            brush_.turn(false);
            return hand_.choose({});
        case Command::undo:
            return undo();
        case Command::enlarge:
            return ui_.enlarge(kZoom);
        case Command::shrink:
            return ui_.enlarge(1 / kZoom);
        case Command::usualSize:
            return ui_.enlarge(0);
        case Command::save:
            return save_.show(true);
        case Command::find:
            showPanels_ = draft_.params.find = true;
            return;
        case Command::video:
            return report(capture_.toggleVideo(renderer(), draft_.scene.name, log_));
        case Command::picture:
            return report(capture_.takePicture(renderer(), draft_.scene.name, log_));
        case Command::record:
            return report(recording_.toggle(session(), log_));
        case Command::measure:
            return watch_.toggle();
        case Command::none:
            return;
    }
}

// A recording that was opened with --replay is already shown.
void Viewer::replay(size_t frame, bool runs) {
    report(settle());
    if (session().replaying() == nullptr) {
        Result<Replay> opened = Replay::open(recording_.path(), session().scene(), log_);
        if (!opened) return report(opened.error());
        if (Status shown = session().replay(std::move(*opened)); !shown) return report(shown);
    }
    session().seek(frame);
    run_.stepOnce();
    if (runs) run_.pause(false);
}

void Viewer::simulate() {
    report(settle());
    session().endReplay();
    message_.clear();
}

void Viewer::undo() {
    if (Manipulator::Asks asks; hand_.undo(draft_.scene, asks)) {
        edited_ = true;
        anew_ = anew_ || asks.recreate;
    } else if (left_) {
        open(*std::exchange(left_, std::nullopt));
    }
}

// At the first use the world is created again, with the same water.
void Viewer::turnBrush() {
    const SceneFile& scene = draft_.scene;
    if (!brush_.on() && !scene.flow.empty() && scene.fluid.blocks.empty() && scene.emitters.empty()) {
        message_ = "this scene has water on its skin only: click the skin to add a drop";
        return;
    }
    if (session().replaying() != nullptr) {
        message_ = kReplayed;
        return;
    }
    brush_.turn(!brush_.on());
    if (!brush_.on() || scene.pour.litres > 0) return;
    draft_.scene.pour.litres = litresToPour(scene.fluid, session().world().particles().count);
    anew_ = true;
}

bool Viewer::handle(const InputEvents& input) {
    if (input.size.x <= 0 || input.size.y <= 0) return false;
    if (tearPoints_.take(input, cameraOf(draft_.scene.camera, session().bounds()), session(), draft_.scene, edited_)) return true;
    const Manipulator::Asks asks = hand_.take(input, cameraOf(draft_.scene.camera, session().bounds()), session(), draft_.scene);
    edited_ = edited_ || asks.edited;
    anew_ = anew_ || asks.recreate;
    return asks.mouse;
}

void Viewer::takeMouse(const InputEvents& input, bool greets) {
    const Camera camera = cameraOf(draft_.scene.camera, session().bounds());
    const bool pours = !greets && brush_.take(input, camera, session(), ui_.wantsMouse());
    brush_.draw(input, camera, session());
    if (brush_.pours() && opening() == nullptr && session().world().stats().particles >= session().world().particles().count)
        message_ = fmt::format("all {} litres of pour.litres are poured; raise pour.litres to pour more", draft_.scene.pour.litres);
    if (!greets && !pours && (!ui_.wantsMouse() || hand_.holds() || tearPoints_.holds()) && !handle(input)) {
        edited_ = moveCamera(input, session().bounds(), draft_.scene.camera) || edited_;
        skinClick_.take(input, draft_.scene.camera, session());
    }
    hand_.draw(input, camera, session(), draft_.scene);
    if (!greets && !ui_.wantsMouse()) tearPoints_.draw(input, camera, session());
}

// A scene is opened, a picture of light surrounds this one, and any other file is a mesh that stands in the middle of the box.
void Viewer::takeDropped(const InputEvents& input) {
    if (input.dropped.empty()) return;
    if (session().replaying() != nullptr) {
        message_ = kReplayed;
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
            message_ = fmt::format("{} is a scene: drop it without other files", std::filesystem::path(*at).filename().string());
            return;
        }
        Result<SceneFile> scene = loadScene(*at, {});
        if (scene) return open(std::move(*scene));
        message_ = scene.error().message;
        return;
    }
    for (const std::string& path : input.dropped) {
        if (kindOf(path) == ".hdr") {
            draft_.scene.background.surroundings = path;
            continue;
        }
        const BoxParams& box = draft_.scene.fluid.box;
        const vec3 size = box.max - box.min;
        ColliderParams& collider = draft_.scene.colliders.emplace_back();
        collider.mesh = path;
        collider.fitSize = 0.5F * std::min({size.x, size.y, size.z});
        collider.position = vec3(0.5F * (box.min.x + box.max.x), box.min.y + 0.5F * collider.fitSize, 0.5F * (box.min.z + box.max.z));
    }
    takeEdits(true);
    draft_.params.compare(visiting(draft_.scene));
}

}  // namespace rivulet
