// HostPicture: converts a host's picture to linear radiance and Rivulet's window depth, and writes the result back into the host's
// framebuffer where there is water. Any format, number of samples and depth convention.
#pragma once

#include "engine/gpu/framebuffer.h"
#include "engine/gpu/program.h"
#include "engine/gpu/vertex_array.h"
#include "engine/render/frame_view.h"
#include "fluid/render/host_target.h"

namespace rivulet {

// The host's depth convention, read from OpenGL before gpu::HostState changes its state.
struct HostDepth {
    bool zeroToOne = false, upperLeft = false;  // glClipControl: GL_ZERO_TO_ONE, GL_UPPER_LEFT
    float near = 0, far = 1;                    // glDepthRange
    static HostDepth current();
};

class HostPicture {
  public:
    // Error (failed): a shader does not compile.
    static Result<HostPicture> create(const ShaderFiles& files);

    // Error (badInput): transform feedback is active, or a query that would count these draws. Conditional rendering cannot be detected.
    // Call it before gpu::HostState.
    static Status nothingUnderWay();
    // Fetches the scene, in the plain state that gpu::HostState makes. Error (badInput): a target of no size, that is incomplete, without a
    // colour or of whole numbers; a view that is not finite or scales; a projection that is not a perspective; GL_UPPER_LEFT. (failed): out
    // of memory; a depth that cannot be copied.
    Status take(const HostTarget& target, const HostDepth& depth, const FrameView& host);
    const FrameView& view() const { return view_; }         // the host's, with Rivulet's depth convention and the target's size
    const gpu::Texture& colour() const { return colour_; }  // rgba16f, linear radiance
    const gpu::Texture& depth() const { return depth_; }    // depth32f, window depth by view()'s projection
    size_t bytes() const;                                   // of its textures
    void limit(size_t bytes) { most_ = bytes; }             // the limit of bytes(): take() fails beyond it

    // Puts a picture into the target where it differs from colour(), and its depth: that of water, `fluidDepth` (m; 1e6 where there is
    // none), or null: depth().
    void give(const gpu::Texture& picture, const gpu::Texture* fluidDepth);

  private:
    Status fit(int width, int height);
    Status takeDepth(const HostTarget& target);

    HostTarget target_;
    HostDepth hostDepth_;
    vec2 hostPlanes_{0.0F};  // [2][2] and [3][2] of the host's projection
    FrameView view_;
    bool linear_ = false, depthThere_ = false;
    gpu::Program in_, out_, outOpaque_;
    gpu::TextureName rawDepth_;
    gpu::FramebufferName rawFramebuffer_;
    unsigned rawFormat_ = 0;
    gpu::Texture raw_, colour_, depth_;
    gpu::VertexArray none_;
    size_t most_ = SIZE_MAX;
};

}  // namespace rivulet
