// The watch over glMemoryBarrier reports a barrier that is left out, in the frame graph and in Device gl, and nothing else.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include "engine/compute/kernel_source.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/program.h"
#include "tests/barriers.h"
#include "tests/expected_renderer.h"
#include "tests/parity/devices.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::barriers_test {
namespace {

constexpr const char* kFill = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Out { float out_[]; };
void main() { out_[gl_GlobalInvocationID.x] = float(gl_GlobalInvocationID.x); }
)";
constexpr const char* kAdd = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer In { float in_[]; };
layout(std430, binding = 1) buffer Out { float out_[]; };
void main() { out_[gl_GlobalInvocationID.x] = in_[gl_GlobalInvocationID.x] + 1.0; }
)";
constexpr const char* kVertex = "layout(location = 0) in float value; void main() { gl_Position = vec4(value); }";
constexpr const char* kTexels = R"(
uniform samplerBuffer texels;
void main() { gl_Position = texelFetch(texels, gl_VertexID); }
)";

class Barriers : public rivulet::testing::OpenGlTest {
  protected:
    void SetUp() override {
        OpenGlTest::SetUp();
        if (!context_) return;
        expectRenderer(context_->renderer());
        files_.add("shaders/test/fill.comp", kFill);
        files_.add("shaders/test/add.comp", kAdd);
        files_.add("shaders/test/vertex.vert", kVertex);
        files_.add("shaders/test/texels.vert", kTexels);
        barriers::takeMissing();
    }
    gpu::Program program(const char* path) {
        Result<gpu::Program> made = gpu::Program::create(files_, {path}, {});
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        return std::move(*made);
    }
    // A pass fills a buffer, a second copies it, a third reads it as `usage`.
    void frame(gpu::Usage usage) {
        gpu::Program fill = program("shaders/test/fill.comp"), add = program("shaders/test/add.comp"),
                     draw = program(usage == gpu::Usage::sampled ? "shaders/test/texels.vert" : "shaders/test/vertex.vert");
        gpu::TransientPool pool;
        gpu::FrameGraph graph(pool);
        const gpu::BufferHandle filled = graph.buffer("filled", 256), added = graph.buffer("added", 256), end = graph.buffer("end", 256);
        graph.pass("fill", {}, {filled}, [&](gpu::PassContext& c) {
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, c.buffer(filled));
            fill.dispatch(64);
        });
        graph.pass("add", {filled}, {added}, [&](gpu::PassContext& c) {
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, c.buffer(filled));
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, c.buffer(added));
            add.dispatch(64);
        });
        graph.pass("draw", {{added, usage}}, {{end, gpu::Usage::copy}}, [&](gpu::PassContext& c) {
            if (usage == gpu::Usage::copy) {
                glCopyNamedBufferSubData(c.buffer(added), c.buffer(end), 0, 0, 256);
                return;
            }
            GLuint array = 0, texture = 0, target = 0;
            glCreateFramebuffers(1, &target);
            glNamedFramebufferParameteri(target, GL_FRAMEBUFFER_DEFAULT_WIDTH, 1);
            glNamedFramebufferParameteri(target, GL_FRAMEBUFFER_DEFAULT_HEIGHT, 1);
            glBindFramebuffer(GL_FRAMEBUFFER, target);
            glCreateVertexArrays(1, &array);
            glBindVertexArray(array);
            if (usage == gpu::Usage::sampled) {
                glCreateTextures(GL_TEXTURE_BUFFER, 1, &texture);
                glTextureBuffer(texture, GL_R32F, c.buffer(added));
                glBindTextureUnit(3, texture);
                draw.set("texels", 3);
            } else {
                glEnableVertexArrayAttrib(array, 0);
                glVertexArrayVertexBuffer(array, 0, c.buffer(added), 0, 4);
                glVertexArrayAttribFormat(array, 0, 1, GL_FLOAT, GL_FALSE, 0);
            }
            glEnable(GL_RASTERIZER_DISCARD);
            draw.use();
            glDrawArrays(GL_POINTS, 0, 64);
            glDisable(GL_RASTERIZER_DISCARD);
            glBindVertexArray(0);
            glDeleteVertexArrays(1, &array);
            glDeleteTextures(1, &texture);
            glBindFramebuffer(GL_FRAMEBUFFER, 0);
            glDeleteFramebuffers(1, &target);
        });
        graph.output(end);
        ASSERT_TRUE(graph.execute());
    }
    ShaderFiles files_;
};

TEST_F(Barriers, OfTheFrameGraphAreEachNeededAndEnough) {
    if (!context_) return;
    struct Row {
        gpu::Usage usage;
        const char* bit;
    };
    for (const Row& row :
         {Row{gpu::Usage::attribute, "GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT"}, Row{gpu::Usage::copy, "GL_BUFFER_UPDATE_BARRIER_BIT"},
          Row{gpu::Usage::sampled, "GL_TEXTURE_FETCH_BARRIER_BIT"}}) {
        SCOPED_TRACE(row.bit);
        const barriers::Watched before = barriers::watched();
        frame(row.usage);
        EXPECT_EQ(barriers::takeMissing(), std::vector<std::string>());
        EXPECT_EQ(barriers::watched().dispatches, before.dispatches + 2);
        EXPECT_GT(barriers::watched().uses, before.uses);
        barriers::leaveOutBarrier(1);
        frame(row.usage);
        std::vector<std::string> missing = barriers::takeMissing();
        ASSERT_GE(missing.size(), 1U) << "between two dispatches";
        EXPECT_NE(missing[0].find("reads the storage buffer In"), std::string::npos) << missing[0];
        EXPECT_NE(missing[0].find("without GL_SHADER_STORAGE_BARRIER_BIT"), std::string::npos) << missing[0];
        barriers::leaveOutBarrier(2);
        frame(row.usage);
        missing = barriers::takeMissing();
        ASSERT_FALSE(missing.empty()) << "between a dispatch and another use";
        for (const std::string& sentence : missing) EXPECT_NE(sentence.find(row.bit), std::string::npos) << sentence;
    }
}

// "reorder" of a sentence on memory "which kernel reorder wrote".
std::string writer(const std::string& sentence) {
    const std::string before = "which kernel ";
    const size_t from = sentence.find(before) + before.size();
    return sentence.substr(from, sentence.find(" wrote", from) - from);
}

// The first 12 barriers of a step. The watch reports 10 of them: there the next kernel uses what the kernel before it wrote. Two are not
// needed here: that of poll(), as nothing was written since the barrier before it; and that after near_walls, as dfsph_warm, the next
// kernel, reads none of its results.
TEST(BarriersOfDeviceGl, OneThatIsLeftOutIsReported) {
    Result<TestGpu> gpu = makeTestGpu("gl");
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.05F;
    p.box.max = vec3(0.4F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.2F)}};
    auto world = FluidWorld::create(*gpu->device, p, {}, {});
    ASSERT_TRUE(world) << world.error().message;
    (*world)->step({}, 1.0 / 600);
    EXPECT_EQ(barriers::takeMissing(), std::vector<std::string>());
    std::vector<std::string> reported;
    for (size_t n = 1; n <= 12; ++n) {
        barriers::leaveOutBarrier(n);
        (*world)->step({}, 1.0 / 600);
        const std::vector<std::string> missing = barriers::takeMissing();
        for (const std::string& sentence : missing) {
            EXPECT_EQ(sentence.rfind("kernel ", 0), 0U) << sentence;
            EXPECT_NE(sentence.find(" without GL_SHADER_STORAGE_BARRIER_BIT"), std::string::npos) << sentence;
        }
        reported.push_back(missing.empty() ? "" : writer(missing[0]));
    }
    EXPECT_EQ(reported, (std::vector<std::string>{"", "cell_count", "scan_reduce", "scan_blocks", "scan_apply", "cell_scatter", "cell_sort",
                                                  "reorder", "", "dfsph_warm", "dfsph_density", "dfsph_begin"}));
}

}  // namespace
}  // namespace rivulet::barriers_test
