// A person at a Viewer: a framebuffer to look at, and the InputEvents of a mouse and a keyboard.
#pragma once

#include <imgui.h>
#include <imgui_internal.h>

#include <cctype>
#include <chrono>
#include <cstdlib>
#include <initializer_list>
#include <memory>
#include <string_view>

#include "fluid/viewer/viewer.h"
#include "tests/unit/framebuffer_fixture.h"

namespace rivulet::testing {

class ViewerFixture : public FramebufferFixture {
  protected:
    // `window`, `pixels`: as open(). Few pixels, for the sake of machines without a GPU.
    void begin(const SceneFile& scene, const ivec2& window, const ivec2& pixels, const ViewerOptions& options = {.backend = "cpu"}) {
        if (!context_) open(window, pixels);
        ASSERT_TRUE(context_ && target_.name() != 0);
        auto viewer = Viewer::create(scene, options, {});
        ASSERT_TRUE(viewer) << viewer.error().message;
        viewer_ = std::move(*viewer);
    }
    void TearDown() override {
        FramebufferFixture::TearDown();
        viewer_.reset();
    }

    // One frame of the input so far, by default of usual_ seconds.
    void frame() { frame(usual_); }
    void frame(double seconds) {
        const Status drawn = viewer_->frame(input_, seconds, target_.name());
        ASSERT_TRUE(drawn) << drawn.error().message;
        endFrame();
    }
    void key(int which) {
        input_.keysPressed = {which};
        frame();
    }
    // A key that widgets, too, take.
    void hit(int which) {
        input_.keysPressed = input_.keysDown = {which};
        frame();
        input_.keysDown.clear();
        frame();
    }
    void withControl(int which) {
        input_.keysDown = {key::kLeftControl};
        key(which);
        input_.keysDown.clear();
        frame();
    }
    void type(std::string_view text) {
        for (const char c : text) {
            input_.text = c;
            frame();
        }
    }
    void moveTo(vec2 place) { moveTo(place, usual_); }
    void moveTo(vec2 place, double seconds) {
        input_.mouseDelta = place - input_.mouse;
        input_.mouse = place;
        frame(seconds);
    }
    void press(bool down, MouseButton button = MouseButton::left) { press(down, button, usual_); }
    void press(bool down, MouseButton button, double seconds) {
        const auto k = static_cast<int>(button);
        (down ? input_.buttonPressed : input_.buttonReleased)[k] = true;
        input_.buttonDown[k] = down;
        frame(seconds);
    }
    void click(MouseButton button = MouseButton::left) {
        press(true, button);
        press(false, button);
        frame();
    }
    // After the widget has received the mouse position.
    void clickAt(vec2 place) {
        moveTo(place);
        frame();
        click();
    }
    // Moves the mouse over the widget of these names ("#2": a number) in the windows whose names hold `window`: looks for it row by row,
    // as a person does.
    bool hover(std::string_view window, std::initializer_list<const char*> names) {
        for (ImGuiWindow* each : ImGui::GetCurrentContext()->Windows) {
            if (!each->WasActive || std::string_view(each->Name).find(window) == std::string_view::npos) continue;
            ImGuiID id = each->ID;
            for (const char* name : names) {
                const int number = name[0] == '#' && std::isdigit(name[1]) != 0 ? std::atoi(name + 1) : -1;
                id = number >= 0 ? ImHashData(&number, sizeof number, id) : ImHashStr(name, 0, id);
            }
            const ImRect inside = each->InnerRect;
            const float across = inside.GetWidth(), scale = static_cast<float>(input_.size.x) / ImGui::GetIO().DisplaySize.x;
            for (const float x : {14.0F, 0.35F * across, 0.6F * across, 0.92F * across})
                for (float y = inside.Min.y + 4; y < inside.Max.y; y += 6) {
                    moveTo(scale * vec2(inside.Min.x + x, y));
                    frame();
                    if (ImGui::GetCurrentContext()->HoveredIdPreviousFrame == id) return true;
                }
        }
        return false;
    }
    // Whether there is a window of this name to be seen.
    static bool shows(const char* name) {
        const ImGuiWindow* window = ImGui::FindWindowByName(name);
        return window != nullptr && window->Active;
    }
    // How many frames were shown until nothing is being opened any more.
    int settle() {
        int frames = 0;
        for (const auto from = std::chrono::steady_clock::now(); viewer_->opening() != nullptr; ++frames) {
            frame();
            if (std::chrono::steady_clock::now() - from > std::chrono::minutes(3)) {
                ADD_FAILURE() << "it is never ready";
                break;
            }
        }
        return frames;
    }

    std::unique_ptr<Viewer> viewer_;
    double usual_ = 0;
};

}  // namespace rivulet::testing
