// CPU time of the window without a simulation: a frame of an empty scene, and its panels with one tab open after the other.
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include "demos/rivulet/bench_cases.h"
#include "engine/app/context_egl.h"
#include "engine/core/thread_clock.h"
#include "engine/gpu/framebuffer.h"
#include "fluid/viewer/viewer.h"

namespace rivulet {

Status benchUi(const BenchContext& context) {
    Result<ContextEgl> egl = ContextEgl::create();
    if (!egl) {
        context.log.notice("the case ui needs OpenGL, which is not available: it is skipped");
        return ok();
    }
    // Few pixels, because software renderers draw them on the CPU; the panels are laid out as in a window of 1280 x 720.
    constexpr int kWidth = 64, kHeight = 36, kFrames = 60, kFilled = 620;
    Result<gpu::Texture> colour = gpu::Texture::create({.width = kWidth, .height = kHeight});
    if (!colour) return colour.error();
    const gpu::Framebuffer target(*colour, nullptr);
    InputEvents input;
    input.size = ivec2(1280, 720);
    input.mouse = vec2(-100);

    for (const bool water : {false, true}) {
        SceneFile scene;
        scene.fluid.spacing = 0.05F;
        if (water) scene.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.4F)}};
        Result<std::unique_ptr<Viewer>> opened = Viewer::create(scene, {.backend = "cpu"}, {});
        if (!opened) return opened.error();
        Viewer& viewer = **opened;
        Status wrong = ok();
        double layoutMs = 0, drawMs = 0;
        const auto frame = [&](double seconds) {
            glFinish();  // a software renderer uses the same cores
            const double start = threadSeconds();
            if (Status drawn = viewer.frame(input, seconds, target.name()); !drawn) wrong = drawn;
            input.keysPressed.clear();
            layoutMs += viewer.panelCost().made;
            drawMs += viewer.panelCost().drawn;
            return 1000 * (threadSeconds() - start);
        };
        const auto whole = [&](double seconds) {
            double sum = 0;
            for (int k = 0; k < kFrames; ++k) sum += frame(seconds);
            return sum / kFrames;
        };
        constexpr double kStep = 1.0 / 60;
        const char* of = water ? "512 particles" : "empty scene";
        if (!water) {
            constexpr int kTab = 258;  // GLFW_KEY_TAB: hides the panels
            input.keysPressed = {kTab};
            frame(0);
            context.report({.name = "ui: a frame, empty scene, not drawn, no panels",
                            .unit = "ms",
                            .value = repeat(context, [&] { return whole(kStep); }),
                            .passes = {}});
            input.framebuffer = ivec2(kWidth, kHeight);
            context.report({.name = "ui: a frame, empty scene, drawn, no panels",
                            .unit = "ms",
                            .value = repeat(context, [&] { return whole(kStep); }),
                            .passes = {}});
            input.keysPressed = {kTab};
            frame(0);
        }
        input.framebuffer = ivec2(0);
        for (int k = 0; water && k < kFilled; ++k) frame(kStep);  // fills the graphs with samples
        input.framebuffer = ivec2(kWidth, kHeight);
        constexpr std::pair<Inspector::Tab, const char*> kTabs[] = {{Inspector::Tab::times, "times"},
                                                                    {Inspector::Tab::graphs, "graphs"},
                                                                    {Inspector::Tab::chart, "chart"},
                                                                    {Inspector::Tab::frameGraph, "frame graph"},
                                                                    {Inspector::Tab::voxels, "voxels"}};
        for (const auto& [tab, name] : kTabs) {
            viewer.watch().show(tab);
            for (int k = 0; k < 8; ++k) frame(0);
            const Spread spread = repeat(context, [&] {
                layoutMs = drawMs = 0;
                whole(kStep);
                return (layoutMs + drawMs) / kFrames;
            });
            context.report({.name = fmt::format("ui: panels, {} open, {}", name, of),
                            .unit = "ms",
                            .value = spread,
                            .passes = {{"layout", layoutMs / kFrames}, {"OpenGL calls", drawMs / kFrames}}});
        }
        if (!wrong) return wrong;
    }
    return ok();
}

}  // namespace rivulet
