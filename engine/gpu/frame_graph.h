// FrameGraph: the passes of one frame. It does four things: leaves out passes whose results nobody needs, lends transient textures and
// buffers (two that are never alive together share memory), places glMemoryBarrier, and times each pass.
//
//     FrameGraph graph(pool);                                    // built anew each frame; the pool stays
//     TextureHandle depth = graph.texture("depth", desc);
//     graph.pass("depth", {{particles, Usage::attribute}}, {depth}, [=](PassContext& c) { c.drawTo({}, depth); ... });
//     TextureHandle picture = addShade(graph, depth);            // a Pass is a free function: handles in, handles out
//     graph.output(picture);
//     graph.execute();
//
// Passes run in the order they were added. Writing to a handle that has been written adds to it (a pass that replaces it clears it first);
// a transient's first writer finds undefined contents. After each pass the GL state that passes set is back at its defaults.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/compute/device.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/frame_graph_description.h"
#include "engine/gpu/framebuffer.h"
#include "engine/gpu/texture.h"

namespace rivulet::gpu {

// How a pass touches a resource. It decides the barriers: what shaders write by image or storage is not visible elsewhere without one.
enum class Usage {
    sampled,    // texture: texture(), texelFetch(); buffer: texelFetch() of a buffer texture
    image,      // texture: imageLoad, imageStore
    target,     // texture: drawn into; as a read: depth-tested against, not written
    storage,    // buffer: SSBO
    uniform,    // buffer: UBO
    attribute,  // buffer: vertex shader input
    index,      // buffer: element indices
    indirect,   // buffer: draw or dispatch arguments
    copy        // either: glCopy*, glClear*, upload, read
};

struct TextureHandle {
    uint32_t index = UINT32_MAX;
    explicit operator bool() const { return index != UINT32_MAX; }
};
struct BufferHandle {
    uint32_t index = UINT32_MAX;
    explicit operator bool() const { return index != UINT32_MAX; }
};
struct Read {
    Read(TextureHandle t, Usage u = Usage::sampled)
        : index(t.index), usage(u) {}  // NOLINT(google-explicit-constructor): pass("..", {depth}, ..)
    Read(BufferHandle b, Usage u = Usage::storage) : index(b.index), usage(u) {}  // NOLINT(google-explicit-constructor)
    uint32_t index;
    Usage usage;
};
struct Write {
    Write(TextureHandle t, Usage u = Usage::target) : index(t.index), usage(u) {}  // NOLINT(google-explicit-constructor)
    Write(BufferHandle b, Usage u = Usage::storage) : index(b.index), usage(u) {}  // NOLINT(google-explicit-constructor)
    uint32_t index;
    Usage usage;
};

// What a graph keeps between frames: textures and buffers to lend, timers. Those not lent for 8 frames are freed.
class TransientPool {
  public:
    TransientPool();
    TransientPool(TransientPool&&) noexcept;
    TransientPool& operator=(TransientPool&&) noexcept;
    ~TransientPool();

    // GPU time a pass, of the latest frame whose times have arrived (2-3 frames late): in order of adding, passes of one name summed up;
    // calls = 0: left out. Empty before the first arrive.
    const std::vector<PassTime>& times() const;
    void onSpan(SpanSink sink);  // hears of each pass when its time has arrived; empty: nobody does
    void collect();              // takes the times that have arrived: after glFinish() those of all frames
    size_t textures() const;     // held, lent or free
    size_t buffers() const;
    size_t bytes() const;      // of both
    void limit(size_t bytes);  // execute() fails rather than hold more

  private:
    friend class FrameGraph;
    friend class PassContext;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

class FrameGraph;

// What a pass's function works with. Asking for a handle that the pass did not declare is a mistake (ASSERT).
class PassContext {
  public:
    const Texture& texture(TextureHandle handle) const;
    GLuint buffer(BufferHandle handle) const;  // the GL name
    size_t bytes(BufferHandle handle) const;

    // Binds a framebuffer of these (level 0, all layers) and sets the viewport to all of it. Gone after the pass.
    const Framebuffer& drawTo(std::initializer_list<TextureHandle> colours, TextureHandle depth = {});
    // One triangle that covers the viewport, from gl_VertexID: no attributes. The program in use draws it.
    void drawFullscreen() const;

  private:
    friend class FrameGraph;
    PassContext(FrameGraph& graph, uint32_t pass) : graph_(graph), pass_(pass) {}
    FrameGraph& graph_;
    uint32_t pass_;
    Framebuffer framebuffer_;
};

class FrameGraph {
  public:
    explicit FrameGraph(TransientPool& pool);  // outlives the graph
    FrameGraph(const FrameGraph&) = delete;
    FrameGraph& operator=(const FrameGraph&) = delete;
    ~FrameGraph();

    // Lent by the pool from the first pass that uses it to the last.
    TextureHandle texture(std::string_view name, const TextureDesc& desc);
    BufferHandle buffer(std::string_view name, size_t bytes);
    // Somebody else's, until execute() returns; has contents from the start. Writing to it does not make a pass needed: output() does.
    TextureHandle importTexture(std::string_view name, const Texture& texture);
    BufferHandle importBuffer(std::string_view name, GLuint buffer, size_t bytes);
    const TextureDesc& desc(TextureHandle handle) const;

    // Reading what nobody has written is a mistake (ASSERT names pass and resource), as is sampling what the pass draws into.
    void pass(std::string_view name, const std::vector<Read>& reads, const std::vector<Write>& writes,
              std::function<void(PassContext&)> work);

    // Needed after the frame. A transient's texture stays valid until the pool's next graph executes: see result().
    void output(TextureHandle handle);
    void output(BufferHandle handle);

    // Runs what is needed, once. Error (failed): a transient could not be allocated; nothing ran.
    Status execute();
    // After execute(), of an output(): what it became.
    const Texture& result(TextureHandle handle) const;
    GLuint result(BufferHandle handle) const;

    struct Ran {
        std::string name;
        bool culled;
        GLbitfield barriers;  // of glMemoryBarrier before the pass; 0: none
    };
    std::vector<Ran> ran() const;            // what execute() did, pass by pass, for those who explain or test
    FrameGraphDescription describe() const;  // the same with all that was used, for those who show it

  private:
    friend class PassContext;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet::gpu
