// What the picture tests share: a GL context, a renderer, sets of particles that need no simulator.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>

#include "engine/app/context_egl.h"
#include "engine/gpu/debug.h"
#include "fluid/render/renderers.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

struct TestParticles {
    std::vector<vec4> position;  // w = density / rest density
    float spacing = 0.02F;
    std::array<std::vector<vec4>, 3> ellipsoids;  // centre, spread, slant; empty: spheres
    void add(const vec3& p, float density = 1.0F) { position.emplace_back(p, density); }
    void findEllipsoids();  // as a world would
};

// One context and one renderer for all tests of a program; tests skip where there is no OpenGL 4.5.
class LookTest : public ::testing::Test {
  protected:
    static void SetUpTestSuite();
    static void TearDownTestSuite();
    void SetUp() override;
    void TearDown() override;  // no test may leave a GL error

    // The particles as GL buffers, drawn with radius 0.6 spacings; valid until the next call.
    FluidView upload(const TestParticles& particles);
    // Top row first, RGBA8.
    std::vector<uint8_t> picture(const Camera& camera, int width, int height, const FluidView& fluid);
    // Against tests/golden/NAME.png, which RIVULET_UPDATE_GOLDEN=1 writes anew. `tolerance`: of the mean difference, 0..255.
    static void compareWith(const std::string& name, int width, int height, const std::vector<uint8_t>& rgba, double tolerance = 1.0);
    SceneRenderer& renderer() { return *renderer_; }
    static bool onLlvmpipe();

    Scene scene;
    SceneFile settings;

  private:
    static std::optional<ContextEgl> context_;
    static std::optional<gpu::DebugMessages> messages_;
    static std::unique_ptr<SceneRenderer> renderer_;
    gpu::Buffer position_, velocity_, id_;
    std::array<gpu::Buffer, 3> ellipsoids_;
};

// The same with the programs of the fluid's passes, for tests that add passes themselves.
class LookPassesTest : public LookTest {
  protected:
    void SetUp() override;

    FluidPrograms programs;
    gpu::TransientPool pool;
};

// 0..255 a channel.
double meanAbsoluteError(std::span<const uint8_t> a, std::span<const uint8_t> b);

// The same numbers on every machine.
class TestRandom {
  public:
    float uniform() {  // 0..1
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<float>(state_ >> 40U) / 16777216.0F;
    }
    vec3 inCube() { return vec3(uniform(), uniform(), uniform()) * 2.0F - 1.0F; }

  private:
    uint64_t state_ = 42;
};

}  // namespace rivulet
