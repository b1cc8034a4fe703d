// HostPicture: what a host has drawn so far, as our passes want it: linear radiance and our own window depth; and the way back, into the
// host's framebuffer, only where water is. Whatever the host's formats, samples and depth conventions are.
#pragma once

#include "engine/gpu/framebuffer.h"
#include "engine/gpu/program.h"
#include "engine/gpu/vertex_array.h"
#include "engine/render/frame_view.h"
#include "fluid/render/host_target.h"

namespace rivulet {

// How the host's depths come about; asked of OpenGL while its state is still the host's own.
struct HostDepth {
    bool zeroToOne = false, upperLeft = false;  // glClipControl: GL_ZERO_TO_ONE, GL_UPPER_LEFT
    float near = 0, far = 1;                    // glDepthRange
    static HostDepth current();
};

class HostPicture {
  public:
    // Error (failed): a shader does not compile.
    static Result<HostPicture> create(const ShaderFiles& files);

    // Error (badInput): the host has transform feedback under way, or a query that would count what we draw. Conditional rendering cannot
    // be asked for. Before gpu::HostState.
    static Status nothingUnderWay();
    // Fetches the scene, in the plain state that gpu::HostState makes. Error (badInput): a target of no size, that is incomplete, without a
    // colour or of whole numbers; a view that is not finite or scales; a projection that is not a perspective; GL_UPPER_LEFT. (failed): out
    // of memory; a depth that cannot be copied.
    Status take(const HostTarget& target, const HostDepth& depth, const FrameView& host);
    const FrameView& view() const { return view_; }         // the host's, with our way of depths, and the target's size
    const gpu::Texture& colour() const { return colour_; }  // rgba16f, linear radiance
    const gpu::Texture& depth() const { return depth_; }    // depth32f, window depth by view()'s projection
    size_t bytes() const;                                   // of its textures
    void limit(size_t bytes) { most_ = bytes; }             // take() fails rather than hold more

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
    GLenum rawFormat_ = 0;
    gpu::Texture raw_, colour_, depth_;
    gpu::VertexArray none_;
    size_t most_ = SIZE_MAX;
};

}  // namespace rivulet
