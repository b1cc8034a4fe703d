#include "engine/gpu/pass_state.h"

#include <rivulet_glad/gl.h>

#include <initializer_list>

namespace rivulet::gpu {

namespace {
constexpr GLsizei kStageUnits = 16, kBindings = 8;  // what GL guarantees a stage
constexpr GLuint kColours = 2;                      // as PassState
}  // namespace

StateScope::StateScope() {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
    glGetFloati_v(GL_VIEWPORT, 0, viewport_);
}

StateScope::~StateScope() {
    set({});
    unbind();
}

void StateScope::set(const PassState& to) {
    const auto blends = [](const PassState& s) {
        return s.blendSource != GL_ONE || s.blendTarget != GL_ZERO || s.blendEquation != GL_FUNC_ADD;
    };
    if (to.depthTest != now_.depthTest) (to.depthTest ? glEnable : glDisable)(GL_DEPTH_TEST);
    if (to.depthFunction != now_.depthFunction) glDepthFunc(to.depthFunction);
    if (to.depthWrites != now_.depthWrites) glDepthMask(to.depthWrites ? GL_TRUE : GL_FALSE);
    for (GLuint k = 0; k < kColours; ++k) {
        const GLboolean writes = to.colourWrites ? GL_TRUE : GL_FALSE;
        if (to.colourWrites != now_.colourWrites) glColorMaski(k, writes, writes, writes, writes);
        if (blends(to) != blends(now_)) (blends(to) ? glEnablei : glDisablei)(GL_BLEND, k);
        if (to.blendSource != now_.blendSource || to.blendTarget != now_.blendTarget) glBlendFunci(k, to.blendSource, to.blendTarget);
        if (to.blendEquation != now_.blendEquation) glBlendEquationi(k, to.blendEquation);
    }
    now_ = to;
}

void StateScope::reset() {
    unbind();
    for (const GLenum capability : {GL_BLEND, GL_DEPTH_TEST, GL_DEPTH_CLAMP, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST,
                                    GL_PROGRAM_POINT_SIZE, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD})
        glDisable(capability);
    glBlendFunc(GL_ONE, GL_ZERO);
    glBlendEquation(GL_FUNC_ADD);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glBindTextures(0, kStageUnits, nullptr);
    glBindSamplers(0, kStageUnits, nullptr);
    glBindImageTextures(0, kBindings, nullptr);
    glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, kBindings, nullptr);
    now_ = {};
}

void StateScope::unbind() const {
    glUseProgram(0);
    glBindVertexArray(0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_));
    glViewportIndexedfv(0, viewport_);
}

}  // namespace rivulet::gpu
