// What waits for the GPU in a frame on backends gl and cl: docs/how_it_works.md lists it, and nothing else does.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/compute/device_cl.h"
#include "engine/gpu/device_gl.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/late_view.h"
#include "fluid/session/replay.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "tests/unit/cl_waits.h"
#include "tests/unit/gl_waits.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::waits_test {
namespace {

using Calls = std::map<std::string, size_t>;

// A ball in the middle of a pool: it bobs, or is dropped from there. `carries`: a volume that stays dry, into which it rains.
std::string ballInPool(float y, bool carries) {
    const std::string path = ::testing::TempDir() + "waits_ball_in_pool.json";
    const std::string more = R"(, "dry": [{"position": [0.8, )" + std::to_string(y) + R"(, 0.8], "size": [0.4, 0.2, 0.1], "body": 0}],
        "emitters": [{"position": [0.8, )" +
                             std::to_string(y + 0.25F) + R"(, 0.8], "radius": 0.2, "litresPerSecond": 20}])";
    std::ofstream(path) << R"({"name": "ball_in_pool", "doc": "", "fluid": {"method": "pbf", "spacing": 0.08,
        "box": {"max": [1.6, 2, 1.6]}, "blocks": [{"max": [1.6, 0.64, 1.6]}]},
        "bodies": [{"shape": "sphere", "radius": 0.12, "density": 400, "position": [0.8, )"
                        << y << R"(, 0.8]}])" << (carries ? more : "") << "}";
    return path;
}

struct Case {
    const char* scene;
    std::vector<std::string> set;
    int from = 3;        // frames until memory has grown to what the scene needs, and until what is to be seen happens
    bool lands = false;  // drops land in the frames that count
    float ballAt = 0;    // m: instead of `scene`, ballInPool()
    bool held = false;   // a hand draws the first body through the water
    bool carries = false;
};

const Case kRain{"rain_on_spot", {"flow.0.mapSize=256"}, 12, true};
const Case kShower{"shower", {"flow.0.mapSize=256", "fluid.spacing=0.01", "emitters.0.start=0"}, 18, true};
const Case kBobs{"", {}, 3, false, 0.72F};
const Case kWetBall{"", {"fluid.wetness.on=true"}, 3, false, 0.72F};
const Case kHeld{.scene = "", .set = {}, .ballAt = 0.72F, .held = true};
const Case kCarries{.scene = "", .set = {}, .ballAt = 0.72F, .carries = true};
const Case kDropped{"", {}, 15, false, 1.26F};  // 0.5 m above the water: it hits it in frame 19
// A head that speaks in the rain.
const Case kCrying{"crying", {"flow.0.mapSize=256", "flow.0.sources.3.rate=60000"}, 12, true};

const Case kDucks{"rubber_ducks", {"fluid.spacing=0.08", "fluid.fixedStep=0.0041666"}};

constexpr int kFrames = 10;  // that count

// Keeps a device one to two frames behind, as a GPU is, without a call that waits: what is known late stays late.
class Behind {
  public:
    explicit Behind(Device& device) : device_(&device) {
        Result<Buffer> made = device.allocate(sizeof(uint32_t));
        EXPECT_TRUE(made) << made.error().message;
        if (!made) return;
        mark_ = std::move(*made);
        device.fill(mark_, 0);
    }
    void frameEnds() {
        ++frames_;
        device_->readLater(mark_, sizeof(uint32_t), [arrived = arrived_](std::span<const std::byte>) { ++*arrived; });
        for (int k = 0; k < 30000 && *arrived_ + 1 < frames_; ++k) {
            device_->poll();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_GE(*arrived_ + 1, frames_);
    }

  private:
    Device* device_;
    Buffer mark_;
    size_t frames_ = 0;
    std::shared_ptr<size_t> arrived_ = std::make_shared<size_t>(0);
};

// What waits in kFrames, drawn. `bodyWaits`: FluidStats::bodyWaits in these.
Calls waitsOf(const Case& c, const ShaderFiles& files, Device& device, uint64_t& bodyWaits) {
    const Result<SceneFile> scene = loadScene(
        *c.scene == 0 ? ballInPool(c.ballAt, c.carries) : RIVULET_SOURCE_DIR "/assets/scenes/" + std::string(c.scene) + ".json", c.set);
    EXPECT_TRUE(scene) << scene.error().message;
    if (!scene) return {};
    auto session = Session::create(*scene, device, {});
    EXPECT_TRUE(session) << session.error().message;
    const auto renderer = SceneRenderer::create(files);
    EXPECT_TRUE(renderer) << renderer.error().message;
    if (!session || !renderer) return {};
    FluidUpload upload;
    LateView late;
    Behind behind(device);
    const auto before = std::make_shared<double>(0);  // m^3, on skins
    const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, 64, 48, 0);
    for (int frame = 0; frame < c.from + kFrames; ++frame) {
        if (frame == c.from) {
            if (!(*session)->flows().empty())
                (*session)->flows().ledgerLater([before](const SkinFlows::Ledger& l) { *before = l.onSurface; });
            bodyWaits = (*session)->world().stats().bodyWaits;
            device.takeTimes();
            testing::startGlWaits();
            testing::startClWaits();
        }
        if (c.held)
            (*session)->hold(BodyPull{
                .body = 0, .at = vec3(0.06F, 0.06F, 0), .to = vec3(0.8F + 0.3F * std::sin(0.4F * static_cast<float>(frame)), 0.6F, 0.8F)});
        (*session)->step(1.0 / 60, false);
        LateView::Shown shown{{}, &(*session)->solids(), 0};
        if (LateView::suits(**session)) {  // as a window does
            const auto arrived = late.show(upload, **session);
            EXPECT_TRUE(arrived) << arrived.error().message;
            if (!arrived) return {};
            shown = *arrived;
        } else {
            const auto fluid = viewOf(upload, **session);
            EXPECT_TRUE(fluid) << fluid.error().message;
            if (!fluid) return {};
            shown.fluid = *fluid;
        }
        EXPECT_TRUE((*session)->flows().draw());
        EXPECT_TRUE((*renderer)->draw(view, shown.fluid, *shown.solids, (*session)->scene()));
        behind.frameEnds();
    }
    Calls waits = testing::clWaits();
    waits.merge(testing::glWaits());
    bodyWaits = (*session)->world().stats().bodyWaits - bodyWaits;
    device.finish();
    device.poll();
    if (!(*session)->flows().empty()) {
        const SkinFlows::Ledger ledger = (*session)->flows().ledger();
        EXPECT_EQ(ledger.error, 0);
        if (c.lands) {
            EXPECT_GT(ledger.onSurface, *before);
        }
    }
    return waits;
}

class Waits : public ::testing::Test {
  protected:
    void SetUp() override {
        context_.emplace(ContextEgl::create({}));
        if (!*context_ && testing::mayLackOpenGl()) GTEST_SKIP() << context_->error().message;
        ASSERT_TRUE(*context_) << context_->error().message;
        ASSERT_TRUE(gpu::load(testing::waitsFind));
    }
    const ShaderFiles files_ = ShaderFiles::developer();

  private:
    std::optional<Result<ContextEgl>> context_;
};

// What the shim must see, and what it must not take for a wait.
TEST_F(Waits, CallsThatWaitAreCounted) {
    const GLbitfield reads = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT;
    GLuint buffer = 0, queries[2] = {};
    GLuint64 ns = 0;
    glCreateBuffers(1, &buffer);
    glGenQueries(2, queries);
    testing::startGlWaits();
    glNamedBufferStorage(buffer, 64, nullptr, reads);
    glMapNamedBufferRange(buffer, 0, 64, reads);
    EXPECT_TRUE(testing::glWaits().empty()) << "no command uses the buffer yet";
    glUnmapNamedBuffer(buffer);
    glMapNamedBufferRange(buffer, 0, 64, reads);
    glUnmapNamedBuffer(buffer);
    EXPECT_EQ(testing::glWaits(), (Calls{{"glMapNamedBufferRange", 1}}));

    testing::startGlWaits();
    for (const GLuint query : queries) glQueryCounter(query, GL_TIMESTAMP);
    GLuint there = GL_FALSE;
    while (there == GL_FALSE) glGetQueryObjectuiv(queries[1], GL_QUERY_RESULT_AVAILABLE, &there);
    for (const GLuint query : queries) glGetQueryObjectui64v(query, GL_QUERY_RESULT, &ns);
    EXPECT_TRUE(testing::glWaits().empty()) << "of two timestamps the second is available";
    glQueryCounter(queries[0], GL_TIMESTAMP);
    glGetQueryObjectui64v(queries[0], GL_QUERY_RESULT, &ns);
    EXPECT_EQ(testing::glWaits(), (Calls{{"glGetQueryObjectui64v", 1}}));

    testing::startGlWaits();
    glFinish();
    EXPECT_EQ(testing::glWaits(), (Calls{{"glFinish", 1}}));
    glDeleteQueries(2, queries);
    glDeleteBuffers(1, &buffer);
}

// A GPU waits for no frame of these: particles of all methods with foam, moving and deforming solids, drops and wetness on skins, rain on
// them, a ball that bobs, also with a wet surface, falls into a pool, is drawn through it by a hand or carries a dry volume into which it
// rains, ducks that touch each other and the walls.
TEST_F(Waits, FramesWaitForWhatTheTableNamesAlone) {
    for (const Case& c : {Case{"dam_break", {"fluid.spacing=0.08", "fluid.method=pbf", "fluid.foam.most=500"}},
                          Case{"paddle_wheel", {"fluid.spacing=0.08", "fluid.method=dfsph"}}, Case{"waving_sheet", {"fluid.spacing=0.08"}},
                          Case{"cold_bottle", {}}, kRain, kShower, kCrying, kBobs, kWetBall, kHeld, kCarries, kDropped, kDucks}) {
        SCOPED_TRACE(::testing::Message() << c.scene << c.ballAt << (c.held ? " held" : c.carries ? " carries" : ""));
        const std::unique_ptr<Device> device = makeGlDevice(files_, {});
        uint64_t bodyWaits = 0;
        const Calls waits = waitsOf(c, files_, *device, bodyWaits);
        EXPECT_EQ(bodyWaits, 0U);
        for (const auto& [call, count] : waits) ADD_FAILURE() << count << " calls of " << call << " wait in " << kFrames << " frames";
    }
}

// The same on OpenCL, as a window draws it.
TEST_F(Waits, FramesOnOpenClWaitForWhatTheTableNamesAlone) {
    for (const Case& c : {Case{"dam_break", {"fluid.spacing=0.08", "fluid.method=pbf", "fluid.foam.most=500"}}, kRain, kShower, kCrying,
                          kBobs, kWetBall, kHeld, kCarries, kDropped, kDucks}) {
        SCOPED_TRACE(::testing::Message() << c.scene << c.ballAt << (c.held ? " held" : c.carries ? " carries" : ""));
        Result<std::unique_ptr<Device>> device = makeClDevice(files_);
        if (!device && testing::mayLackOpenGl()) GTEST_SKIP() << device.error().message;
        ASSERT_TRUE(device) << device.error().message;
        uint64_t bodyWaits = 0;
        const Calls waits = waitsOf(c, files_, **device, bodyWaits);
        EXPECT_EQ(bodyWaits, 0U);
        for (const auto& [call, count] : waits) ADD_FAILURE() << count << " calls of " << call << " wait in " << kFrames << " frames";
    }
}

}  // namespace
}  // namespace rivulet::waits_test
