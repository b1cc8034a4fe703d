#include <algorithm>
#include <array>
#include <string>

#include "engine/core/timeline.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/program.h"
#include "fluid/validate/gpu_rates.h"

namespace rivulet {

namespace {

constexpr int kDraws = 7;           // the fastest counts: other work on the machine only adds time
constexpr int kLeastTarget = 1024;  // pixels: where memory does not suffice, targets are halved down to this
constexpr int kPassesEach = 4;
constexpr int kFewReads = 8, kManyReads = 16;

// A fragment shader that covers a target, and reads a texture as large.
struct Draw {
    gpu::Program program;
    gpu::Format source;

    static Result<Draw> create(int reads, bool filtered) {
        Result<gpu::Program> made =
            gpu::Program::create(ShaderFiles::developer(), {"shaders/render/fullscreen.vert", "shaders/bench/rate_draw.frag"},
                                 {{"READS", std::to_string(reads)}, {"FILTERED", filtered ? "1" : "0"}});
        if (!made) return made.error();
        return Draw{std::move(*made), filtered ? gpu::Format::rgba16f : gpu::Format::r32f};
    }
    // s for a fragment; `size`: of the target's edge. Past `until` it is drawn only once more.
    Result<double> seconds(Device& device, gpu::TransientPool& pool, int size, double until) {
        gpu::TextureDesc desc{.width = size, .height = size, .format = source};
        Result<gpu::Texture> from = gpu::Texture::create(desc);
        if (!from) return from.error();
        from->clear(vec4(1.0F));
        double least = 1.0e9;
        for (int run = 0; run <= kDraws && (run < 2 || hostSeconds() < until); ++run) {  // the first warms up
            gpu::FrameGraph graph(pool);
            const gpu::TextureHandle read = graph.importTexture("source", *from);
            const gpu::TextureHandle to = graph.texture("target", {.width = size, .height = size, .format = gpu::Format::rgba16f});
            for (int k = 0; k < kPassesEach; ++k)
                graph.pass("draw", {read}, {to}, [&](gpu::PassContext& c) {
                    c.drawTo({to});
                    program.use();
                    program.texture("source", 0, c.texture(read));
                    c.drawFullscreen();
                });
            graph.output(to);
            device.finish();
            const double start = deviceSeconds(device);
            if (Status drawn = graph.execute(); !drawn) return drawn.error();
            device.finish();
            if (run > 0) least = std::min(least, deviceSeconds(device) - start);
        }
        return least / kPassesEach / (double{1} * size * size);
    }
};

}  // namespace

Result<bool> measureDrawing(Device& device, DeviceRates& rates, double until) {
    int size = device.info().software ? kLeastTarget : 4096;
    const auto timed = [&](int reads, bool filtered) -> Result<double> {
        Result<Draw> draw = Draw::create(reads, filtered);
        if (!draw) return draw.error();
        for (;; size /= 2) {
            gpu::TransientPool pool;
            Result<double> seconds = draw->seconds(device, pool, size, until);
            if (seconds || !seconds.error().memory || size <= kLeastTarget) return seconds;
        }
    };
    const Result<double> plain = timed(0, true);
    if (!plain) return plain.error();
    rates.fragments = 1 / *plain;
    for (const bool filtered : {true, false}) {
        if (hostSeconds() >= until) return false;
        const Result<double> few = timed(kFewReads, filtered);
        if (!few) return few.error();
        if (hostSeconds() >= until) return false;
        const Result<double> many = timed(kManyReads, filtered);
        if (!many) return many.error();
        // Other work on the machine may hide the difference.
        const double read = std::max((*many - *few) / (kManyReads - kFewReads), 0.1 * *many / kManyReads);
        (filtered ? rates.filtered : rates.fetches) = 1 / read;
    }
    return true;
}

}  // namespace rivulet
