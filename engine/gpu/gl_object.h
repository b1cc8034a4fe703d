// GlObject: a move-only owner of a GL object name; Buffer, Texture, ... use it.
//
// Everything in engine/gpu needs a current OpenGL 4.5 context when it is created, used and destroyed; contexts that share objects count as
// the same one. Once the context has ended it is destroyed within a LostContext. The headers do not include OpenGL: a host may use any
// loader. GL names and enumerants are `unsigned`.
#pragma once

#include <utility>

#include "engine/gpu/lost_context.h"

namespace rivulet::gpu {

// kDelete(name) deletes the GL object.
template <void (*kDelete)(unsigned)>
class GlObject {
  public:
    GlObject() = default;
    explicit GlObject(unsigned name) : name_(name) {}
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
    unsigned name() const { return name_; }
    unsigned release() { return std::exchange(name_, 0); }  // the caller owns the object now
    explicit operator bool() const { return name_ != 0; }

  private:
    unsigned name_ = 0;
};

void deleteBuffer(unsigned name);
void deleteTexture(unsigned name);
void deleteSampler(unsigned name);
void deleteFramebuffer(unsigned name);
void deleteVertexArray(unsigned name);
void deleteQuery(unsigned name);
void deleteShader(unsigned name);
void deleteProgram(unsigned name);

using BufferName = GlObject<deleteBuffer>;
using TextureName = GlObject<deleteTexture>;
using SamplerName = GlObject<deleteSampler>;
using FramebufferName = GlObject<deleteFramebuffer>;
using VertexArrayName = GlObject<deleteVertexArray>;
using QueryName = GlObject<deleteQuery>;
using ShaderName = GlObject<deleteShader>;
using ProgramName = GlObject<deleteProgram>;

}  // namespace rivulet::gpu
