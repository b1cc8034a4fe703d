// Pictures of small scenes, drawn by the frame graph that users see: what it issues is watched for barriers (tests/barriers.h), judged by
// the driver's debug output and, under run.sh, by Vulkan's validation; and what it draws is what another OpenGL draws.
//   RIVULET_PICTURES_TO=FOLDER    writes each picture there
//   RIVULET_PICTURES_LIKE=FOLDER  compares each with that of another OpenGL, written before
#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <set>

#include "engine/app/capture.h"
#include "engine/gpu/debug.h"
#include "engine/gpu/device_gl.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/replay.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "tests/expected_renderer.h"
#include "tests/parity/devices.h"
#include "tests/races/small_worlds.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/host_water.h"

namespace rivulet::pictures_test {
namespace {

constexpr int kWidth = 96, kHeight = 64;
constexpr int kDrawn = 4;  // frames: what is kept from one to the next is used

struct Picture {
    const char* name;
    const char* scene;  // of assets/scenes, or "": a ball in a pool
    std::vector<std::string> set;
    int before = 0;                // frames that are stepped and not drawn
    const char* simulator = "gl";  // or "cpu"
    bool quick = false;            // drawn without RIVULET_RACES=full too
};
std::ostream& operator<<(std::ostream& to, const Picture& p) { return to << p.name; }

std::vector<std::string> with(std::vector<std::string> settings, const std::vector<std::string>& more) {
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
}
// Every step makes foam.
const std::vector<std::string> kFoams = {"fluid.foam.most=1500", "fluid.foam.trappedAir=4000", "fluid.foam.waveCrest=4000",
                                         "fluid.foam.airFrom=0", "fluid.foam.crestFrom=0",     "fluid.foam.speedFrom=0",
                                         "fluid.foam.airTo=0.2", "fluid.foam.crestTo=0.2",     "fluid.foam.speedTo=0.2"};
const std::vector<std::string> kDam = with({"fluid.spacing=0.04", "fluid.method=pbf"}, kFoams);

std::vector<Picture> pictures() {
    std::vector<Picture> all = {
        {"fine", "dam_break", with(kDam, {"look.quality=fine", "look.splats=ellipsoids"}), 2, "gl", true},
        {"fast", "dam_break", with(kDam, {"look.quality=fast"}), 2, "gl", true},
        {"simulated_by_the_cpu", "dam_break", with(kDam, {"look.splats=ellipsoids"}), 2, "cpu"},
        {"points", "dam_break", with(kDam, {"look.renderer=points", "look.colourBy=normal"}), 2},
        {"reference", "dam_break", {"fluid.spacing=0.06", "look.split=reference"}, 2},
        {"lens", "dam_break", {"fluid.spacing=0.06", "camera.aperture=2", "camera.bloom=0.5"}, 2},
        {"two_liquids", "oil_on_water", {"fluid.spacing=0.02", "emitters.0.start=0"}, 6},
        {"moving_solid", "paddle_wheel", {"fluid.spacing=0.06", "fluid.method=dfsph"}, 2},
        {"sheet", "waving_sheet", {"fluid.spacing=0.08", "colliders.0.resolution=24"}, 2},
        {"bodies", "rubber_ducks", {"fluid.spacing=0.08", "fluid.fixedStep=0.0041666"}, 2},
        {"wet_body", "", with({"fluid.wetness.on=true"}, kFoams), 6},
        {"sky", "fountain", {"fluid.spacing=0.03"}, 2},
        {"textures", "koi", {"fluid.spacing=0.05", "colliders.1.resolution=48"}, 2},
        {"glass", "glass", with({"fluid.spacing=0.006"}, kFoams), 8},
        {"window", "window_rain", {"flow.0.mapSize=256", "flow.0.sources.0.rate=3000000", "flow.0.sources.0.drop=30"}, 8},
        {"rain", "rain_on_spot", {"flow.0.mapSize=256", "flow.0.sources.0.rate=3000000", "flow.0.sources.0.drop=30"}, 12},
        {"shower", "shower", {"flow.0.mapSize=256", "fluid.spacing=0.01", "emitters.0.start=0"}, 12},
    };
    if (!races::full()) std::erase_if(all, [](const Picture& p) { return !p.quick; });
    return all;
}

// A ball with a dry hold bobs in a pool.
std::string ballInPool() {
    const std::string path = ::testing::TempDir() + "pictures_ball_in_pool.json";
    std::ofstream(path) << R"({"name": "ball_in_pool", "doc": "", "fluid": {"method": "pbf", "spacing": 0.12,
        "box": {"max": [1.6, 2, 1.6]}, "blocks": [{"max": [1.6, 0.64, 1.6]}]},
        "bodies": [{"shape": "sphere", "radius": 0.25, "density": 400, "position": [0.8, 0.72, 0.8], "velocity": [0, -1, 0]}],
        "dry": [{"position": [0.8, 0.72, 0.8], "size": [0.4, 0.3, 0.2], "body": 0}],
        "emitters": [{"position": [0.8, 1.2, 0.8], "radius": 0.2, "litresPerSecond": 20}],
        "camera": {"position": [2.4, 1.6, 2.6], "target": [0.8, 0.5, 0.8]}})";
    return path;
}

struct Difference {
    double mean = 0;     // of a channel, 0..255
    double changed = 0;  // share of pixels of which a channel differs by more than 8
};
Difference between(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    Difference d;
    if (a.size() != b.size() || a.empty()) return {255, 1};
    for (size_t at = 0; at < a.size(); at += 4) {
        int most = 0;
        for (size_t k = at; k < at + 3; ++k) {
            const int off = std::abs(int{a[k]} - int{b[k]});
            d.mean += off;
            most = std::max(most, off);
        }
        d.changed += most > 8 ? 1 : 0;
    }
    const double pixels = 0.25 * static_cast<double>(a.size());
    return {d.mean / (3 * pixels), d.changed / pixels};
}

// NaN becomes black in a picture.
void expectLit(const std::vector<uint8_t>& rgba) {
    ASSERT_EQ(rgba.size(), size_t{4} * kWidth * kHeight);
    double sum = 0, black = 0;
    for (size_t at = 0; at < rgba.size(); at += 4) {
        sum += (rgba[at] + rgba[at + 1] + rgba[at + 2]) / 3.0;
        black += rgba[at] < 2 && rgba[at + 1] < 2 && rgba[at + 2] < 2 ? 1 : 0;
    }
    const double pixels = double{kWidth} * kHeight;
    EXPECT_GT(sum / pixels, 20);
    EXPECT_LT(sum / pixels, 235);
    EXPECT_LT(black / pixels, 0.01) << "share of black pixels";
}

// Writes it, or compares it with what another OpenGL wrote.
void keepOrCompare(const std::string& name, const std::vector<uint8_t>& rgba) {
    if (const char* to = std::getenv("RIVULET_PICTURES_TO")) {
        const Status written = writePng(std::string(to) + "/" + name + ".png", rgba, kWidth, kHeight);
        EXPECT_TRUE(written) << (written ? "" : written.error().message);
    }
    const char* like = std::getenv("RIVULET_PICTURES_LIKE");
    if (like == nullptr) return;
    const std::string path = std::string(like) + "/" + name + ".png";
    int width = 0, height = 0, channels = 0;
    stbi_uc* loaded = stbi_load(path.c_str(), &width, &height, &channels, 4);
    ASSERT_NE(loaded, nullptr) << path << " is missing: write it with RIVULET_PICTURES_TO on another OpenGL first";
    const std::vector<uint8_t> other(loaded, loaded + size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height));
    stbi_image_free(loaded);
    const Difference d = between(rgba, other);
    std::printf("picture %s: %.3f of 255 from the other OpenGL's, %.2f %% of pixels differ\n", name.c_str(), d.mean, 100 * d.changed);
    EXPECT_LT(d.mean, 2) << path;
}

class Pictures : public ::testing::TestWithParam<Picture> {
  protected:
    static std::set<std::string> passes_;  // of all pictures
    static void TearDownTestSuite() {
        if (!passes_.empty()) std::printf("pictures: %zu passes\n", passes_.size());
    }
};
std::set<std::string> Pictures::passes_;

TEST_P(Pictures, AreDrawnByTheFrameGraph) {
    const Picture& p = GetParam();
    Result<ContextEgl> context = ContextEgl::create({.debug = true});
    if (!context && testing::mayLackOpenGl()) GTEST_SKIP() << context.error().message;
    ASSERT_TRUE(context) << context.error().message;
    expectRenderer(context->renderer());
    const gpu::DebugMessages messages(stderrLog(LogLevel::error));
    const ShaderFiles files = ShaderFiles::developer();
    const std::unique_ptr<Device> device = p.simulator == std::string("cpu") ? makeTestCpu() : makeGlDevice(files, {});
    const Result<SceneFile> scene = loadScene(*p.scene == 0 ? ballInPool() : p.scene, p.set);
    ASSERT_TRUE(scene) << scene.error().message;
    auto session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    const auto around = surroundingsOf(*scene);
    ASSERT_TRUE(around) << around.error().message;
    const auto renderer = SceneRenderer::create(files, *around ? &**around : nullptr);
    ASSERT_TRUE(renderer) << renderer.error().message;
    (*renderer)->describe(true);
    FluidUpload upload;
    const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, kWidth, kHeight, 0);
    const auto draw = [&](const FluidView& fluid) {
        const Status drawn = (*renderer)->draw(view, fluid, (*session)->solids(), (*session)->scene());
        EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message);
        if (!drawn) return std::vector<uint8_t>();
        for (const auto& pass : (*renderer)->description()->passes)
            if (!pass.culled) passes_.insert(pass.name);
        return (*renderer)->pixels();
    };
    std::vector<uint8_t> without = draw({}), last;
    FluidView fluid;
    for (int frame = 0; frame < p.before + kDrawn; ++frame) {
        (*session)->step(1.0 / 60, false);
        if (frame < p.before) continue;
        const Result<FluidView> shown = viewOf(upload, **session);
        ASSERT_TRUE(shown) << shown.error().message;
        fluid = *shown;
        EXPECT_TRUE((*session)->flows().draw());
        last = draw(fluid);
    }
    if (fluid.count > 0) without = draw({});
    expectLit(last);
    EXPECT_GT(between(last, without).changed, 0.01) << "neither water nor drops are seen";
    keepOrCompare(p.name, last);
    EXPECT_EQ(messages.errors(), 0) << messages.lastError();
    EXPECT_EQ(device->health().state, DeviceHealth::works) << device->health().why;
}
INSTANTIATE_TEST_SUITE_P(Scenes, Pictures, ::testing::ValuesIn(pictures()), [](const auto& row) { return std::string(row.param.name); });

// Drawn into a host's picture, in a scope that restores the host's state.
class PicturesOfHosts : public testing::HostWater {
  protected:
    PicturesOfHosts() : HostWater(4) {}
    void SetUp() override {
        HostWater::SetUp();
        if (context_) expectRenderer(context_->renderer());
    }
};
TEST_F(PicturesOfHosts, HaveTheWater) {
    testing::HostScene host(kWidth, kHeight);
    const auto pixels = [&] {
        const std::vector<vec4> all = host.pixels();
        std::vector<uint8_t> rgba;
        for (int y = kHeight - 1; y >= 0; --y)
            for (int x = 0; x < kWidth; ++x)
                for (int k = 0; k < 4; ++k) {
                    const float c = std::clamp(all[static_cast<size_t>(y * kWidth + x)][k], 0.0F, 1.0F);
                    rgba.push_back(k == 3 ? 255 : static_cast<uint8_t>(255 * c + 0.5F));
                }
        return rgba;
    };
    const std::vector<uint8_t> without = pixels();
    for (int frame = 0; frame < kDrawn; ++frame) {
        world_->step({}, 1.0 / 60);
        host.draw();
        const Status drawn = renderer_->draw(host.view(), testing::viewOf(*world_), {}, host.target());
        ASSERT_TRUE(drawn) << drawn.error().message;
    }
    const std::vector<uint8_t> last = pixels();
    expectLit(last);
    EXPECT_GT(between(last, without).changed, 0.05);
    keepOrCompare("host", last);
}

}  // namespace
}  // namespace rivulet::pictures_test
