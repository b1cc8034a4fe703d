#include "engine/gpu/host_state.h"

#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/core/assert.h"
#include "engine/gpu/gl_object.h"
#include "engine/gpu/load.h"

namespace rivulet::gpu {
namespace {

// Switches that would affect Rivulet's drawing, or that it changes; they are off inside the scope.
constexpr GLenum kSwitches[] = {GL_DEPTH_TEST,
                                GL_DEPTH_CLAMP,
                                GL_CULL_FACE,
                                GL_STENCIL_TEST,
                                GL_PROGRAM_POINT_SIZE,
                                GL_POLYGON_OFFSET_FILL,
                                GL_POLYGON_OFFSET_LINE,
                                GL_POLYGON_OFFSET_POINT,
                                GL_POLYGON_SMOOTH,
                                GL_LINE_SMOOTH,
                                GL_FRAMEBUFFER_SRGB,
                                GL_RASTERIZER_DISCARD,
                                GL_COLOR_LOGIC_OP,
                                GL_SAMPLE_ALPHA_TO_COVERAGE,
                                GL_SAMPLE_ALPHA_TO_ONE,
                                GL_SAMPLE_COVERAGE,
                                GL_SAMPLE_MASK,
                                GL_SAMPLE_SHADING,
                                GL_PRIMITIVE_RESTART,
                                GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                GL_DITHER};
constexpr GLint kClipDistances = 8;
// The same for a compatibility context; the header of the core profile has no names for them.
constexpr GLenum kAlphaTest = 0x0BC0, kPolygonStipple = 0x0B42, kVertexTwoSide = 0x8643, kPointSprite = 0x8861, kPointSmooth = 0x0B10;
constexpr GLenum kOldSwitches[] = {kAlphaTest, kPolygonStipple, kVertexTwoSide, kPointSprite, kPointSmooth};
constexpr GLenum kClampVertex = 0x891A, kClampFragment = 0x891B;

constexpr std::pair<GLenum, GLint> kPixelStore[] = {
    {GL_PACK_SWAP_BYTES, 0},   {GL_PACK_LSB_FIRST, 0},     {GL_PACK_ROW_LENGTH, 0},    {GL_PACK_IMAGE_HEIGHT, 0},
    {GL_PACK_SKIP_ROWS, 0},    {GL_PACK_SKIP_PIXELS, 0},   {GL_PACK_SKIP_IMAGES, 0},   {GL_PACK_ALIGNMENT, 4},
    {GL_UNPACK_SWAP_BYTES, 0}, {GL_UNPACK_LSB_FIRST, 0},   {GL_UNPACK_ROW_LENGTH, 0},  {GL_UNPACK_IMAGE_HEIGHT, 0},
    {GL_UNPACK_SKIP_ROWS, 0},  {GL_UNPACK_SKIP_PIXELS, 0}, {GL_UNPACK_SKIP_IMAGES, 0}, {GL_UNPACK_ALIGNMENT, 4}};

// Pixel transfer of a compatibility context: map colours, map stencils, index shift and offset, then scale and bias of red, green, blue,
// alpha and depth.
constexpr std::pair<GLenum, GLfloat> kPixelTransfer[] = {{0x0D10, 0}, {0x0D11, 0}, {0x0D12, 0}, {0x0D13, 0}, {0x0D14, 1},
                                                         {0x0D15, 0}, {0x0D18, 1}, {0x0D19, 0}, {0x0D1A, 1}, {0x0D1B, 0},
                                                         {0x0D1C, 1}, {0x0D1D, 0}, {0x0D1E, 1}, {0x0D1F, 0}};

constexpr std::pair<GLenum, GLenum> kTextures[] = {{GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D},
                                                   {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
                                                   {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
                                                   {GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY},
                                                   {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
                                                   {GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE},
                                                   {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
                                                   {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY},
                                                   {GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER},
                                                   {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE},
                                                   {GL_TEXTURE_2D_MULTISAMPLE_ARRAY, GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY}};

constexpr std::pair<GLenum, GLenum> kBuffers[] = {{GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING},
                                                  {GL_COPY_READ_BUFFER, GL_COPY_READ_BUFFER_BINDING},
                                                  {GL_COPY_WRITE_BUFFER, GL_COPY_WRITE_BUFFER_BINDING},
                                                  {GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING},
                                                  {GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING},
                                                  {GL_DRAW_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER_BINDING},
                                                  {GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING},
                                                  {GL_QUERY_BUFFER, GL_QUERY_BUFFER_BINDING},
                                                  {GL_TEXTURE_BUFFER, GL_TEXTURE_BUFFER_BINDING}};

// The highest binding points that Rivulet uses.
constexpr GLint kUnits = 32, kImages = 8, kStorage = 9, kUniform = 4;

GLint number(GLenum what) {
    GLint value = 0;
    glGetIntegerv(what, &value);
    return value;
}
GLint number(GLenum what, GLint index) {
    GLint value = 0;
    glGetIntegeri_v(what, static_cast<GLuint>(index), &value);
    return value;
}
void turn(GLenum what, bool on) { (on ? glEnable : glDisable)(what); }
void turn(GLenum what, GLint index, bool on) { (on ? glEnablei : glDisablei)(what, static_cast<GLuint>(index)); }
GLenum named(GLint value) { return static_cast<GLenum>(value); }

struct Range {
    GLint buffer = 0;
    GLint64 start = 0, size = 0;

    static Range of(GLenum binding, GLenum start, GLenum size, GLint index) {
        Range r{number(binding, index), 0, 0};
        glGetInteger64i_v(start, static_cast<GLuint>(index), &r.start);
        glGetInteger64i_v(size, static_cast<GLuint>(index), &r.size);
        return r;
    }
    void bind(GLenum target, GLint index) const {
        if (buffer != 0 && size > 0)
            glBindBufferRange(target, static_cast<GLuint>(index), static_cast<GLuint>(buffer), start, size);
        else
            glBindBufferBase(target, static_cast<GLuint>(index), static_cast<GLuint>(buffer));
    }
};

struct Blend {
    bool on = false;
    GLint sourceColour = GL_ONE, targetColour = GL_ZERO, sourceAlpha = GL_ONE, targetAlpha = GL_ZERO;
    GLint colourEquation = GL_FUNC_ADD, alphaEquation = GL_FUNC_ADD;
    std::array<GLboolean, 4> mask = {};
};

struct Image {
    GLint name = 0, level = 0, layered = 0, layer = 0, access = GL_READ_ONLY, format = GL_R8;
};

struct Unit {
    std::array<GLint, std::size(kTextures)> textures = {};
    GLint sampler = 0;
};

struct View {
    std::array<GLfloat, 4> box = {};
    std::array<GLint, 4> scissor = {};
    std::array<GLdouble, 2> depth = {};
    bool scissors = false;
};

}  // namespace

struct HostState::Kept {
    bool old = false;  // a compatibility context
    std::array<bool, std::size(kSwitches)> switches = {};
    std::array<bool, std::size(kOldSwitches)> oldSwitches = {};
    std::array<bool, kClipDistances> clips = {};
    GLint clampVertex = 0, clampFragment = 0, clampRead = 0;
    std::array<GLint, std::size(kPixelStore)> pixels = {};
    std::array<GLfloat, std::size(kPixelTransfer)> transfers = {};
    std::vector<Blend> blends;
    std::array<GLfloat, 4> blendColour = {};
    std::vector<View> views;
    GLint depthFunction = GL_LESS, depthMask = 1, cullFace = GL_BACK, frontFace = GL_CCW;
    std::array<GLint, 2> polygonMode = {};
    GLint clipOrigin = 0, clipDepth = 0, provoking = 0;
    GLint program = 0, pipeline = 0, vertexArray = 0, drawFramebuffer = 0, readFramebuffer = 0, activeTexture = 0;
    std::array<GLint, std::size(kBuffers)> buffers = {};
    std::array<Unit, kUnits> units = {};
    std::array<Image, kImages> images = {};
    std::array<Range, kStorage> storage = {};
    std::array<Range, kUniform> uniform = {};
    GLint anyStorage = 0, anyUniform = 0;

    void take();
    void put() const;
};

void HostState::Kept::take() {
    old = (number(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_COMPATIBILITY_PROFILE_BIT) != 0;
    for (size_t k = 0; k < switches.size(); ++k) switches[k] = glIsEnabled(kSwitches[k]) != 0;
    for (size_t k = 0; old && k < oldSwitches.size(); ++k) oldSwitches[k] = glIsEnabled(kOldSwitches[k]) != 0;
    for (size_t k = 0; k < clips.size(); ++k) clips[k] = glIsEnabled(GL_CLIP_DISTANCE0 + static_cast<GLenum>(k)) != 0;
    if (old) clampVertex = number(kClampVertex);
    if (old) clampFragment = number(kClampFragment);
    clampRead = number(GL_CLAMP_READ_COLOR);
    for (size_t k = 0; k < pixels.size(); ++k) pixels[k] = number(kPixelStore[k].first);
    for (size_t k = 0; old && k < transfers.size(); ++k) glGetFloatv(kPixelTransfer[k].first, &transfers[k]);
    blends.resize(static_cast<size_t>(number(GL_MAX_DRAW_BUFFERS)));
    for (size_t k = 0; k < blends.size(); ++k) {
        const auto i = static_cast<GLint>(k);
        Blend& b = blends[k];
        b.on = glIsEnabledi(GL_BLEND, static_cast<GLuint>(k)) != 0;
        b.sourceColour = number(GL_BLEND_SRC_RGB, i);
        b.targetColour = number(GL_BLEND_DST_RGB, i);
        b.sourceAlpha = number(GL_BLEND_SRC_ALPHA, i);
        b.targetAlpha = number(GL_BLEND_DST_ALPHA, i);
        b.colourEquation = number(GL_BLEND_EQUATION_RGB, i);
        b.alphaEquation = number(GL_BLEND_EQUATION_ALPHA, i);
        glGetBooleani_v(GL_COLOR_WRITEMASK, static_cast<GLuint>(k), b.mask.data());
    }
    glGetFloatv(GL_BLEND_COLOR, blendColour.data());
    views.resize(static_cast<size_t>(number(GL_MAX_VIEWPORTS)));
    for (size_t k = 0; k < views.size(); ++k) {
        const auto i = static_cast<GLuint>(k);
        glGetFloati_v(GL_VIEWPORT, i, views[k].box.data());
        glGetIntegeri_v(GL_SCISSOR_BOX, i, views[k].scissor.data());
        glGetDoublei_v(GL_DEPTH_RANGE, i, views[k].depth.data());
        views[k].scissors = glIsEnabledi(GL_SCISSOR_TEST, i) != 0;
    }
    depthFunction = number(GL_DEPTH_FUNC);
    depthMask = number(GL_DEPTH_WRITEMASK);
    cullFace = number(GL_CULL_FACE_MODE);
    frontFace = number(GL_FRONT_FACE);
    glGetIntegerv(GL_POLYGON_MODE, polygonMode.data());
    if (!old) polygonMode[1] = polygonMode[0];  // a core context has one
    clipOrigin = number(GL_CLIP_ORIGIN);
    clipDepth = number(GL_CLIP_DEPTH_MODE);
    provoking = number(GL_PROVOKING_VERTEX);
    program = number(GL_CURRENT_PROGRAM);
    pipeline = number(GL_PROGRAM_PIPELINE_BINDING);
    vertexArray = number(GL_VERTEX_ARRAY_BINDING);
    drawFramebuffer = number(GL_DRAW_FRAMEBUFFER_BINDING);
    readFramebuffer = number(GL_READ_FRAMEBUFFER_BINDING);
    for (size_t k = 0; k < buffers.size(); ++k) buffers[k] = number(kBuffers[k].second);
    activeTexture = number(GL_ACTIVE_TEXTURE);
    for (GLint u = 0; u < kUnits; ++u) {
        Unit& unit = units[static_cast<size_t>(u)];
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(u));
        for (size_t k = 0; k < unit.textures.size(); ++k) unit.textures[k] = number(kTextures[k].second);
        unit.sampler = number(GL_SAMPLER_BINDING);
    }
    for (GLint k = 0; k < kImages; ++k)
        images[static_cast<size_t>(k)] = {number(GL_IMAGE_BINDING_NAME, k),    number(GL_IMAGE_BINDING_LEVEL, k),
                                          number(GL_IMAGE_BINDING_LAYERED, k), number(GL_IMAGE_BINDING_LAYER, k),
                                          number(GL_IMAGE_BINDING_ACCESS, k),  number(GL_IMAGE_BINDING_FORMAT, k)};
    for (GLint k = 0; k < kStorage; ++k)
        storage[static_cast<size_t>(k)] =
            Range::of(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE, k);
    for (GLint k = 0; k < kUniform; ++k)
        uniform[static_cast<size_t>(k)] = Range::of(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, k);
    anyStorage = number(GL_SHADER_STORAGE_BUFFER_BINDING);
    anyUniform = number(GL_UNIFORM_BUFFER_BINDING);
}

void HostState::Kept::put() const {
    for (GLint k = 0; k < kUniform; ++k) uniform[static_cast<size_t>(k)].bind(GL_UNIFORM_BUFFER, k);
    for (GLint k = 0; k < kStorage; ++k) storage[static_cast<size_t>(k)].bind(GL_SHADER_STORAGE_BUFFER, k);
    glBindBuffer(GL_UNIFORM_BUFFER, static_cast<GLuint>(anyUniform));
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(anyStorage));
    for (GLint k = 0; k < kImages; ++k) {
        const Image& i = images[static_cast<size_t>(k)];
        glBindImageTexture(static_cast<GLuint>(k), static_cast<GLuint>(i.name), i.level, static_cast<GLboolean>(i.layered), i.layer,
                           named(i.access), named(i.format));
    }
    for (GLint u = 0; u < kUnits; ++u) {
        const Unit& unit = units[static_cast<size_t>(u)];
        glBindTextureUnit(static_cast<GLuint>(u), 0);
        glBindSampler(static_cast<GLuint>(u), static_cast<GLuint>(unit.sampler));
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(u));
        for (size_t k = 0; k < unit.textures.size(); ++k)
            if (unit.textures[k] != 0) glBindTexture(kTextures[k].first, static_cast<GLuint>(unit.textures[k]));
    }
    glActiveTexture(named(activeTexture));
    glBindVertexArray(static_cast<GLuint>(vertexArray));
    for (size_t k = 0; k < buffers.size(); ++k) glBindBuffer(kBuffers[k].first, static_cast<GLuint>(buffers[k]));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawFramebuffer));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(readFramebuffer));
    glUseProgram(static_cast<GLuint>(program));
    glBindProgramPipeline(static_cast<GLuint>(pipeline));
    glProvokingVertex(named(provoking));
    glClipControl(named(clipOrigin), named(clipDepth));
    if (polygonMode[0] == polygonMode[1]) {
        glPolygonMode(GL_FRONT_AND_BACK, named(polygonMode[0]));
    } else {
        glPolygonMode(GL_FRONT, named(polygonMode[0]));
        glPolygonMode(GL_BACK, named(polygonMode[1]));
    }
    glFrontFace(named(frontFace));
    glCullFace(named(cullFace));
    glDepthMask(static_cast<GLboolean>(depthMask));
    glDepthFunc(named(depthFunction));
    for (size_t k = 0; k < views.size(); ++k) {
        const auto i = static_cast<GLuint>(k);
        glViewportIndexedfv(i, views[k].box.data());
        glScissorIndexedv(i, views[k].scissor.data());
        glDepthRangeIndexed(i, views[k].depth[0], views[k].depth[1]);
        turn(GL_SCISSOR_TEST, static_cast<GLint>(k), views[k].scissors);
    }
    glBlendColor(blendColour[0], blendColour[1], blendColour[2], blendColour[3]);
    for (size_t k = 0; k < blends.size(); ++k) {
        const auto i = static_cast<GLuint>(k);
        const Blend& b = blends[k];
        turn(GL_BLEND, static_cast<GLint>(k), b.on);
        glBlendFuncSeparatei(i, named(b.sourceColour), named(b.targetColour), named(b.sourceAlpha), named(b.targetAlpha));
        glBlendEquationSeparatei(i, named(b.colourEquation), named(b.alphaEquation));
        glColorMaski(i, b.mask[0], b.mask[1], b.mask[2], b.mask[3]);
    }
    for (size_t k = 0; k < pixels.size(); ++k) glPixelStorei(kPixelStore[k].first, pixels[k]);
    if (const PixelTransfer transfer = old ? pixelTransfer() : nullptr; transfer != nullptr)
        for (size_t k = 0; k < transfers.size(); ++k) transfer(kPixelTransfer[k].first, transfers[k]);
    glClampColor(GL_CLAMP_READ_COLOR, named(clampRead));
    if (old) glClampColor(kClampVertex, named(clampVertex));
    if (old) glClampColor(kClampFragment, named(clampFragment));
    for (size_t k = 0; k < clips.size(); ++k) turn(GL_CLIP_DISTANCE0 + static_cast<GLenum>(k), clips[k]);
    for (size_t k = 0; old && k < oldSwitches.size(); ++k) turn(kOldSwitches[k], oldSwitches[k]);
    for (size_t k = 0; k < switches.size(); ++k) turn(kSwitches[k], switches[k]);
}

HostState::HostState() : kept_(std::make_unique<Kept>()) {
    ASSERT(loaded(), "call rivulet::gpu::load first, with a function that finds OpenGL's functions, for example glfwGetProcAddress");
    kept_->take();
    Kept plain;
    plain.old = kept_->old;
    plain.pixels = {};
    for (size_t k = 0; k < plain.pixels.size(); ++k) plain.pixels[k] = kPixelStore[k].second;
    for (size_t k = 0; k < plain.transfers.size(); ++k) plain.transfers[k] = kPixelTransfer[k].second;
    plain.clampVertex = plain.clampFragment = GL_FALSE;
    plain.clampRead = kept_->clampRead;
    plain.blends.resize(kept_->blends.size());
    for (Blend& b : plain.blends) b.mask = {GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE};
    plain.views = kept_->views;  // set by each draw call
    for (View& v : plain.views) v.scissors = false;
    for (View& v : plain.views) v.depth = {0.0, 1.0};
    plain.polygonMode = {GL_FILL, GL_FILL};
    plain.clipOrigin = GL_LOWER_LEFT;
    plain.clipDepth = GL_NEGATIVE_ONE_TO_ONE;
    plain.provoking = GL_LAST_VERTEX_CONVENTION;
    plain.drawFramebuffer = kept_->drawFramebuffer;
    plain.readFramebuffer = kept_->readFramebuffer;
    plain.activeTexture = GL_TEXTURE0;
    plain.put();
}

HostState::~HostState() { kept_->put(); }

}  // namespace rivulet::gpu
