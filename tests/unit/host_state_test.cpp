// HostState restores a host's OpenGL state exactly, for many different states.
#include "engine/gpu/host_state.h"

#include <EGL/egl.h>
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "engine/app/context_egl.h"
#include "engine/gpu/device_gl.h"
#include "engine/gpu/load.h"
#include "fluid/render/renderers.h"
#include "fluid/render/water_renderer.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/unit/gl_snapshot.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/host_water.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::host_state_test {
namespace {

using testing::difference;
using testing::GlSnapshot;
using testing::glSnapshot;

struct Host {
    bool old, odd;  // a compatibility context; a host that left nothing at its default
};
class HostStateIn : public ::testing::TestWithParam<Host> {};

GLuint textureOf(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    return name;
}
GLuint bufferOf(GLsizeiptr bytes) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    glNamedBufferData(name, bytes, nullptr, GL_STATIC_DRAW);
    return name;
}

// A host that left nothing at its default.
void makeOdd(bool old) {
    for (const GLenum what :
         {GL_DEPTH_TEST, GL_DEPTH_CLAMP, GL_CULL_FACE, GL_STENCIL_TEST, GL_PROGRAM_POINT_SIZE, GL_POLYGON_OFFSET_FILL, GL_POLYGON_SMOOTH,
          GL_LINE_SMOOTH, GL_FRAMEBUFFER_SRGB, GL_COLOR_LOGIC_OP, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK,
          GL_PRIMITIVE_RESTART, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE5, GL_TEXTURE_CUBE_MAP_SEAMLESS, GL_RASTERIZER_DISCARD})
        glEnable(what);
    if (old) glEnable(0x0B10);  // GL_POINT_SMOOTH
    glDisable(GL_DITHER);
    glDisable(GL_MULTISAMPLE);
    glEnablei(GL_BLEND, 1);
    glEnablei(GL_SCISSOR_TEST, 2);
    glBlendFuncSeparatei(0, GL_DST_COLOR, GL_SRC_ALPHA, GL_ONE_MINUS_DST_ALPHA, GL_CONSTANT_COLOR);
    glBlendFunci(3, GL_SRC_ALPHA, GL_ONE);
    glBlendEquationSeparatei(0, GL_MAX, GL_FUNC_REVERSE_SUBTRACT);
    glBlendColor(0.1F, 0.2F, 0.3F, 0.4F);
    glColorMaski(0, GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
    glColorMaski(2, GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_FALSE);
    glDepthRange(0.25, 0.75);
    glDepthRangeIndexed(3, 1.0, 0.0);
    glStencilFunc(GL_LEQUAL, 3, 0x5A);
    glStencilMask(0x33);
    glStencilOp(GL_INCR, GL_DECR, GL_INVERT);
    glCullFace(GL_FRONT_AND_BACK);
    glFrontFace(GL_CW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glPolygonOffset(1.5F, 2.5F);
    glLineWidth(1.0F);
    glPointSize(3.0F);
    glLogicOp(GL_XOR);
    glClearColor(0.4F, 0.3F, 0.2F, 0.1F);
    glClearDepth(0.3);
    glClearStencil(7);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    glPrimitiveRestartIndex(99);
    glSampleCoverage(0.5F, GL_TRUE);
    glSampleMaski(0, 0xF0F0F0F0U);
    glMinSampleShading(0.5F);
    glClampColor(GL_CLAMP_READ_COLOR, GL_FALSE);
    glHint(GL_FRAGMENT_SHADER_DERIVATIVE_HINT, GL_NICEST);
    for (GLuint k = 0; k < 4; ++k) {
        glViewportIndexedf(k, 1.0F + static_cast<float>(k), 2, 30, 20);
        glScissorIndexed(k, static_cast<GLint>(k), 5, 7, 9);
    }
    for (const GLenum pack : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS, GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT,
                              GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES})
        glPixelStorei(pack, 3);
    glPixelStorei(GL_UNPACK_SWAP_BYTES, GL_TRUE);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
    GLuint array = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    for (const GLenum target :
         {GL_ARRAY_BUFFER, GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER, GL_DRAW_INDIRECT_BUFFER,
          GL_DISPATCH_INDIRECT_BUFFER, GL_ELEMENT_ARRAY_BUFFER, GL_TEXTURE_BUFFER, GL_UNIFORM_BUFFER, GL_SHADER_STORAGE_BUFFER})
        glBindBuffer(target, bufferOf(256));
    for (GLuint k = 0; k < 6; ++k) {
        glBindBufferRange(GL_UNIFORM_BUFFER, k, bufferOf(1024), 256, 64);
        if (k == 3)
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, k, bufferOf(64));
        else
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, k, bufferOf(1024), 256, 128);
    }
    for (const GLuint unit : {0U, 1U, 5U, 16U, 17U, 25U, 40U}) {
        glActiveTexture(GL_TEXTURE0 + unit);
        for (const GLenum target : {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_3D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_CUBE_MAP,
                                    GL_TEXTURE_BUFFER, GL_TEXTURE_RECTANGLE, GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_CUBE_MAP_ARRAY})
            glBindTexture(target, textureOf(target));
        GLuint sampler = 0;
        glCreateSamplers(1, &sampler);
        glBindSampler(unit, sampler);
    }
    const GLuint image = textureOf(GL_TEXTURE_2D_ARRAY);
    glTextureStorage3D(image, 2, GL_R32UI, 4, 4, 3);
    glBindImageTexture(2, image, 1, GL_FALSE, 2, GL_READ_WRITE, GL_R32UI);
    glActiveTexture(GL_TEXTURE7);
    GLuint query = 0;
    glGenQueries(1, &query);
    if (old) {
        glEnable(0x0BC0);  // GL_ALPHA_TEST
        glEnable(0x0B42);  // GL_POLYGON_STIPPLE
        glPolygonMode(GL_FRONT, GL_POINT);
        for (const GLenum what : {0x0D14U, 0x0D18U, 0x0D1AU, 0x0D1CU, 0x0D1EU}) gpu::pixelTransfer()(what, 0.25F);  // GL_RED_SCALE and on
        for (const GLenum what : {0x0D15U, 0x0D19U, 0x0D1BU, 0x0D1DU, 0x0D1FU}) gpu::pixelTransfer()(what, 0.125F);
    }
    ASSERT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << "the test itself is wrong";
}

TEST_P(HostStateIn, IsPutBackToTheBit) {
    Result<ContextEgl> context = ContextEgl::create({.compatibility = GetParam().old});
    if (!context) {
        ASSERT_TRUE(testing::mayLackOpenGl()) << context.error().message;
        GTEST_SKIP() << context.error().message;
    }
    ASSERT_TRUE(gpu::load(eglGetProcAddress));
    testing::HostScene host(80, 60);
    if (GetParam().odd) makeOdd(GetParam().old);
    ASSERT_FALSE(HasFatalFailure());
    const GlSnapshot before = glSnapshot();
    EXPECT_GT(before.size(), 700U);
    {
        const gpu::HostState keep;
        const gpu::HostState again(gpu::HostState::everything);
        GLint on = glIsEnabled(GL_RASTERIZER_DISCARD);
        EXPECT_EQ(on, GL_FALSE);
        if (GetParam().old) {
            GLfloat scale = 0, bias = 1;
            glGetFloatv(0x0D14, &scale);  // GL_RED_SCALE
            glGetFloatv(0x0D15, &bias);
            EXPECT_TRUE(scale == 1 && bias == 0) << "pictures would be made with the host's scale";
        }
    }
    EXPECT_EQ(difference(before, glSnapshot()), "");

    // Any changes inside the scope.
    auto renderer = WaterRenderer::create({});
    ASSERT_TRUE(renderer) << renderer.error().message;
    EXPECT_EQ(difference(before, glSnapshot()), "") << "create()";
    {
        const std::unique_ptr<Device> device = [] {
            const gpu::HostState keep;
            return makeGlDevice(ShaderFiles::developer());
        }();
        std::unique_ptr<FluidWorld> world;
        {
            const gpu::HostState keep;
            auto made = FluidWorld::create(*device, testing::hostWater(), {}, {});
            ASSERT_TRUE(made) << made.error().message;
            world = std::move(*made);
            for (int k = 0; k < 3; ++k) world->step({}, 1.0 / 60);
        }
        EXPECT_EQ(difference(before, glSnapshot()), "") << "step()";
        const Status drawn = (*renderer)->draw(host.view(), testing::viewOf(*world), {}, host.target());
        ASSERT_TRUE(drawn) << drawn.error().message;
        EXPECT_EQ(difference(before, glSnapshot()), "") << "draw()";
        // With a host's surroundings and shadow map.
        GLuint cube = 0, map = 0;
        glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &cube);
        glTextureStorage2D(cube, 1, GL_RGBA16F, 4, 4);
        glCreateTextures(GL_TEXTURE_2D, 1, &map);
        glTextureStorage2D(map, 1, GL_DEPTH_COMPONENT24, 4, 4);
        const HdrImage grey{.name = "grey", .width = 2, .height = 1, .texels = {vec3(0.5F), vec3(0.5F)}};
        for (const HostSurroundings& around : {HostSurroundings{.image = grey}, HostSurroundings{.texture = cube}}) {
            const Status set = (*renderer)->setSurroundings(around);
            ASSERT_TRUE(set) << set.error().message;
            EXPECT_EQ(difference(before, glSnapshot()), "") << "setSurroundings()";
        }
        const HostLighting lighting{.shadow = {.texture = map}};
        ASSERT_TRUE((*renderer)->draw(host.view(), testing::viewOf(*world), {}, host.target(), nullptr, lighting));
        EXPECT_EQ(difference(before, glSnapshot()), "") << "draw() with a shadow map";
        for (const char* name : {"points", "reference"}) {
            const RendererRow* row = renderers().find(name);
            ASSERT_TRUE((*renderer)->draw(host.view(), testing::viewOf(*world), {}, host.target(), row));
            EXPECT_EQ(difference(before, glSnapshot()), "") << name;
        }
        // Passes of a host may change anything.
        const RendererRow row{"a host's", "messy", true, [](gpu::FrameGraph& graph, FluidPrograms&, const FluidDraw& d) -> FluidLayers {
                                  graph.pass("messy", {}, {d.colour}, [colour = d.colour](gpu::PassContext& c) {
                                      c.drawTo({colour}).clearColour(vec4(0.0F, 1.0F, 0.0F, 1.0F));
                                      glEnable(GL_BLEND);
                                      glBlendFunc(GL_DST_COLOR, GL_ONE);
                                      glViewport(1, 2, 3, 4);
                                      glEnable(GL_SCISSOR_TEST);
                                      glBindTextures(0, 32, nullptr);
                                  });
                                  return {d.colour, {}};
                              }};
        ASSERT_TRUE((*renderer)->draw(host.view(), testing::viewOf(*world), {}, host.target(), &row));
        EXPECT_EQ(difference(before, glSnapshot()), "") << "a host's row";
        const gpu::HostState keep;
        world.reset();
    }
    renderer->reset();
    EXPECT_EQ(difference(before, glSnapshot()), "") << "the end";
}

INSTANTIATE_TEST_SUITE_P(Contexts, HostStateIn, ::testing::Values(Host{false, false}, Host{false, true}, Host{true, true}),
                         [](const ::testing::TestParamInfo<Host>& host) {
                             return std::string(host.param.old ? "compatibility" : "core") + (host.param.odd ? "AndOdd" : "");
                         });

}  // namespace
}  // namespace rivulet::host_state_test
