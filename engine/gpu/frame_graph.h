// FrameGraph: the passes of one frame. It culls passes whose results are not used, provides transient textures and buffers (two whose
// lifetimes do not overlap share memory), places glMemoryBarrier, and measures the time of each pass.
//
//     FrameGraph graph(pool);                                    // created in each frame; the pool is kept
//     TextureHandle depth = graph.texture("depth", desc);
//     graph.pass("depth", {{particles, Usage::attribute}}, {depth}, [=](PassContext& c) { c.drawTo({}, depth); ... });
//     TextureHandle picture = addShade(graph, depth);            // a Pass is a free function: handles in, handles out
//     graph.output(picture);
//     graph.execute();
//
// Passes run in the order they were added. A write to a handle that was written before adds to its contents (a pass that replaces them
// clears first); for a transient's first writer they are undefined. After each pass the GL state that passes may set is reset to defaults;
// what a pass with PassContext::state() has bound stays.
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
#include "engine/gpu/pass_state.h"
#include "engine/gpu/texture.h"

namespace rivulet::gpu {

// How a pass uses a resource. It determines the barriers: writes of shaders to images or storage are not visible elsewhere without one.
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

// Resources that graphs share between frames: textures, buffers and timers. Textures and buffers not used for 8 frames are freed.
class TransientPool {
  public:
    TransientPool();
    TransientPool(TransientPool&&) noexcept;
    TransientPool& operator=(TransientPool&&) noexcept;
    ~TransientPool();

    // GPU time of each pass of the latest frame whose times have arrived (2 to 3 frames late), in the order of adding; passes of one name
    // are summed. calls = 0: culled. Empty before the first times arrive.
    const std::vector<PassTime>& times() const;
    void onSpan(SpanSink sink);  // receives the span of each pass when it arrives; empty: off
    void collect();              // processes the times that have arrived; after glFinish() those of all frames
    size_t textures() const;     // number in the pool, in use or free
    size_t buffers() const;
    size_t bytes() const;      // of textures and buffers
    void limit(size_t bytes);  // execute() fails if more would be needed

  private:
    friend class FrameGraph;
    friend class PassContext;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

class FrameGraph;

// The argument of a pass's function. Using a handle that the pass did not declare is a programming error (ASSERT).
class PassContext {
  public:
    const Texture& texture(TextureHandle handle) const;
    unsigned buffer(BufferHandle handle) const;  // the GL name
    size_t bytes(BufferHandle handle) const;

    // Sets what the pass draws with; it may be called again. Such a pass changes no other state of OpenGL than by this and by drawTo(), but
    // it may bind what it draws with. It needs no reset of all state afterwards, and so costs fewer calls.
    void state(const PassState& state);
    // Binds a framebuffer of these textures (level 0, all layers) and sets the viewport to its size. The pool keeps it.
    const Framebuffer& drawTo(std::initializer_list<TextureHandle> colours, TextureHandle depth = {});
    // One triangle that covers the viewport, from gl_VertexID: no attributes. The program in use draws it.
    void drawFullscreen() const;

  private:
    friend class FrameGraph;
    PassContext(FrameGraph& graph, uint32_t pass) : graph_(graph), pass_(pass) {}
    FrameGraph& graph_;
    uint32_t pass_;
    bool stated_ = false;  // state() was called
};

class FrameGraph {
  public:
    explicit FrameGraph(TransientPool& pool);  // must outlive the graph
    FrameGraph(const FrameGraph&) = delete;
    FrameGraph& operator=(const FrameGraph&) = delete;
    ~FrameGraph();

    // A transient: the pool provides it from the first pass that uses it to the last.
    TextureHandle texture(std::string_view name, const TextureDesc& desc);
    BufferHandle buffer(std::string_view name, size_t bytes);
    // A resource of the caller, which must exist until execute() returns; its contents are defined from the start. A pass that only writes
    // to an import is culled unless the import is an output().
    TextureHandle importTexture(std::string_view name, const Texture& texture);
    BufferHandle importBuffer(std::string_view name, unsigned buffer, size_t bytes);
    const TextureDesc& desc(TextureHandle handle) const;

    // Reading a resource that no earlier pass has written is a programming error (ASSERT with pass and resource), and so is sampling a
    // texture that the pass draws into.
    void pass(std::string_view name, const std::vector<Read>& reads, const std::vector<Write>& writes,
              std::function<void(PassContext&)> work);

    // Marks a resource as used after the frame. A transient stays valid until the pool's next graph executes: see result().
    void output(TextureHandle handle);
    void output(BufferHandle handle);

    // Runs the passes that contribute to an output; may be called once. Error (failed): a transient could not be allocated; no pass ran.
    Status execute();
    // The texture or buffer of an output(), after execute().
    const Texture& result(TextureHandle handle) const;
    unsigned result(BufferHandle handle) const;

    struct Ran {
        std::string name;
        bool culled;
        unsigned barriers;  // of glMemoryBarrier before the pass; 0: none
    };
    std::vector<Ran> ran() const;            // the passes after execute(), for --explain and tests
    FrameGraphDescription describe() const;  // the same with all resources, for the frame graph panel

  private:
    friend class PassContext;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet::gpu
