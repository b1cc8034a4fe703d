// Owners of GL memory: contents survive the way there and back, names are given back, failures are sentences.
#include <rivulet_glad/gl.h>

#include <array>
#include <cstring>
#include <set>
#include <utility>

#include "engine/gpu/buffer.h"
#include "engine/gpu/framebuffer.h"
#include "engine/gpu/staging_ring.h"
#include "engine/gpu/texture.h"
#include "engine/gpu/timer.h"
#include "engine/gpu/vertex_array.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::gpu::gpu_objects_test {
namespace {

using GpuObjects = GpuTest;

template <class T>
std::vector<T> texelsOf(const Texture& texture, int mip = 0, int layer = 0) {
    std::vector<T> texels(texture.hostBytes(mip) / sizeof(T));
    texture.read(std::as_writable_bytes(std::span(texels)), mip, layer);
    return texels;
}

TEST_F(GpuObjects, ABufferHoldsZeroesThenWrittenData) {
    Result<Buffer> buffer = Buffer::create(10 * sizeof(uint32_t));
    ASSERT_TRUE(buffer);
    EXPECT_EQ(buffer->readAll<uint32_t>(10), std::vector<uint32_t>(10, 0U));
    const std::vector<uint32_t> some = {7, 8, 9};
    buffer->write(std::as_bytes(std::span(some)), 2 * sizeof(uint32_t));
    EXPECT_EQ(buffer->readAll<uint32_t>(6), (std::vector<uint32_t>{0, 0, 7, 8, 9, 0}));
    buffer->fill(0xDEADBEEF);
    EXPECT_EQ(buffer->readAll<uint32_t>(10), std::vector<uint32_t>(10, 0xDEADBEEF));
}

TEST_F(GpuObjects, ABufferOfNothingIsValid) {
    Result<Buffer> buffer = Buffer::create(0);
    ASSERT_TRUE(buffer);
    EXPECT_EQ(buffer->bytes(), 0U);
    EXPECT_TRUE(*buffer);
    EXPECT_TRUE(buffer->readAll<float>(0).empty());
}

TEST_F(GpuObjects, AMappedBufferShowsDataCopiedByTheGpu) {
    Result<Buffer> mapped = Buffer::create(16, BufferKind::mapped);
    Result<Buffer> source = Buffer::from(std::vector<uint32_t>{1, 2, 3, 4});
    ASSERT_TRUE(mapped && source);
    ASSERT_EQ(mapped->mapped().size(), 16U);
    EXPECT_TRUE(source->mapped().empty());
    glCopyNamedBufferSubData(source->name(), mapped->name(), 0, 0, 16);
    glFinish();
    uint32_t third = 0;
    std::memcpy(&third, mapped->mapped().data() + 8, 4);
    EXPECT_EQ(third, 3U);
}

// Ten frames through three pieces, of other sizes each, and every one arrives as it was written.
TEST_F(GpuObjects, ARingOfStagingBringsEachFrameOver) {
    StagingRing ring;
    std::vector<Buffer> kept;
    for (uint32_t frame = 0; frame < 10; ++frame) {
        const size_t count = 100 + 977 * (frame % 4);
        ASSERT_TRUE(ring.begin(2 * (count * sizeof(uint32_t) + 64)));
        for (uint32_t part = 0; part < 2; ++part) {
            const std::span<std::byte> into = ring.take(count * sizeof(uint32_t));
            std::vector<uint32_t> words(count);
            for (size_t k = 0; k < count; ++k) words[k] = 1000000 * frame + 100000 * part + static_cast<uint32_t>(k);
            std::memcpy(into.data(), words.data(), into.size());
            Result<Buffer> to = Buffer::create(into.size());
            ASSERT_TRUE(to);
            ring.copyTo(*to);
            kept.push_back(std::move(*to));
        }
        ring.end();
    }
    for (uint32_t k = 0; k < kept.size(); ++k) {
        const std::vector<uint32_t> words = kept[k].readAll<uint32_t>(kept[k].bytes() / sizeof(uint32_t));
        for (size_t i = 0; i < words.size(); ++i) ASSERT_EQ(words[i], 1000000 * (k / 2) + 100000 * (k % 2) + i);
    }
}

TEST_F(GpuObjects, NamesAreDeletedWithTheirOwners) {
    GLuint buffer = 0, texture = 0, sampler = 0, framebuffer = 0, array = 0;
    {
        Result<Buffer> b = Buffer::create(64);
        Result<Texture> t = Texture::create({.width = 4, .height = 4});
        ASSERT_TRUE(b && t);
        const Sampler s{Sampling{}};
        const Framebuffer f(*t, nullptr);
        const VertexArray a = VertexArray::create();
        buffer = b->name(), texture = t->name(), sampler = s.name(), framebuffer = f.name(), array = a.name();
        EXPECT_TRUE(glIsBuffer(buffer) && glIsTexture(texture) && glIsSampler(sampler) && glIsFramebuffer(framebuffer) &&
                    glIsVertexArray(array));
        Buffer moved = std::move(*b);
        EXPECT_FALSE(*b);
        EXPECT_TRUE(glIsBuffer(buffer));
        moved = Buffer();
        EXPECT_FALSE(glIsBuffer(buffer)) << "an owner that takes another object drops its own";
    }
    EXPECT_FALSE(glIsTexture(texture) || glIsSampler(sampler) || glIsFramebuffer(framebuffer) || glIsVertexArray(array));
}

TEST_F(GpuObjects, AThousandBuffersAndTexturesOneAfterTheOtherLeaveNothingBehind) {
    std::set<GLuint> buffers, textures;
    size_t before = 0;
    for (int k = 0; k < 1000; ++k) {
        if (k == 20) before = residentBytes();  // the driver has what it keeps for good
        Result<Buffer> b = Buffer::create(size_t{1} << 20U);
        Result<Texture> t = Texture::create({.width = 256, .height = 256, .format = Format::rgba32f});
        ASSERT_TRUE(b && t);
        t->clear(vec4(1));
        buffers.insert(b->name());
        textures.insert(t->name());
    }
    for (const GLuint name : buffers) EXPECT_FALSE(glIsBuffer(name));
    for (const GLuint name : textures) EXPECT_FALSE(glIsTexture(name));
    EXPECT_LT(residentBytes(), before + (size_t{512} << 20U)) << "2 GB went through";
}

TEST_F(GpuObjects, EveryFormatCarriesItsTexelsThereAndBack) {
    for (int f = 0; f <= static_cast<int>(Format::depth32f); ++f) {
        const auto format = static_cast<Format>(f);
        const FormatInfo& info = formatInfo(format);
        Result<Texture> texture = Texture::create({.width = 3, .height = 2, .format = format});  // odd rows: alignment must not matter
        ASSERT_TRUE(texture) << info.name;
        std::vector<std::byte> sent(texture->hostBytes()), back(texture->hostBytes());
        if (info.type == GL_FLOAT) {
            std::vector<float> values(sent.size() / sizeof(float));
            for (size_t k = 0; k < values.size(); ++k) values[k] = static_cast<float>(k % 8) * 0.125F;  // exact in every format
            std::memcpy(sent.data(), values.data(), sent.size());
        } else {
            for (size_t k = 0; k < sent.size(); ++k) sent[k] = static_cast<std::byte>(37 * k + 11);
        }
        texture->upload(sent);
        texture->read(back);
        if (format == Format::depth24) {
            for (size_t k = 0; k < sent.size() / sizeof(float); ++k) {
                float a = 0, b = 0;
                std::memcpy(&a, sent.data() + 4 * k, 4);
                std::memcpy(&b, back.data() + 4 * k, 4);
                EXPECT_NEAR(a, b, 1.0e-6F);
            }
        } else {
            EXPECT_EQ(sent, back) << info.name;
        }
    }
}

TEST_F(GpuObjects, LayersFacesAndLevelsAreDistinct) {
    for (const TextureShape shape : {TextureShape::array, TextureShape::cube}) {
        Result<Texture> texture =
            Texture::create({.width = 4, .height = 4, .format = Format::r32ui, .shape = shape, .layers = 6, .mips = 0});
        ASSERT_TRUE(texture);
        EXPECT_EQ(texture->desc().mips, 3);
        for (int mip = 0; mip < 3; ++mip)
            for (int layer = 0; layer < 6; ++layer) {
                const std::vector<uint32_t> texels(texture->hostBytes(mip) / 4, static_cast<uint32_t>(100 * mip + layer));
                texture->upload(std::as_bytes(std::span(texels)), mip, layer);
            }
        for (int mip = 0; mip < 3; ++mip)
            for (int layer = 0; layer < 6; ++layer)
                EXPECT_EQ(texelsOf<uint32_t>(*texture, mip, layer).front(), static_cast<uint32_t>(100 * mip + layer));
    }
}

TEST_F(GpuObjects, MipsAverage) {
    Result<Texture> texture = Texture::create({.width = 2, .height = 2, .format = Format::r32f, .mips = 0});
    ASSERT_TRUE(texture);
    const std::array<float, 4> texels = {0, 1, 2, 5};
    texture->upload(std::as_bytes(std::span(texels)));
    texture->generateMips();
    EXPECT_NEAR(texelsOf<float>(*texture, 1).front(), 2.0F, 1.0e-6F);
    texture->clear(vec4(0.25F));
    EXPECT_EQ(texelsOf<float>(*texture, 1).front(), 0.25F);
}

TEST_F(GpuObjects, AMinimisedWindowGivesATextureOfOneTexel) {
    Result<Texture> texture = Texture::create({.width = 0, .height = 0, .mips = 0});
    ASSERT_TRUE(texture);
    EXPECT_EQ(texture->width(), 1);
    EXPECT_EQ(texture->desc().mips, 1);
}

TEST_F(GpuObjects, ATextureLargerThanTheGpuAllowsIsASentence) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    const Result<Texture> texture = Texture::create({.width = most + 1, .height = 8});
    ASSERT_FALSE(texture);
    EXPECT_NE(texture.error().message.find(std::to_string(most + 1)), std::string::npos) << texture.error().message;
    EXPECT_NE(texture.error().message.find(std::to_string(most)), std::string::npos) << texture.error().message;
    EXPECT_EQ(texture.error().fault, Fault::failed);
}

TEST_F(GpuObjects, AFramebufferClearsEachOfItsTexturesAndScalesOntoAnother) {
    Result<Texture> a = Texture::create({.width = 8, .height = 8, .format = Format::rgba32f});
    Result<Texture> b = Texture::create({.width = 8, .height = 8, .format = Format::r32f});
    Result<Texture> depth = Texture::create({.width = 8, .height = 8, .format = Format::depth32f});
    Result<Texture> half = Texture::create({.width = 4, .height = 4, .format = Format::rgba32f});
    ASSERT_TRUE(a && b && depth && half);
    const Framebuffer both(std::array{Attachment{&*a}, Attachment{&*b}}, Attachment{&*depth});
    both.clearColour(vec4(1, 2, 3, 4), 0);
    both.clearColour(vec4(5, 0, 0, 0), 1);
    both.clearDepth(0.5F);
    EXPECT_EQ(texelsOf<vec4>(*a)[63], vec4(1, 2, 3, 4));
    EXPECT_EQ(texelsOf<float>(*b)[0], 5.0F);
    EXPECT_EQ(texelsOf<float>(*depth)[17], 0.5F);
    const Framebuffer target(*half, nullptr);
    both.blitTo(target.name(), 4, 4);
    EXPECT_EQ(texelsOf<vec4>(*half)[15], vec4(1, 2, 3, 4));
    both.blitTo(target.name(), 0, 0);  // a minimised window: nothing
}

TEST_F(GpuObjects, ABufferHoldsWhatItIsMadeFromWhateverItsSize) {
    for (const size_t count : {1U, 7U, 100U, 1000U, 10000U, 16385U, 100000U, 1000000U, 3000001U}) {
        std::vector<uint32_t> words(count);
        for (size_t k = 0; k < count; ++k) words[k] = static_cast<uint32_t>(k * 2654435761U + count);
        Result<Buffer> made = Buffer::from(words);
        ASSERT_TRUE(made) << made.error().message;
        Result<Buffer> copied = Buffer::create(4 * count);  // by the GPU, in order with the writes
        ASSERT_TRUE(copied) << copied.error().message;
        glCopyNamedBufferSubData(made->name(), copied->name(), 0, 0, static_cast<GLsizeiptr>(4 * count));
        const std::vector<uint32_t> copy = copied->readAll<uint32_t>(count), held = made->readAll<uint32_t>(count);
        size_t wrong = 0, lost = 0;
        for (size_t k = 0; k < count; ++k) {
            wrong += copy[k] != words[k] ? 1 : 0;
            lost += held[k] != words[k] ? 1 : 0;
        }
        EXPECT_EQ(wrong, 0U) << "of " << count << " words, as the GPU sees them";
        EXPECT_EQ(lost, 0U) << "of " << count << " words";
    }
}

TEST_F(GpuObjects, TheDebugCallbackReportsErrors) {
    glEnable(GL_TEXTURE_2D + 12345);
    EXPECT_EQ(messages_->errors(), 1);
    EXPECT_NE(messages_->lastError().find("OpenGL"), std::string::npos);
    EXPECT_NE(said_.find("OpenGL"), std::string::npos) << said_;
    messages_.reset();  // this one was meant
    const std::string before = said_;
    glDisable(GL_TEXTURE_2D + 12345);
    EXPECT_EQ(said_, before) << "nothing is heard once it is gone";
}

TEST_F(GpuObjects, ATimerMeasuresWorkLaterAndInOrder) {
    Timer timer;
    Result<Texture> large = Texture::create({.width = 1024, .height = 1024, .format = Format::rgba32f});
    ASSERT_TRUE(large);
    const Framebuffer target(*large, nullptr);
    timer.begin(1);
    timer.begin(2);  // nested
    for (int k = 0; k < 4; ++k) {
        target.clearColour(vec4(static_cast<float>(k)));
        large->generateMips();
    }
    timer.end();
    timer.end();
    EXPECT_EQ(timer.pending(), 2U);
    glFinish();
    std::vector<std::pair<uint64_t, double>> got;
    timer.collect([&](uint64_t tag, const gpu::Timer::Times& times) { got.emplace_back(tag, times.ms()); });
    ASSERT_EQ(got.size(), 2U);
    EXPECT_EQ(got[0].first, 2U);
    EXPECT_EQ(got[1].first, 1U);
    EXPECT_GT(got[0].second, 0.0);
    EXPECT_GE(got[1].second, got[0].second) << "what holds another lasts longer";
    EXPECT_LT(got[1].second, 5000.0);
    EXPECT_EQ(timer.pending(), 0U);
}

}  // namespace
}  // namespace rivulet::gpu::gpu_objects_test
