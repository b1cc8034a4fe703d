// HostPicture: converts a host's picture to linear radiance and Rivulet's window depth, and writes the result back into the host's
// framebuffer where there is water. Any format, number of samples and depth convention.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/gpu/framebuffer.h"
#include "engine/gpu/program.h"
#include "engine/gpu/vertex_array.h"
#include "fluid/render/host_target.h"
#include "fluid/render/host_view.h"

namespace rivulet {

class HostPicture {
  public:
    // Error (failed): a shader does not compile.
    static Result<HostPicture> create(const ShaderFiles& files);

    // Error (badInput): transform feedback is active, or a query that would count these draws. Conditional rendering cannot be detected.
    static Status nothingUnderWay();
    // Fetches the scene, in the plain state that gpu::HostState makes. Error (badInput): a target of no size, that is incomplete, without a
    // colour or of whole numbers; as HostView::of. (failed): out of memory; a depth that cannot be copied.
    Status take(const HostTarget& target, const gpu::HostDepth& depth, const FrameView& host);
    const FrameView& view() const { return seen_.view; }         // the host's, in Rivulet's convention, of the target's size
    const gpu::Texture& colour() const { return now_->colour; }  // rgba16f, linear radiance
    const gpu::Texture& depth() const { return now_->depth; }    // depth32f, window depth by view()'s projection
    size_t bytes() const;                                        // of its textures: of each size that was drawn lately
    void limit(size_t bytes) { most_ = bytes; }                  // the limit of bytes(): take() fails beyond it

    // Puts a picture into the target where it differs from colour(), and its depth: that of water, `fluidDepth` (m; 1e6 where there is
    // none), or null: depth().
    void give(const gpu::Texture& picture, const gpu::Texture* fluidDepth);

  private:
    Status fit(int width, int height);
    vec2 planes() const { return {seen_.view.projection[2][2], seen_.view.projection[3][2]}; }
    Status takeDepth(const HostTarget& target);
    void limitOutputs();
    void freeOutputs();
    void setUniforms(gpu::Program& program) const;  // of host.glsl, the same in both directions

    HostTarget target_;
    gpu::HostDepth hostDepth_;
    HostView seen_;
    bool linear_ = false;
    gpu::Program in_, out_, outOpaque_;
    // The textures of one size, kept while targets of that size are drawn to.
    struct RawDepth {  // in the host's own format
        unsigned format = 0;
        gpu::TextureName texture;
        gpu::FramebufferName framebuffer;
    };
    struct Pictures {
        gpu::Texture raw, colour, depth;
        gpu::Framebuffer rawTarget, target;  // of raw; of colour and depth
        std::vector<RawDepth> rawDepths;
        uint64_t used = 0;
        size_t bytes() const;
    };
    std::vector<std::unique_ptr<Pictures>> all_;
    Pictures* now_ = nullptr;
    unsigned rawDepth_ = 0;  // of now_; 0: the host has no depth
    uint64_t draws_ = 0;
    int mostOutputs_ = 0;
    struct Output {
        unsigned index = 0;
        std::array<unsigned char, 4> mask{};
    };
    std::vector<Output> masked_;  // the host's draw buffers that are not written
    gpu::VertexArray none_;
    size_t most_ = SIZE_MAX;
};

}  // namespace rivulet
