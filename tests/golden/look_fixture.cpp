#include "tests/golden/look_fixture.h"

#include <cmath>

namespace rivulet {

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
    view.velocity = velocity_.name();
    view.id = id_.name();
    return view;
}

std::vector<uint8_t> LookTest::picture(const Camera& camera, int width, int height, const FluidView& fluid) {
    const Status drawn = renderer_->draw(frameViewOf(camera, settings.light, width, height, 0), fluid, scene, settings);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message);
    return renderer_->pixels();
}

double meanAbsoluteError(std::span<const uint8_t> a, std::span<const uint8_t> b) {
    if (a.size() != b.size() || a.empty()) return 255;
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += std::abs(int{a[i]} - int{b[i]});
    return sum / static_cast<double>(a.size());
}

}  // namespace rivulet
