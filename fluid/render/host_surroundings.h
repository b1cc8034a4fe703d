// SurroundingsMap: what water reflects in a host's scene, from an image or a texture of the host.
#pragma once

#include <cstddef>

#include "engine/compute/kernel_source.h"
#include "engine/core/result.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/program.h"
#include "engine/gpu/texture.h"
#include "engine/gpu/vertex_array.h"
#include "fluid/render/host_lighting.h"

namespace rivulet {

class SurroundingsMap {
  public:
    // In the plain state that gpu::HostState makes, as all that follows. Error (failed): a shader does not compile.
    static Result<SurroundingsMap> create(const ShaderFiles& files);

    // Blurs them on the GPU and does not wait for it. Error (badInput): none or two are given, a value of the image that is not finite or
    // is negative, a texture of another kind, a turn that is no rotation; (failed): out of memory, or beyond `mostBytes` with the
    // image while it is read. Then the ones before are kept.
    Status take(const HostSurroundings& from, size_t mostBytes);

    const gpu::Texture& map() const { return map_; }     // as makeEnvironmentMap()'s
    const gpu::Buffer& matte() const { return matte_; }  // FrameParams::matteLight
    size_t bytes() const { return map_ ? map_.desc().bytes() : 0; }

  private:
    void draw(gpu::Program& program, const gpu::Texture& into, int mip, unsigned target, unsigned texture, int level, int taps,
              const mat3& turn);

    gpu::Program flat_, cube_, blurred_, matteOf_;
    gpu::Sampler smooth_;
    gpu::VertexArray none_;
    gpu::Texture map_, harmonics_;
    gpu::Buffer matte_;
};

}  // namespace rivulet
