#include "tests/golden/look_fixture.h"

#include <stb/stb_image.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "engine/app/capture.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet {

void TestParticles::findEllipsoids() {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    const std::unique_ptr<Device> device = makeCpuDevice(rows, {});
    Result<HostEllipsoids> found = ellipsoidsOf(*device, position, spacing);
    ASSERT_TRUE(found) << found.error().message;
    ellipsoids = std::move(*found);
}

std::optional<ContextEgl> LookTest::context_;
std::optional<gpu::DebugMessages> LookTest::messages_;
std::unique_ptr<SceneRenderer> LookTest::renderer_;

void LookTest::SetUpTestSuite() {
    Result<ContextEgl> context = ContextEgl::create({.debug = true});
    if (!context) return;
    context_ = std::move(*context);
    messages_.emplace(stderrLog(LogLevel::error));
    Result<std::unique_ptr<SceneRenderer>> made = SceneRenderer::create(ShaderFiles::developer());
    ASSERT_TRUE(made) << made.error().message;
    renderer_ = std::move(*made);
}

void LookTest::TearDownTestSuite() {
    renderer_.reset();
    messages_.reset();
    context_.reset();
}

void LookTest::SetUp() {
    if (!context_) GTEST_SKIP() << "no OpenGL 4.5 here";
    ASSERT_TRUE(renderer_);
    // A dyed liquid: clear water before a grey studio would hide much of what these tests look for.
    settings.look.absorption = vec3(4.5F, 1.1F, 0.5F);
    settings.look.scattering = vec3(0.05F, 0.30F, 0.27F);
}

void LookTest::TearDown() {
    if (messages_) EXPECT_EQ(messages_->errors(), 0) << messages_->lastError();
}

bool LookTest::onLlvmpipe() { return context_ && context_->renderer().find("llvmpipe") != std::string::npos; }

FluidView LookTest::upload(const TestParticles& particles) {
    FluidView view;
    view.count = static_cast<uint32_t>(particles.position.size());
    view.spacing = particles.spacing;
    view.radius = 0.6F * particles.spacing;
    if (view.count == 0) return view;
    std::vector<vec4> velocity;
    std::vector<uint32_t> id;
    for (uint32_t i = 0; i < view.count; ++i) {
        velocity.emplace_back(0.1F * static_cast<float>(i % 30), 0.0F, 0.0F, 0.0F);
        id.push_back(i);
    }
    position_ = std::move(*gpu::Buffer::from(particles.position));
    velocity_ = std::move(*gpu::Buffer::from(velocity));
    id_ = std::move(*gpu::Buffer::from(id));
    view.position = position_.name();
    for (size_t k = 0; k < 3 && !particles.ellipsoids[0].empty(); ++k) {
        ellipsoids_[k] = std::move(*gpu::Buffer::from(particles.ellipsoids[k]));
        view.ellipsoids[k] = ellipsoids_[k].name();
    }
    view.velocity = velocity_.name();
    view.id = id_.name();
    return view;
}

std::vector<uint8_t> LookTest::picture(const Camera& camera, int width, int height, const FluidView& fluid) {
    const Status drawn = renderer_->draw(frameViewOf(camera, settings.light, width, height, 0), fluid, scene, settings);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message);
    return renderer_->pixels();
}

void LookTest::compareWith(const std::string& name, int width, int height, const std::vector<uint8_t>& rgba, double tolerance) {
    const std::string path = std::string(RIVULET_SOURCE_DIR) + "/tests/golden/" + name + ".png";
    if (std::getenv("RIVULET_UPDATE_GOLDEN") != nullptr) {
        const Status written = writePng(path, rgba, width, height);
        ASSERT_TRUE(written) << written.error().message;
        return;
    }
    if (!onLlvmpipe()) GTEST_SKIP() << "the committed pictures are llvmpipe's";
    int loadedWidth = 0, loadedHeight = 0, channels = 0;
    stbi_uc* loaded = stbi_load(path.c_str(), &loadedWidth, &loadedHeight, &channels, 4);
    ASSERT_NE(loaded, nullptr) << path << ": make it with RIVULET_UPDATE_GOLDEN=1 and look at it";
    const std::vector<uint8_t> golden(loaded, loaded + static_cast<size_t>(loadedWidth) * static_cast<size_t>(loadedHeight) * 4);
    stbi_image_free(loaded);
    ASSERT_EQ(loadedWidth, width);
    ASSERT_EQ(loadedHeight, height);
    const double error = meanAbsoluteError(rgba, golden);
    if (error >= tolerance) (void)writePng((std::filesystem::temp_directory_path() / (name + "_now.png")).string(), rgba, width, height);
    EXPECT_LT(error, tolerance) << "the picture changed: look at " << name
                                << "_now.png in the temporary folder; if it is better, RIVULET_UPDATE_GOLDEN=1";
}

void LookPassesTest::SetUp() {
    LookTest::SetUp();
    if (IsSkipped()) return;
    Result<FluidPrograms> made = FluidPrograms::create(ShaderFiles::developer());
    ASSERT_TRUE(made) << made.error().message;
    programs = std::move(*made);
}

double meanAbsoluteError(std::span<const uint8_t> a, std::span<const uint8_t> b) {
    if (a.size() != b.size() || a.empty()) return 255;
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += std::abs(int{a[i]} - int{b[i]});
    return sum / static_cast<double>(a.size());
}

}  // namespace rivulet
