// GlObject: a move-only owner of a GL object name; Buffer, Texture, ... use it.
//
// Everything in engine/gpu needs a current OpenGL 4.5 context when it is created, used and destroyed; contexts that share objects count as
// the same one. Once the context has ended it is destroyed within a LostContext.
#pragma once

#include <rivulet_glad/gl.h>

#include <utility>

#include "engine/gpu/lost_context.h"

namespace rivulet::gpu {

// kDelete(name) deletes the GL object.
template <void (*kDelete)(GLuint)>
class GlObject {
  public:
    GlObject() = default;
    explicit GlObject(GLuint name) : name_(name) {}
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        GlObject moved(std::move(other));
        std::swap(name_, moved.name_);
        return *this;
    }
    GlObject(const GlObject&) = delete;
    GlObject& operator=(const GlObject&) = delete;
    ~GlObject() {
        if (name_ != 0 && !LostContext::here()) kDelete(name_);
    }
    GLuint name() const { return name_; }
    GLuint release() { return std::exchange(name_, 0); }  // the caller owns the object now
    explicit operator bool() const { return name_ != 0; }

  private:
    GLuint name_ = 0;
};

inline void deleteBuffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void deleteTexture(GLuint name) { glDeleteTextures(1, &name); }
inline void deleteSampler(GLuint name) { glDeleteSamplers(1, &name); }
inline void deleteFramebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
inline void deleteVertexArray(GLuint name) { glDeleteVertexArrays(1, &name); }
inline void deleteQuery(GLuint name) { glDeleteQueries(1, &name); }
inline void deleteShader(GLuint name) { glDeleteShader(name); }
inline void deleteProgram(GLuint name) { glDeleteProgram(name); }

using BufferName = GlObject<deleteBuffer>;
using TextureName = GlObject<deleteTexture>;
using SamplerName = GlObject<deleteSampler>;
using FramebufferName = GlObject<deleteFramebuffer>;
using VertexArrayName = GlObject<deleteVertexArray>;
using QueryName = GlObject<deleteQuery>;
using ShaderName = GlObject<deleteShader>;
using ProgramName = GlObject<deleteProgram>;

}  // namespace rivulet::gpu
