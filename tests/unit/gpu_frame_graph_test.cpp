// The frame graph's four promises: cull, pool, barriers, times.
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cstring>

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/program.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::gpu::gpu_frame_graph_test {
namespace {

class GpuFrameGraph : public GpuTest {
  protected:
    void SetUp() override {
        GpuTest::SetUp();
        if (HasFatalFailure()) return;
        pool_.emplace();
    }
    void TearDown() override {
        pool_.reset();
        GpuTest::TearDown();
    }
    static TextureDesc square(int edge, Format format = Format::r32f) { return {.width = edge, .height = edge, .format = format}; }
    static float firstTexel(const Texture& texture) {
        std::vector<float> texels(texture.hostBytes() / sizeof(float));
        texture.read(std::as_writable_bytes(std::span(texels)));
        return texels.front();
    }
    // A pass that adds nothing but its value.
    static TextureHandle addClear(FrameGraph& graph, const std::string& name, float value, int edge = 4) {
        const TextureHandle texture = graph.texture(name, square(edge));
        graph.pass(name, {}, {texture}, [=](PassContext& c) { c.drawTo({texture}).clearColour(vec4(value)); });
        return texture;
    }
    std::optional<TransientPool> pool_;
};

TEST_F(GpuFrameGraph, CullsPassesWhoseResultsAreNotUsed) {
    FrameGraph graph(*pool_);
    std::string order;
    const TextureHandle a = graph.texture("a", square(4)), b = graph.texture("b", square(4)), c = graph.texture("c", square(4)),
                        d = graph.texture("d", square(4));
    const auto letter = [&](const char* name) { return [&order, name](PassContext&) { order += name; }; };
    graph.pass("A", {}, {a}, letter("A"));
    graph.pass("B", {a}, {b}, letter("B"));  // read by C only, which nobody needs
    graph.pass("C", {b}, {c}, letter("C"));
    graph.pass("D", {a}, {d}, letter("D"));
    graph.pass("E", {}, {d}, letter("E"));   // adds to D's
    graph.pass("F", {d}, {a}, letter("F"));  // written again, after the last who reads
    graph.output(d);
    ASSERT_TRUE(graph.execute());
    EXPECT_EQ(order, "ADE");
    std::string culled;
    for (const FrameGraph::Ran& ran : graph.ran())
        if (ran.culled) culled += ran.name;
    EXPECT_EQ(culled, "BCF");
}

TEST_F(GpuFrameGraph, TexturesThatNeverMeetShareMemory) {
    FrameGraph graph(*pool_);
    // A chain of ten: two at a time are alive.
    TextureHandle last = addClear(graph, "link 0", 1);
    for (int k = 1; k < 10; ++k) {
        const TextureHandle next = graph.texture("link " + std::to_string(k), square(4));
        graph.pass("link " + std::to_string(k), {last}, {next}, [=](PassContext& c) {
            EXPECT_NE(c.texture(last).name(), c.texture(next).name());
            c.drawTo({next}).clearColour(vec4(firstTexel(c.texture(last)) + 1));
        });
        last = next;
    }
    graph.output(last);
    ASSERT_TRUE(graph.execute());
    EXPECT_EQ(firstTexel(graph.result(last)), 10.0F);
    EXPECT_EQ(pool_->textures(), 2U);
    EXPECT_EQ(pool_->bytes(), 2U * 4 * 4 * 4);
}

// Each texture and buffer counts whole, once for each pass that declares it; passes of one name are one row.
TEST_F(GpuFrameGraph, TrafficIsTheSumOfWhatPassesDeclare) {
    const Texture outside = std::move(*Texture::create(square(8, Format::rgba8)));  // 256 bytes
    FrameGraph graph(*pool_);
    const TextureHandle in = graph.importTexture("in", outside);
    const TextureHandle wide = graph.texture("wide", square(16, Format::rgba16f)), half = graph.texture("half", square(8, Format::r16f)),
                        sum = graph.texture("sum", square(8)), unused = graph.texture("unused", square(64));  // 2048, 128, 256 bytes
    const BufferHandle rows = graph.buffer("rows", 100);
    const auto nothing = [](PassContext&) {};
    graph.pass("first", {in}, {wide, rows}, nothing);
    graph.pass("blur", {wide}, {half}, nothing);
    graph.pass("waste", {wide}, {unused}, nothing);
    graph.pass("blur", {half, rows}, {sum}, nothing);
    graph.output(sum);
    ASSERT_TRUE(graph.execute());
    const std::vector<PassTraffic> traffic = trafficOf(graph.describe());
    ASSERT_EQ(traffic.size(), 2U);
    EXPECT_EQ(traffic[0].name, "first");
    EXPECT_EQ(traffic[0].passes, 1U);
    EXPECT_EQ(traffic[0].read, 256U);
    EXPECT_EQ(traffic[0].written, 2048U + 100);
    EXPECT_EQ(traffic[1].name, "blur");
    EXPECT_EQ(traffic[1].passes, 2U);
    EXPECT_EQ(traffic[1].read, 2048U + 128 + 100);
    EXPECT_EQ(traffic[1].written, 128U + 256);
}

// describe() matches the execution: culled passes, uses of resources, lifetimes, and shared memory.
TEST_F(GpuFrameGraph, DescribesItsPasses) {
    const Texture outside = std::move(*Texture::create(square(8)));
    FrameGraph graph(*pool_);
    const TextureHandle from = graph.importTexture("outside", outside);
    const TextureHandle a = addClear(graph, "a", 1);
    const TextureHandle b = graph.texture("b", square(4)), c = graph.texture("c", square(4)), unseen = graph.texture("unseen", square(4));
    std::vector<GLuint> names(3);
    graph.pass("B", {a, from}, {b}, [&](PassContext& x) {
        names[0] = x.texture(a).name();
        names[1] = x.texture(b).name();
    });
    graph.pass("unseen", {b}, {unseen}, [](PassContext&) { FAIL() << "nobody needs it"; });
    graph.pass("C", {{b, Usage::image}}, {c}, [&](PassContext& x) { names[2] = x.texture(c).name(); });
    const BufferHandle buffer = graph.buffer("numbers", 1000);
    graph.pass("D", {c}, {buffer}, [](PassContext&) {});
    graph.output(buffer);
    ASSERT_TRUE(graph.execute());

    const FrameGraphDescription d = graph.describe();
    const std::vector<FrameGraph::Ran> ran = graph.ran();
    ASSERT_EQ(d.passes.size(), ran.size());
    for (size_t p = 0; p < ran.size(); ++p) {
        EXPECT_EQ(d.passes[p].name, ran[p].name);
        EXPECT_EQ(d.passes[p].culled, ran[p].culled);
    }
    const auto of = [&](const char* name) {
        return *std::find_if(d.resources.begin(), d.resources.end(), [&](const auto& r) { return r.name == name; });
    };
    EXPECT_EQ(of("a").first, 0U);
    EXPECT_EQ(of("a").last, 1U);
    EXPECT_EQ(of("b").first, 1U);
    EXPECT_EQ(of("b").last, 3U) << "who was left out kept nothing alive";
    EXPECT_EQ(of("unseen").first, SIZE_MAX);
    EXPECT_EQ(of("unseen").memory, SIZE_MAX);
    EXPECT_EQ(of("a").memory == of("b").memory, names[0] == names[1]);
    EXPECT_EQ(of("a").memory == of("c").memory, names[0] == names[2]);
    EXPECT_EQ(of("a").memory, of("c").memory) << "they are never alive together";
    EXPECT_TRUE(of("outside").imported);
    EXPECT_EQ(of("outside").memory, SIZE_MAX);
    EXPECT_EQ(of("outside").format, "r32f");
    EXPECT_EQ(of("outside").bytes, 8U * 8 * 4);
    EXPECT_EQ(of("numbers").bytes, 1000U);
    EXPECT_TRUE(of("numbers").output);
    EXPECT_EQ(d.memories, pool_->textures() + pool_->buffers());
    EXPECT_EQ(d.lentBytes, pool_->bytes());
    EXPECT_EQ(d.heldBytes, pool_->bytes());
    ASSERT_EQ(d.passes[3].reads.size(), 1U);
    EXPECT_EQ(d.resources[d.passes[3].reads[0].resource].name, "b");
    EXPECT_STREQ(usageName(d.passes[3].reads[0].usage), "image");
    EXPECT_STREQ(usageName(d.passes[4].writes[0].usage), "storage");
}

TEST_F(GpuFrameGraph, TexturesOfAnotherDescriptionOrAliveTogetherDoNot) {
    FrameGraph graph(*pool_);
    const TextureHandle a = addClear(graph, "a", 1), b = addClear(graph, "b", 2), larger = addClear(graph, "larger", 3, 8);
    const TextureHandle sum = graph.texture("sum", square(4));
    graph.pass("sum", {a, b, larger}, {sum}, [=](PassContext& c) {
        c.drawTo({sum}).clearColour(vec4(firstTexel(c.texture(a)) + 10 * firstTexel(c.texture(b)) + 100 * firstTexel(c.texture(larger))));
    });
    graph.output(sum);
    ASSERT_TRUE(graph.execute());
    EXPECT_EQ(firstTexel(graph.result(sum)), 321.0F);
    EXPECT_EQ(pool_->textures(), 4U);
}

TEST_F(GpuFrameGraph, ThePoolIsKeptBetweenFramesAndShrinksAfterAResize) {
    GLuint first = 0;
    for (int frame = 0; frame < 30; ++frame) {
        FrameGraph graph(*pool_);
        const TextureHandle picture = addClear(graph, "picture", 1, frame < 10 ? 64 : 32);
        graph.output(picture);
        ASSERT_TRUE(graph.execute());
        if (frame == 0) first = graph.result(picture).name();
        if (frame == 9) {
            EXPECT_EQ(graph.result(picture).name(), first);
            EXPECT_EQ(pool_->textures(), 1U);
        }
    }
    EXPECT_EQ(pool_->textures(), 1U) << "the old size is freed";
    EXPECT_EQ(pool_->bytes(), 32U * 32 * 4);
}

TEST_F(GpuFrameGraph, ResultsOfComputeAreReadAfterTheBarrierOfTheirReader) {
    writeFile("shaders/fill.comp",
              "layout(local_size_x = 64) in;\nlayout(std430, binding = 1) buffer B { float v[]; }; layout(r32f, binding = 0) uniform "
              "image2D im;\n"
              "uniform float value;\nvoid main() { uint i = gl_GlobalInvocationID.x; v[i] = value + float(i);\n"
              "  imageStore(im, ivec2(i % 64u, i / 64u), vec4(value + float(i))); }\n");
    writeFile("shaders/add.comp",
              "layout(local_size_x = 64) in;\nlayout(std430, binding = 1) readonly buffer B { float v[]; };\n"
              "layout(std430, binding = 2) writeonly buffer C { float w[]; };\nuniform sampler2D im;\n"
              "void main() { uint i = gl_GlobalInvocationID.x; w[i] = v[i] + texelFetch(im, ivec2(i % 64u, i / 64u), 0).x; }\n");
    Result<Program> fill = Program::create(ShaderFiles(root()), {"shaders/fill.comp"});
    Result<Program> add = Program::create(ShaderFiles(root()), {"shaders/add.comp"});
    ASSERT_TRUE(fill && add);
    constexpr unsigned kCount = 64 * 64;
    for (int frame = 0; frame < 3; ++frame) {
        FrameGraph graph(*pool_);
        const BufferHandle v = graph.buffer("v", kCount * 4), w = graph.buffer("w", kCount * 4);
        const TextureHandle image = graph.texture("image", square(64)), painted = graph.texture("painted", square(4));
        const auto base = static_cast<float>(1000 * frame);
        graph.pass("fill", {}, {v, {image, Usage::image}}, [&](PassContext& c) {
            fill->set("value", base);
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, c.buffer(v));
            c.texture(image).bindImage(0, GL_WRITE_ONLY);
            fill->dispatch(kCount);
        });
        graph.pass("unrelated", {}, {painted}, [=](PassContext& c) { c.drawTo({painted}).clearColour(vec4(1)); });
        graph.pass("add", {v, image}, {w}, [&](PassContext& c) {
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, c.buffer(v));
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, c.buffer(w));
            add->texture("im", 0, c.texture(image));
            add->dispatch(kCount);
        });
        graph.pass("draw", {{w, Usage::attribute}, {v, Usage::attribute}}, {painted}, [](PassContext&) {});
        graph.pass("again", {}, {v}, [](PassContext&) {});
        graph.output(w);
        graph.output(painted);
        graph.output(v);
        ASSERT_TRUE(graph.execute());
        const std::vector<FrameGraph::Ran> ran = graph.ran();
        ASSERT_EQ(ran.size(), 5U);
        EXPECT_EQ(ran[0].barriers, 0U);
        EXPECT_EQ(ran[1].barriers, 0U) << "nothing to do with what was written";
        EXPECT_EQ(ran[2].barriers, static_cast<GLbitfield>(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT));
        EXPECT_EQ(ran[3].barriers, static_cast<GLbitfield>(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT));
        EXPECT_EQ(ran[4].barriers, static_cast<GLbitfield>(GL_SHADER_STORAGE_BARRIER_BIT)) << "a writer must not overtake the readers";
        std::vector<float> result(kCount);
        glGetNamedBufferSubData(graph.result(w), 0, kCount * 4, result.data());
        for (unsigned k = 0; k < kCount; ++k) ASSERT_EQ(result[k], 2 * (base + static_cast<float>(k)));
    }
    EXPECT_EQ(pool_->buffers(), 2U);
}

TEST_F(GpuFrameGraph, NoPassSeesTheStateOfAnother) {
    Result<Texture> hosts = Texture::create(square(16, Format::rgba8));
    ASSERT_TRUE(hosts);
    const Framebuffer host(*hosts, nullptr);
    host.bind();
    FrameGraph graph(*pool_);
    const TextureHandle a = graph.texture("a", square(4));
    graph.pass("messy", {}, {a}, [=](PassContext& c) {
        c.drawTo({a}).clearColour(vec4(1));
        for (const GLenum what : {GL_BLEND, GL_DEPTH_TEST, GL_CULL_FACE, GL_SCISSOR_TEST}) glEnable(what);
        glDepthMask(GL_FALSE);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE);
        c.texture(a).bind(3);
    });
    graph.pass("tidy", {}, {a}, [=](PassContext&) {
        GLint value = -1;
        for (const GLenum what : {GL_BLEND, GL_DEPTH_TEST, GL_CULL_FACE, GL_SCISSOR_TEST}) EXPECT_FALSE(glIsEnabled(what));
        for (const GLenum what : {GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING}) {
            glGetIntegerv(what, &value);
            EXPECT_EQ(value, 0);
        }
        glGetIntegerv(GL_BLEND_DST, &value);
        EXPECT_EQ(value, GL_ZERO);
        GLboolean mask = GL_FALSE;
        glGetBooleanv(GL_DEPTH_WRITEMASK, &mask);
        EXPECT_TRUE(mask);
        glActiveTexture(GL_TEXTURE3);
        glGetIntegerv(GL_TEXTURE_BINDING_2D, &value);
        EXPECT_EQ(value, 0);
        glActiveTexture(GL_TEXTURE0);
    });
    graph.output(a);
    ASSERT_TRUE(graph.execute());
    GLint bound = 0, viewport[4] = {};
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    glGetIntegerv(GL_VIEWPORT, viewport);
    EXPECT_EQ(static_cast<GLuint>(bound), host.name()) << "the host draws on where it was";
    EXPECT_EQ(viewport[2], 16);
}

TEST_F(GpuFrameGraph, TimesArriveSomeFramesLateForEachPassIncludingCulledOnes) {
    for (int frame = 0; frame < 6; ++frame) {
        FrameGraph graph(*pool_);
        const TextureHandle a = graph.texture("a", square(512, Format::rgba32f)), b = graph.texture("b", square(4));
        for (int k = 0; k < 2; ++k)
            graph.pass("paint", {}, {a}, [=](PassContext& c) { c.drawTo({a}).clearColour(vec4(static_cast<float>(k))); });
        graph.pass("unread", {a}, {b}, [](PassContext&) {});
        graph.output(a);
        ASSERT_TRUE(graph.execute());
        if (frame < 2) {
            EXPECT_TRUE(pool_->times().empty());
        }
        glFinish();
    }
    const std::vector<PassTime>& times = pool_->times();
    ASSERT_EQ(times.size(), 2U);
    EXPECT_EQ(times[0].name, "paint");
    EXPECT_EQ(times[0].calls, 2);
    EXPECT_GT(times[0].ms, 0.0);
    EXPECT_EQ(times[1].name, "unread");
    EXPECT_EQ(times[1].calls, 0) << "left out";
    EXPECT_EQ(times[1].ms, 0.0);
}

TEST_F(GpuFrameGraph, ImportsAreReadAndWrittenInPlace) {
    Result<Texture> mine = Texture::create(square(4));
    Result<Buffer> data = Buffer::from(std::vector<float>{5});
    ASSERT_TRUE(mine && data);
    mine->clear(vec4(3));
    FrameGraph graph(*pool_);
    const TextureHandle texture = graph.importTexture("mine", *mine);
    const BufferHandle buffer = graph.importBuffer("data", data->name(), data->bytes());
    EXPECT_EQ(graph.desc(texture).width, 4);
    const TextureHandle copy = graph.texture("copy", square(4));
    graph.pass("copy", {texture, buffer}, {copy}, [=](PassContext& c) {
        EXPECT_EQ(c.bytes(buffer), 4U);
        float value = 0;
        glGetNamedBufferSubData(c.buffer(buffer), 0, 4, &value);
        c.drawTo({copy}).clearColour(vec4(firstTexel(c.texture(texture)) + value));
    });
    graph.pass("back", {copy}, {texture}, [=](PassContext& c) { c.drawTo({texture}).clearColour(vec4(firstTexel(c.texture(copy)) * 10)); });
    graph.output(texture);
    ASSERT_TRUE(graph.execute());
    EXPECT_EQ(firstTexel(*mine), 80.0F);
    EXPECT_EQ(&graph.result(texture), &*mine);
}

TEST_F(GpuFrameGraph, MistakesNameThePassAndTheResource) {
    FrameGraph graph(*pool_);
    const TextureHandle never = graph.texture("never written", square(4)), a = graph.texture("a", square(4));
    EXPECT_DEATH(graph.pass("shade", {never}, {a}, [](PassContext&) {}), "\"shade\", \"never written\"");
    graph.pass("first", {}, {a}, [](PassContext&) {});
    EXPECT_DEATH(graph.pass("loop", {a}, {a}, [](PassContext&) {}), "\"loop\", \"a\"");
    EXPECT_DEATH(graph.pass("misuse", {{a, Usage::attribute}}, {never}, [](PassContext&) {}), "\"misuse\", \"a\"");
    graph.pass("secret", {}, {never}, [=](PassContext& c) { c.texture(a).bind(0); });
    graph.output(never);
    EXPECT_DEATH((void)graph.execute(), "\"secret\" uses \"a\"");
}

TEST_F(GpuFrameGraph, AGraphWithoutPassesOrOutputsIsNoError) {
    {
        FrameGraph graph(*pool_);
        EXPECT_TRUE(graph.execute());
    }
    FrameGraph graph(*pool_);
    addClear(graph, "unread", 1);
    EXPECT_TRUE(graph.execute());
    EXPECT_EQ(pool_->textures(), 0U) << "what does not run is not allocated";
}

TEST_F(GpuFrameGraph, ATextureThatCannotBeMadeIsASentence) {
    FrameGraph graph(*pool_);
    bool ran = false;
    const TextureHandle huge = graph.texture("huge", square(1 << 20));
    graph.pass("huge", {}, {huge}, [&](PassContext&) { ran = true; });
    graph.output(huge);
    const Status done = graph.execute();
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("\"huge\""), std::string::npos) << done.error().message;
    EXPECT_FALSE(ran);
}

}  // namespace
}  // namespace rivulet::gpu::gpu_frame_graph_test
