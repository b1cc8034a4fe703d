#include "engine/gpu/host_state.h"

#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/core/assert.h"
#include "engine/gpu/gl_error.h"
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
                                GL_POLYGON_SMOOTH,
                                GL_FRAMEBUFFER_SRGB,
                                GL_RASTERIZER_DISCARD,
                                GL_COLOR_LOGIC_OP,
                                GL_SAMPLE_ALPHA_TO_COVERAGE,
                                GL_SAMPLE_ALPHA_TO_ONE,
                                GL_SAMPLE_COVERAGE,
                                GL_SAMPLE_MASK,
                                GL_SAMPLE_SHADING,
                                GL_PRIMITIVE_RESTART,
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

// `used`: it affects what Rivulet does, or Rivulet binds it.
constexpr struct {
    GLenum target, binding;
    bool used;
} kBuffers[] = {{GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING, false},
                {GL_COPY_READ_BUFFER, GL_COPY_READ_BUFFER_BINDING, false},
                {GL_COPY_WRITE_BUFFER, GL_COPY_WRITE_BUFFER_BINDING, false},
                {GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING, true},
                {GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING, true},
                {GL_DRAW_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER_BINDING, false},
                {GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING, false},
                {GL_QUERY_BUFFER, GL_QUERY_BUFFER_BINDING, true},
                {GL_TEXTURE_BUFFER, GL_TEXTURE_BUFFER_BINDING, false}};

// Binding points that Rivulet uses. Its passes bind 2D textures to the first range and the surroundings to the second; rows of particles
// are buffer textures of the third.
struct Units {
    GLuint first, count;
    GLenum target;
};
constexpr Units kUnits[] = {{0, 12, GL_TEXTURE_2D}, {16, 1, GL_TEXTURE_2D}, {24, 7, GL_TEXTURE_BUFFER}};
// Of the textures that Rivulet binds to it; 0: none.
constexpr GLenum targetOf(GLuint unit) {
    for (const Units& range : kUnits)
        if (unit >= range.first && unit < range.first + range.count) return range.target;
    return 0;
}
constexpr GLuint kAllUnits = 32, kImages = 8, kStorage = 8, kUniform = 4;
constexpr GLuint kDrawBuffers = 2;  // that a pass blends or masks

GLint number(GLenum what) {
    GLint value = 0;
    glGetIntegerv(what, &value);
    return value;
}
GLint number(GLenum what, GLuint index) {
    GLint value = 0;
    glGetIntegeri_v(what, index, &value);
    return value;
}
void turn(GLenum what, bool on) { (on ? glEnable : glDisable)(what); }
void turn(GLenum what, GLuint index, bool on) { (on ? glEnablei : glDisablei)(what, index); }
GLenum named(GLint value) { return static_cast<GLenum>(value); }

// What is bound to an indexed target.
struct Range {
    GLint buffer = 0;
    GLint64 start = 0, size = 0;

    static Range of(GLenum binding, GLenum start, GLenum size, GLuint index) {
        Range r{number(binding, index), 0, 0};
        if (r.buffer == 0) return r;
        glGetInteger64i_v(start, index, &r.start);
        glGetInteger64i_v(size, index, &r.size);
        return r;
    }
    void bind(GLenum target, GLuint index) const {
        if (buffer != 0 && size > 0)
            glBindBufferRange(target, index, static_cast<GLuint>(buffer), start, size);
        else
            glBindBufferBase(target, index, static_cast<GLuint>(buffer));
    }
};

struct Blend {
    bool on = false;
    GLint sourceColour = GL_ONE, targetColour = GL_ZERO, sourceAlpha = GL_ONE, targetAlpha = GL_ZERO;
    GLint colourEquation = GL_FUNC_ADD, alphaEquation = GL_FUNC_ADD;
    std::array<GLboolean, 4> mask = {GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE};
    bool operator==(const Blend&) const = default;
};

struct Image {
    GLint name = 0, level = 0, layered = 0, layer = 0, access = GL_READ_ONLY, format = GL_R8;
};

struct Unit {
    GLuint unit = 0;
    std::array<GLint, std::size(kTextures)> textures = {};  // of all targets, or only of one
    GLint sampler = 0;
};

struct View {
    std::array<GLfloat, 4> box = {};
    std::array<GLint, 4> scissor = {};
    std::array<GLdouble, 2> depth = {0, 1};
    bool scissors = false;
};

}  // namespace

// The state: that of the host, or the plain one that Rivulet expects. put() sets what differs from another.
struct HostState::Kept {
    Saves saves = rivulets;
    bool old = false;  // a compatibility context
    std::array<bool, std::size(kSwitches)> switches = {};
    std::array<bool, std::size(kOldSwitches)> oldSwitches = {};
    std::array<bool, kClipDistances> clips = {};
    GLint clampVertex = GL_FALSE, clampFragment = GL_FALSE;
    std::array<GLint, std::size(kPixelStore)> pixels = {};
    std::array<GLfloat, std::size(kPixelTransfer)> transfers = {};
    std::vector<Blend> blends;
    std::vector<View> views;
    GLint depthFunction = GL_LESS, depthMask = 1, cullFace = GL_BACK, frontFace = GL_CCW;
    std::array<GLint, 2> polygonMode = {GL_FILL, GL_FILL};
    GLint clipOrigin = GL_LOWER_LEFT, clipDepth = GL_NEGATIVE_ONE_TO_ONE, provoking = GL_LAST_VERTEX_CONVENTION;
    GLint program = 0, pipeline = 0, vertexArray = 0, drawFramebuffer = 0, readFramebuffer = 0, activeTexture = GL_TEXTURE0;
    std::array<GLint, std::size(kBuffers)> buffers = {};
    std::vector<Unit> units;
    std::vector<Image> images;
    std::vector<Range> storage, uniform;
    GLint anyStorage = 0, anyUniform = 0;
    HostDepth depth;

    bool all() const { return saves == everything; }
    void takeDepth();
    void take();
    static Kept plain(const Kept& host);
    void put(const Kept* known) const;
    void putBindings() const;
};

void HostState::Kept::takeDepth() {
    clipOrigin = number(GL_CLIP_ORIGIN);
    clipDepth = number(GL_CLIP_DEPTH_MODE);
    views.resize(1);
    glGetDoublei_v(GL_DEPTH_RANGE, 0, views[0].depth.data());
    depth = {.zeroToOne = clipDepth == GL_ZERO_TO_ONE,
             .upperLeft = clipOrigin == GL_UPPER_LEFT,
             .near = static_cast<float>(views[0].depth[0]),
             .far = static_cast<float>(views[0].depth[1])};
}

void HostState::Kept::take() {
    takeDepth();
    old = (number(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_COMPATIBILITY_PROFILE_BIT) != 0;
    for (size_t k = 0; k < switches.size(); ++k) switches[k] = glIsEnabled(kSwitches[k]) != 0;
    for (size_t k = 0; old && k < oldSwitches.size(); ++k) oldSwitches[k] = glIsEnabled(kOldSwitches[k]) != 0;
    for (size_t k = 0; k < clips.size(); ++k) clips[k] = glIsEnabled(GL_CLIP_DISTANCE0 + static_cast<GLenum>(k)) != 0;
    if (old) clampVertex = number(kClampVertex);
    if (old) clampFragment = number(kClampFragment);
    for (size_t k = 0; k < pixels.size(); ++k) pixels[k] = number(kPixelStore[k].first);
    for (size_t k = 0; old && k < transfers.size(); ++k) glGetFloatv(kPixelTransfer[k].first, &transfers[k]);
    blends.resize(all() ? static_cast<size_t>(number(GL_MAX_DRAW_BUFFERS)) : kDrawBuffers);
    for (size_t k = 0; k < blends.size(); ++k) {
        const auto i = static_cast<GLuint>(k);
        Blend& b = blends[k];
        b.on = glIsEnabledi(GL_BLEND, i) != 0;
        b.sourceColour = number(GL_BLEND_SRC_RGB, i);
        b.targetColour = number(GL_BLEND_DST_RGB, i);
        b.sourceAlpha = number(GL_BLEND_SRC_ALPHA, i);
        b.targetAlpha = number(GL_BLEND_DST_ALPHA, i);
        b.colourEquation = number(GL_BLEND_EQUATION_RGB, i);
        b.alphaEquation = number(GL_BLEND_EQUATION_ALPHA, i);
        glGetBooleani_v(GL_COLOR_WRITEMASK, i, b.mask.data());
    }
    views.resize(all() ? static_cast<size_t>(number(GL_MAX_VIEWPORTS)) : 1);
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
    provoking = number(GL_PROVOKING_VERTEX);
    program = number(GL_CURRENT_PROGRAM);
    pipeline = number(GL_PROGRAM_PIPELINE_BINDING);
    vertexArray = number(GL_VERTEX_ARRAY_BINDING);
    drawFramebuffer = number(GL_DRAW_FRAMEBUFFER_BINDING);
    readFramebuffer = number(GL_READ_FRAMEBUFFER_BINDING);
    for (size_t k = 0; k < buffers.size(); ++k)
        if (all() || kBuffers[k].used) buffers[k] = number(kBuffers[k].binding);
    activeTexture = number(GL_ACTIVE_TEXTURE);
    const auto takeUnit = [&](GLuint at, GLenum only) {
        Unit unit{.unit = at};
        glActiveTexture(GL_TEXTURE0 + at);
        for (size_t k = 0; k < unit.textures.size(); ++k)
            if (only == 0 || kTextures[k].first == only) unit.textures[k] = number(kTextures[k].second);
        unit.sampler = number(GL_SAMPLER_BINDING);
        units.push_back(unit);
    };
    units.reserve(kAllUnits);
    for (GLuint u = 0; all() && u < kAllUnits; ++u) takeUnit(u, 0);
    for (const Units& range : kUnits)
        for (GLuint k = 0; !all() && k < range.count; ++k) takeUnit(range.first + k, range.target);
    images.resize(all() ? kImages : 0);
    for (GLuint k = 0; k < images.size(); ++k)
        images[k] = {number(GL_IMAGE_BINDING_NAME, k),  number(GL_IMAGE_BINDING_LEVEL, k),  number(GL_IMAGE_BINDING_LAYERED, k),
                     number(GL_IMAGE_BINDING_LAYER, k), number(GL_IMAGE_BINDING_ACCESS, k), number(GL_IMAGE_BINDING_FORMAT, k)};
    storage.resize(kStorage);
    for (GLuint k = 0; k < kStorage; ++k)
        storage[k] = Range::of(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE, k);
    uniform.resize(kUniform);
    for (GLuint k = 0; k < kUniform; ++k)
        uniform[k] = Range::of(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, k);
    anyStorage = number(GL_SHADER_STORAGE_BUFFER_BINDING);
    anyUniform = number(GL_UNIFORM_BUFFER_BINDING);
}

// Bindings that Rivulet may have changed.
void HostState::Kept::putBindings() const {
    for (GLuint k = 0; k < uniform.size(); ++k) uniform[k].bind(GL_UNIFORM_BUFFER, k);
    for (GLuint k = 0; k < storage.size(); ++k) storage[k].bind(GL_SHADER_STORAGE_BUFFER, k);
    glBindBuffer(GL_UNIFORM_BUFFER, static_cast<GLuint>(anyUniform));
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(anyStorage));
    for (GLuint k = 0; k < images.size(); ++k) {
        const Image& i = images[k];
        glBindImageTexture(k, static_cast<GLuint>(i.name), i.level, static_cast<GLboolean>(i.layered), i.layer, named(i.access),
                           named(i.format));
    }
    for (const Unit& unit : units) {
        if (all()) glBindTextureUnit(unit.unit, 0);
        glActiveTexture(GL_TEXTURE0 + unit.unit);
        for (size_t k = 0; k < unit.textures.size(); ++k)
            if (unit.textures[k] != 0 || (!all() && kTextures[k].first == targetOf(unit.unit)))
                glBindTexture(kTextures[k].first, static_cast<GLuint>(unit.textures[k]));
    }
    glActiveTexture(named(activeTexture));
    glBindVertexArray(static_cast<GLuint>(vertexArray));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawFramebuffer));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(readFramebuffer));
    glUseProgram(static_cast<GLuint>(program));
    for (size_t k = 0; k < views.size(); ++k) glViewportIndexedfv(static_cast<GLuint>(k), views[k].box.data());
}

// Of the rest, what is not as in `known`; null: everything.
void HostState::Kept::put(const Kept* known) const {
    const bool any = known == nullptr;
    const Kept& now = any ? *this : *known;
    if (any || pipeline != now.pipeline) glBindProgramPipeline(static_cast<GLuint>(pipeline));
    for (size_t k = 0; k < buffers.size(); ++k)
        if (any ? all() || kBuffers[k].used : buffers[k] != now.buffers[k])
            glBindBuffer(kBuffers[k].target, static_cast<GLuint>(buffers[k]));
    for (size_t k = 0; k < units.size(); ++k)
        if (any || units[k].sampler != now.units[k].sampler) glBindSampler(units[k].unit, static_cast<GLuint>(units[k].sampler));
    if (any || provoking != now.provoking) glProvokingVertex(named(provoking));
    if (any || clipOrigin != now.clipOrigin || clipDepth != now.clipDepth) glClipControl(named(clipOrigin), named(clipDepth));
    const bool mode = any || polygonMode != now.polygonMode;
    if (mode && polygonMode[0] == polygonMode[1]) {
        glPolygonMode(GL_FRONT_AND_BACK, named(polygonMode[0]));
    } else if (mode) {
        glPolygonMode(GL_FRONT, named(polygonMode[0]));
        glPolygonMode(GL_BACK, named(polygonMode[1]));
    }
    if (any || frontFace != now.frontFace) glFrontFace(named(frontFace));
    if (any || cullFace != now.cullFace) glCullFace(named(cullFace));
    if (any || depthMask != now.depthMask) glDepthMask(static_cast<GLboolean>(depthMask));
    if (any || depthFunction != now.depthFunction) glDepthFunc(named(depthFunction));
    for (size_t k = 0; k < views.size(); ++k) {
        const auto i = static_cast<GLuint>(k);
        const View &v = views[k], &before = now.views[k];
        if (any || v.scissor != before.scissor) glScissorIndexedv(i, v.scissor.data());
        if (any || v.depth != before.depth) glDepthRangeIndexed(i, v.depth[0], v.depth[1]);
        if (any || v.scissors != before.scissors) turn(GL_SCISSOR_TEST, i, v.scissors);
    }
    for (size_t k = 0; k < blends.size(); ++k) {
        const auto i = static_cast<GLuint>(k);
        const Blend& b = blends[k];
        if (!any && b == now.blends[k]) continue;
        turn(GL_BLEND, i, b.on);
        glBlendFuncSeparatei(i, named(b.sourceColour), named(b.targetColour), named(b.sourceAlpha), named(b.targetAlpha));
        glBlendEquationSeparatei(i, named(b.colourEquation), named(b.alphaEquation));
        glColorMaski(i, b.mask[0], b.mask[1], b.mask[2], b.mask[3]);
    }
    for (size_t k = 0; k < pixels.size(); ++k)
        if (any || pixels[k] != now.pixels[k]) glPixelStorei(kPixelStore[k].first, pixels[k]);
    if (const PixelTransfer transfer = old ? pixelTransfer() : nullptr; transfer != nullptr)
        for (size_t k = 0; k < transfers.size(); ++k)
            if (any || transfers[k] != now.transfers[k]) transfer(kPixelTransfer[k].first, transfers[k]);
    if (old && (any || clampVertex != now.clampVertex)) glClampColor(kClampVertex, named(clampVertex));
    if (old && (any || clampFragment != now.clampFragment)) glClampColor(kClampFragment, named(clampFragment));
    for (size_t k = 0; k < clips.size(); ++k)
        if (any || clips[k] != now.clips[k]) turn(GL_CLIP_DISTANCE0 + static_cast<GLenum>(k), clips[k]);
    for (size_t k = 0; old && k < oldSwitches.size(); ++k)
        if (any || oldSwitches[k] != now.oldSwitches[k]) turn(kOldSwitches[k], oldSwitches[k]);
    for (size_t k = 0; k < switches.size(); ++k)
        if (any || switches[k] != now.switches[k]) turn(kSwitches[k], switches[k]);
}

// What Rivulet expects and leaves: OpenGL's defaults, and framebuffers, viewports and scissor boxes as they are.
HostState::Kept HostState::Kept::plain(const Kept& host) {
    Kept plain;
    plain.saves = host.saves;
    plain.old = host.old;
    for (size_t k = 0; k < plain.pixels.size(); ++k) plain.pixels[k] = kPixelStore[k].second;
    for (size_t k = 0; k < plain.transfers.size(); ++k) plain.transfers[k] = kPixelTransfer[k].second;
    plain.blends.resize(host.blends.size());
    plain.views = host.views;
    for (View& v : plain.views) v.scissors = false;
    for (View& v : plain.views) v.depth = {0.0, 1.0};
    plain.drawFramebuffer = host.drawFramebuffer;
    plain.readFramebuffer = host.readFramebuffer;
    plain.units = host.units;
    for (Unit& unit : plain.units) unit = {.unit = unit.unit};
    plain.images.resize(host.images.size());
    plain.storage.resize(host.storage.size());
    plain.uniform.resize(host.uniform.size());
    return plain;
}

HostState::HostState(Saves saves) : kept_(std::make_unique<Kept>()) {
    ASSERT(loaded(), "call rivulet::gpu::load first, with a function that finds OpenGL's functions, for example glfwGetProcAddress");
    kept_->saves = saves;
    if (saves != nothing) {
        kept_->take();
        plain_ = std::make_unique<Kept>(Kept::plain(*kept_));
        plain_->put(kept_.get());
        return;
    }
    kept_->takeDepth();
    kept_->blends.resize(kDrawBuffers);
    for (const Units& range : kUnits)
        for (GLuint k = 0; k < range.count; ++k) kept_->units.push_back({.unit = range.first + k});
    kept_->storage.resize(kStorage);
    kept_->uniform.resize(kUniform);
    plain_ = std::make_unique<Kept>(Kept::plain(*kept_));
    plain_->put(nullptr);
}

HostState::~HostState() {
    if (kept_->saves == nothing) {
        plain_->putBindings();
        return;
    }
    kept_->putBindings();
    kept_->put(kept_->all() ? nullptr : plain_.get());
}

const HostDepth& HostState::depth() const { return kept_->depth; }

BoundUnit::BoundUnit(unsigned unit, unsigned target) : unit_(unit), target_(target) {
    const GLenum active = named(number(GL_ACTIVE_TEXTURE));
    glActiveTexture(GL_TEXTURE0 + unit_);
    texture_ = number(target_ == GL_TEXTURE_CUBE_MAP ? GL_TEXTURE_BINDING_CUBE_MAP : GL_TEXTURE_BINDING_2D);
    sampler_ = number(GL_SAMPLER_BINDING);
    glActiveTexture(active);
}

BoundUnit::~BoundUnit() {
    const GLenum active = named(number(GL_ACTIVE_TEXTURE));
    glActiveTexture(GL_TEXTURE0 + unit_);
    glBindTexture(target_, static_cast<GLuint>(texture_));
    glBindSampler(unit_, static_cast<GLuint>(sampler_));
    glActiveTexture(active);
}

unsigned targetOfTexture(unsigned name) {
    if ((number(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_COMPATIBILITY_PROFILE_BIT) == 0) {
        GLint target = 0;
        glGetTextureParameteriv(name, GL_TEXTURE_TARGET, &target);
        return target == GL_TEXTURE_2D || target == GL_TEXTURE_CUBE_MAP ? named(target) : 0U;
    }
    // Mesa answers this query in core contexts alone. A texture can be bound to its own target alone.
    for (const GLenum target : {GL_TEXTURE_2D, GL_TEXTURE_CUBE_MAP}) {
        const BoundUnit unit(0, target);
        glActiveTexture(GL_TEXTURE0);
        clearGlErrors();
        glBindTexture(target, name);
        if (takeGlError() == GL_NO_ERROR) return target;
    }
    return 0;
}

}  // namespace rivulet::gpu
