#include "engine/gpu/frame_graph.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <new>
#include <optional>
#include <utility>

#include "engine/core/assert.h"
#include "engine/core/readable_bytes.h"
#include "engine/gpu/gl_error.h"
#include "engine/gpu/pass_state.h"
#include "engine/gpu/timer.h"
#include "engine/gpu/vertex_array.h"

namespace rivulet::gpu {
namespace {

constexpr uint64_t kKeepFrames = 8;     // a resource not used for this many frames is freed
constexpr uint64_t kTimesLate = 2;      // frames before the time of a pass is read
constexpr size_t kMaxTimedFrames = 16;  // frames whose times may be pending

bool fitsTexture(Usage usage) { return usage == Usage::sampled || usage == Usage::image || usage == Usage::target || usage == Usage::copy; }
bool fitsBuffer(Usage usage) { return !fitsTexture(usage) || usage == Usage::copy || usage == Usage::sampled; }

// Writes that are not visible to other commands without a barrier.
bool incoherent(Usage usage) { return usage == Usage::image || usage == Usage::storage; }

// The bit of glMemoryBarrier that makes such a write visible to this usage.
GLbitfield barrierFor(Usage usage, bool texture) {
    switch (usage) {
        case Usage::sampled:
            return GL_TEXTURE_FETCH_BARRIER_BIT;
        case Usage::image:
            return GL_SHADER_IMAGE_ACCESS_BARRIER_BIT;
        case Usage::target:
            return GL_FRAMEBUFFER_BARRIER_BIT;
        case Usage::storage:
            return GL_SHADER_STORAGE_BARRIER_BIT;
        case Usage::uniform:
            return GL_UNIFORM_BARRIER_BIT;
        case Usage::attribute:
            return GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT;
        case Usage::index:
            return GL_ELEMENT_ARRAY_BARRIER_BIT;
        case Usage::indirect:
            return GL_COMMAND_BARRIER_BIT;
        case Usage::copy:
            return texture ? GL_TEXTURE_UPDATE_BARRIER_BIT : GL_BUFFER_UPDATE_BARRIER_BIT;
    }
    ASSERT(false, "pass a valid Usage");
}

size_t roundedBytes(size_t bytes) { return (std::max<size_t>(bytes, 1) + 255) / 256 * 256; }

}  // namespace

struct TransientPool::Impl {
    template <class Object, class Key>
    struct Item {
        Key key;
        Object object;
        uint64_t lastUsed = 0;
        bool lent = false;
    };
    using TextureItem = Item<Texture, TextureDesc>;
    using BufferItem = Item<Buffer, size_t>;
    struct FramebufferItem {
        std::vector<std::weak_ptr<const void>> of;  // colours, then depth; empty: none there
        Framebuffer framebuffer;
        uint64_t lastUsed = 0;
        bool isOf(std::span<const Attachment> colours, const Attachment& depth) const;
        bool gone() const;  // one of its textures was deleted
    };

    // Items stay where they are: graphs point at them.
    std::vector<std::unique_ptr<TextureItem>> textures;
    std::vector<std::unique_ptr<BufferItem>> buffers;
    std::vector<std::unique_ptr<FramebufferItem>> framebuffers;
    uint64_t frame = 0;
    VertexArray noAttributes;

    struct TimedFrame {
        uint64_t frame = 0;
        size_t awaited = 0;
        std::vector<PassTime> rows;
    };
    Timer timer;
    std::deque<TimedFrame> timed;
    std::vector<PassTime> times;
    SpanSink onSpan;

    template <class Items, class Key, class Make>
    static auto lend(Items& items, const Key& key, uint64_t frame, Make make) -> Result<typename Items::value_type::pointer> {
        using Element = typename Items::value_type::element_type;
        for (const auto& item : items) {
            if (item->lent || !(item->key == key)) continue;
            item->lent = true;
            item->lastUsed = frame;
            return item.get();
        }
        auto made = make();
        if (!made) return made.error();
        items.push_back(std::make_unique<Element>(Element{key, std::move(*made), frame, true}));
        return items.back().get();
    }
    size_t most = SIZE_MAX;  // bytes
    size_t held() const {
        size_t sum = 0;
        for (const auto& item : textures) sum += item->key.bytes();
        for (const auto& item : buffers) sum += item->key;
        return sum;
    }
    Status room(size_t bytes) const {
        if (held() + bytes <= most) return ok();
        return failed(
            fmt::format("{} were asked for while {} of the {} that are allowed for pictures are in use; allow more, or draw fewer pixels",
                        readableBytes(bytes), readableBytes(held()), readableBytes(most)));
    }
    Result<TextureItem*> lendTexture(const TextureDesc& desc) {
        return lend(textures, desc, frame, [&]() -> Result<Texture> {
            if (Status fits = room(desc.bytes()); !fits) return fits.error();
            return Texture::create(desc);
        });
    }
    Result<BufferItem*> lendBuffer(size_t bytes) {
        return lend(buffers, bytes, frame, [&]() -> Result<Buffer> {
            if (Status fits = room(bytes); !fits) return fits.error();
            return Buffer::create(bytes);
        });
    }

    const Framebuffer& framebufferOf(std::span<const Attachment> colours, const Attachment& depth) {
        for (const auto& item : framebuffers)
            if (item->isOf(colours, depth)) {
                item->lastUsed = frame;
                return item->framebuffer;
            }
        auto made = std::make_unique<FramebufferItem>();
        made->framebuffer = Framebuffer(colours, depth);
        made->lastUsed = frame;
        const auto lifeOf = [](const Attachment& a) { return a.texture != nullptr ? a.texture->life() : std::weak_ptr<const void>(); };
        for (const Attachment& colour : colours) made->of.push_back(lifeOf(colour));
        made->of.push_back(lifeOf(depth));
        framebuffers.push_back(std::move(made));
        return framebuffers.back()->framebuffer;
    }

    void beginFrame() {
        ++frame;
        const auto old = [&](const auto& item) {
            item->lent = false;
            return item->lastUsed + kKeepFrames < frame;
        };
        std::erase_if(textures, old);
        std::erase_if(buffers, old);
        std::erase_if(framebuffers, [&](const auto& item) { return item->gone() || item->lastUsed + kKeepFrames < frame; });
        if (!timed.empty() && timed.front().frame + kTimesLate <= frame) collectTimes();
    }

    void collectTimes() {
        timer.collect([&](uint64_t tag, const Timer::Times& span) {
            for (TimedFrame& f : timed)
                if (f.frame == tag >> 16U) {
                    PassTime& row = f.rows[tag & 0xFFFFU];
                    row.ms += span.ms();
                    --f.awaited;
                    if (onSpan) onSpan({row.name, span.begin, span.end});
                }
        });
        while (!timed.empty() && (timed.front().awaited == 0 || timed.size() > kMaxTimedFrames)) {
            if (timed.front().awaited == 0) times = std::move(timed.front().rows);
            timed.pop_front();
        }
    }

    // A row for the pass in the frame being made; a pass of a name that is there shares its row.
    size_t timeRow(std::string_view name, bool ran) {
        std::vector<PassTime>& rows = timed.back().rows;
        auto row = std::find_if(rows.begin(), rows.end(), [&](const PassTime& t) { return t.name == name; });
        if (row == rows.end()) row = rows.insert(rows.end(), PassTime{std::string(name), 0, 0});
        row->calls += ran ? 1 : 0;
        return static_cast<size_t>(row - rows.begin());
    }
};

bool TransientPool::Impl::FramebufferItem::isOf(std::span<const Attachment> colours, const Attachment& depth) const {
    if (of.size() != colours.size() + 1) return false;
    const auto same = [](const std::weak_ptr<const void>& kept, const Attachment& a) {
        return kept.lock() == (a.texture != nullptr ? a.texture->life().lock() : nullptr);
    };
    return !gone() &&
           std::equal(colours.begin(), colours.end(), of.begin(), [&](const Attachment& a, const auto& kept) { return same(kept, a); }) &&
           same(of.back(), depth);
}
bool TransientPool::Impl::FramebufferItem::gone() const {
    const std::weak_ptr<const void> none;
    return std::any_of(of.begin(), of.end(),
                       [&](const auto& kept) { return kept.expired() && (kept.owner_before(none) || none.owner_before(kept)); });
}

TransientPool::TransientPool() : impl_(std::make_unique<Impl>()) {}
TransientPool::TransientPool(TransientPool&&) noexcept = default;
TransientPool& TransientPool::operator=(TransientPool&&) noexcept = default;
TransientPool::~TransientPool() = default;
const std::vector<PassTime>& TransientPool::times() const { return impl_->times; }
void TransientPool::collect() { impl_->collectTimes(); }
void TransientPool::onSpan(SpanSink sink) { impl_->onSpan = std::move(sink); }
size_t TransientPool::textures() const { return impl_->textures.size(); }
size_t TransientPool::buffers() const { return impl_->buffers.size(); }
size_t TransientPool::bytes() const { return impl_->held(); }
void TransientPool::limit(size_t bytes) { impl_->most = bytes; }

struct FrameGraph::Impl {
    struct Resource {
        std::string name;
        bool isTexture = false, imported = false, written = false, output = false;
        TextureDesc desc;                  // settled
        size_t bytes = 0;                  // as asked for
        const Texture* texture = nullptr;  // an import's from the start, a transient's from execute() on
        GLuint buffer = 0;
        size_t first = SIZE_MAX, last = 0;  // of the passes that run
        bool* lent = nullptr;               // of the pool's item
        GLuint glName() const { return isTexture ? texture->name() : buffer; }
    };
    struct Pass {
        std::string name;
        std::vector<Read> reads;
        std::vector<Write> writes;
        std::function<void(PassContext&)> work;
        bool needed = false;
        GLbitfield barriers = 0;
    };
    // The accesses to one texture or buffer since the last barriers. The key is the GL name, because transients may share one.
    struct Hazard {
        bool written = false;       // written incoherently by a shader ...
        GLbitfield visibleTo = 0;   // ... and made visible to these uses by a barrier
        bool touched = false;       // used in another way; an incoherent write must not be executed before that ...
        GLbitfield orderedFor = 0;  // ... and for these uses a barrier already ensures it
    };
    using Hazards = std::map<std::pair<bool, GLuint>, Hazard>;

    explicit Impl(TransientPool::Impl& p) : pool(p) {}

    TransientPool::Impl& pool;
    std::vector<Resource> resources;
    std::vector<Pass> passes;
    bool executed = false;
    StateScope* state = nullptr;  // within execute()

    uint32_t add(Resource resource) {
        ASSERT(!executed, "build a new FrameGraph for the next frame");
        resources.push_back(std::move(resource));
        return static_cast<uint32_t>(resources.size() - 1);
    }
    Resource& at(uint32_t index, bool isTexture) {
        ASSERT(index < resources.size() && resources[index].isTexture == isTexture, "use a handle that this graph made");
        return resources[index];
    }

    void cull();
    Status lendTransients();
    GLbitfield placeBarriers(const Pass& pass, Hazards& hazards) const;
    void noteAccesses(const Pass& pass, Hazards& hazards) const;
};

// Goes backwards: a pass is needed if it writes a needed resource; then all resources that it reads are needed too.
void FrameGraph::Impl::cull() {
    std::vector<bool> needed(resources.size());
    for (size_t r = 0; r < resources.size(); ++r) needed[r] = resources[r].output;
    for (size_t p = passes.size(); p-- > 0;) {
        Pass& pass = passes[p];
        pass.needed = std::any_of(pass.writes.begin(), pass.writes.end(), [&](const Write& w) { return needed[w.index]; });
        if (!pass.needed) continue;
        const auto touch = [&](uint32_t index) {
            resources[index].first = std::min(resources[index].first, p);
            resources[index].last = std::max(resources[index].last, p);
        };
        for (const Read& read : pass.reads) {
            needed[read.index] = true;
            touch(read.index);
        }
        for (const Write& write : pass.writes) touch(write.index);
    }
}

Status FrameGraph::Impl::lendTransients() {
    for (size_t p = 0; p < passes.size(); ++p) {
        for (Resource& r : resources) {
            if (r.imported || r.first != p) continue;
            if (r.isTexture) {
                Result<TransientPool::Impl::TextureItem*> item = pool.lendTexture(r.desc);
                if (!item) return failed(fmt::format("the frame's \"{}\" cannot be allocated: {}", r.name, item.error().message));
                r.texture = &(*item)->object;
                r.lent = &(*item)->lent;
            } else {
                Result<TransientPool::Impl::BufferItem*> item = pool.lendBuffer(roundedBytes(r.bytes));
                if (!item) return failed(fmt::format("the frame's \"{}\" cannot be allocated: {}", r.name, item.error().message));
                r.buffer = (*item)->object.name();
                r.lent = &(*item)->lent;
            }
        }
        for (Resource& r : resources)
            if (!r.imported && !r.output && r.first != SIZE_MAX && r.last == p) *r.lent = false;
    }
    return ok();
}

GLbitfield FrameGraph::Impl::placeBarriers(const Pass& pass, Hazards& hazards) const {
    GLbitfield bits = 0;
    const auto check = [&](uint32_t index, Usage usage, bool write) {
        const Resource& r = resources[index];
        const auto found = hazards.find({r.isTexture, r.glName()});
        if (found == hazards.end()) return;
        const GLbitfield bit = barrierFor(usage, r.isTexture);
        const Hazard& hazard = found->second;
        if (hazard.written && (hazard.visibleTo & bit) == 0) bits |= bit;
        if (write && incoherent(usage) && hazard.touched && (hazard.orderedFor & bit) == 0) bits |= bit;
    };
    for (const Read& read : pass.reads) check(read.index, read.usage, false);
    for (const Write& write : pass.writes) check(write.index, write.usage, true);
    if (bits != 0) {
        glMemoryBarrier(bits);
        for (auto& [key, hazard] : hazards) {
            hazard.visibleTo |= bits;
            hazard.orderedFor |= bits;
        }
    }
    return bits;
}

void FrameGraph::Impl::noteAccesses(const Pass& pass, Hazards& hazards) const {
    const auto note = [&](uint32_t index, bool incoherentWrite) {
        Hazard& hazard = hazards[{resources[index].isTexture, resources[index].glName()}];
        (incoherentWrite ? hazard.written : hazard.touched) = true;
        (incoherentWrite ? hazard.visibleTo : hazard.orderedFor) = 0;
    };
    for (const Read& read : pass.reads) note(read.index, false);
    for (const Write& write : pass.writes) note(write.index, incoherent(write.usage));
}

FrameGraph::FrameGraph(TransientPool& pool) : impl_(std::make_unique<Impl>(*pool.impl_)) {}
FrameGraph::~FrameGraph() = default;

TextureHandle FrameGraph::texture(std::string_view name, const TextureDesc& desc) {
    Impl::Resource resource;
    resource.name = name;
    resource.isTexture = true;
    resource.desc = settled(desc);
    return {impl_->add(std::move(resource))};
}

BufferHandle FrameGraph::buffer(std::string_view name, size_t bytes) {
    Impl::Resource resource;
    resource.name = name;
    resource.bytes = bytes;
    return {impl_->add(std::move(resource))};
}

TextureHandle FrameGraph::importTexture(std::string_view name, const Texture& texture) {
    ASSERT(texture, "import a texture that exists");
    Impl::Resource resource;
    resource.name = name;
    resource.isTexture = resource.imported = resource.written = true;
    resource.desc = texture.desc();
    resource.texture = &texture;
    return {impl_->add(std::move(resource))};
}

BufferHandle FrameGraph::importBuffer(std::string_view name, GLuint buffer, size_t bytes) {
    ASSERT(buffer != 0, "import a buffer that exists");
    Impl::Resource resource;
    resource.name = name;
    resource.imported = resource.written = true;
    resource.bytes = bytes;
    resource.buffer = buffer;
    return {impl_->add(std::move(resource))};
}

const TextureDesc& FrameGraph::desc(TextureHandle handle) const { return impl_->at(handle.index, true).desc; }

void FrameGraph::pass(std::string_view name, const std::vector<Read>& reads, const std::vector<Write>& writes,
                      std::function<void(PassContext&)> work) {
    ASSERT(!impl_->executed, "build a new FrameGraph for the next frame");
    std::vector<Impl::Resource>& resources = impl_->resources;
    const auto message = [&](uint32_t index, const char* what) {
        return fmt::format("pass \"{}\", \"{}\": {}", name, index < resources.size() ? resources[index].name : "?", what);
    };
    const auto check = [&](uint32_t index, Usage usage) {
        ASSERT(index < resources.size(), message(index, "use a handle that this graph made").c_str());
        ASSERT(resources[index].isTexture ? fitsTexture(usage) : fitsBuffer(usage),
               message(index, "this usage does not fit a texture or a buffer, respectively").c_str());
    };
    for (const Read& read : reads) {
        check(read.index, read.usage);
        ASSERT(resources[read.index].written,
               message(read.index, "no earlier pass writes this; add that pass before the one that reads").c_str());
        for (const Write& write : writes)
            ASSERT(write.index != read.index || write.usage != Usage::target || read.usage == Usage::target,
                   message(read.index, "a pass cannot read what it draws into; draw into another texture").c_str());
    }
    for (const Write& write : writes) {
        check(write.index, write.usage);
        ASSERT(write.usage == Usage::target || write.usage == Usage::image || write.usage == Usage::storage || write.usage == Usage::copy,
               message(write.index, "only targets, images, storage and copies are written").c_str());
        resources[write.index].written = true;
    }
    impl_->passes.push_back({std::string(name), reads, writes, std::move(work), false, 0});
}

void FrameGraph::output(TextureHandle handle) { impl_->at(handle.index, true).output = true; }
void FrameGraph::output(BufferHandle handle) { impl_->at(handle.index, false).output = true; }

Status FrameGraph::execute() {
    ASSERT(!impl_->executed, "execute a FrameGraph once");
    impl_->executed = true;
    TransientPool::Impl& pool = impl_->pool;
    pool.beginFrame();
    impl_->cull();
    const Status lent = impl_->lendTransients();
    if (!lent) return lent.error();

    // Passes are named for a debugger that listens. A host may have opened the maximum number of debug groups: a pop without a successful
    // push would close one of the host's.
    GLint groups = 0, mostGroups = 0;
    if (glIsEnabled(GL_DEBUG_OUTPUT) == GL_TRUE) {
        glGetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &groups);
        glGetIntegerv(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &mostGroups);
    }
    const bool named = groups < mostGroups;
    pool.timed.push_back({pool.frame, 0, {}});
    StateScope state;
    impl_->state = &state;
    Impl::Hazards hazards;
    bool timing = false, lacksMemory = false;
    for (size_t p = 0; p < impl_->passes.size() && !lacksMemory; ++p) {
        Impl::Pass& pass = impl_->passes[p];
        const size_t row = pool.timeRow(pass.name, pass.needed);
        if (!pass.needed) continue;
        if (named) glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, static_cast<GLsizei>(pass.name.size()), pass.name.c_str());
        const uint64_t tag = pool.frame << 16U | row;
        timing ? pool.timer.next(tag) : pool.timer.begin(tag);
        timing = true;
        ++pool.timed.back().awaited;
        pass.barriers = impl_->placeBarriers(pass, hazards);
        PassContext context(*this, static_cast<uint32_t>(p));
        try {
            pass.work(context);
        } catch (const std::bad_alloc&) {
            lacksMemory = true;
        }
        context.stated_ ? state.set({}) : state.reset();
        impl_->noteAccesses(pass, hazards);
        if (named) glPopDebugGroup();
    }
    if (timing) pool.timer.end();
    impl_->state = nullptr;
    if (lacksMemory && contextLost()) return failed(kContextLost);
    if (lacksMemory) return noMemory("there is not enough memory to draw the picture: make it smaller, or use fewer particles");
    // Makes shader writes visible to all later commands, here or in the host.
    // Kernels may write next what these passes have read as storage buffers.
    const bool written = std::any_of(hazards.begin(), hazards.end(), [](const auto& h) { return h.second.written; });
    glMemoryBarrier(written ? GL_ALL_BARRIER_BITS : GL_SHADER_STORAGE_BARRIER_BIT);
    return ok();
}

const Texture& FrameGraph::result(TextureHandle handle) const {
    const Impl::Resource& r = impl_->at(handle.index, true);
    ASSERT(impl_->executed && r.output && r.texture, "call result() for an output(), after execute() succeeded");
    return *r.texture;
}

GLuint FrameGraph::result(BufferHandle handle) const {
    const Impl::Resource& r = impl_->at(handle.index, false);
    ASSERT(impl_->executed && r.output && r.buffer != 0, "call result() for an output(), after execute() succeeded");
    return r.buffer;
}

std::vector<FrameGraph::Ran> FrameGraph::ran() const {
    std::vector<Ran> rows;
    for (const Impl::Pass& pass : impl_->passes) rows.push_back({pass.name, !pass.needed, pass.barriers});
    return rows;
}

const char* usageName(Usage usage) {
    constexpr const char* kNames[] = {"sampled", "image", "target", "storage", "uniform", "attribute", "index", "indirect", "copy"};
    static_assert(std::size(kNames) == static_cast<size_t>(Usage::copy) + 1, "a name for every Usage, in order");
    return kNames[static_cast<size_t>(usage)];
}

FrameGraphDescription FrameGraph::describe() const {
    ASSERT(impl_->executed, "describe a FrameGraph after execute()");
    FrameGraphDescription d;
    d.heldBytes = impl_->pool.held();
    std::map<std::pair<bool, GLuint>, size_t> memories;
    for (const Impl::Resource& r : impl_->resources) {
        FrameGraphDescription::Resource& row = d.resources.emplace_back();
        row.name = r.name;
        row.isTexture = r.isTexture;
        row.imported = r.imported;
        row.output = r.output;
        row.first = r.first;
        row.last = r.last;
        row.bytes = r.isTexture ? r.desc.bytes() : r.bytes;
        if (r.isTexture) {
            row.format = formatInfo(r.desc.format).name;
            row.width = r.desc.width;
            row.height = r.desc.height;
            row.layers = r.desc.shape == TextureShape::cube ? 6 : r.desc.layers;
        }
        if (r.imported || r.lent == nullptr) continue;
        const auto [place, fresh] = memories.try_emplace({r.isTexture, r.glName()}, memories.size());
        row.memory = place->second;
        if (fresh) d.lentBytes += r.isTexture ? row.bytes : roundedBytes(r.bytes);
    }
    d.memories = memories.size();
    const auto uses = [](const auto& declared) {
        std::vector<FrameGraphDescription::Use> list;
        list.reserve(declared.size());
        for (const auto& use : declared) list.push_back({use.index, use.usage});
        return list;
    };
    for (const Impl::Pass& pass : impl_->passes) d.passes.push_back({pass.name, !pass.needed, uses(pass.reads), uses(pass.writes)});
    return d;
}

std::vector<PassTraffic> trafficOf(const FrameGraphDescription& graph) {
    std::vector<PassTraffic> rows;
    for (const FrameGraphDescription::Pass& pass : graph.passes) {
        if (pass.culled) continue;
        auto row = std::find_if(rows.begin(), rows.end(), [&](const PassTraffic& t) { return t.name == pass.name; });
        if (row == rows.end()) row = rows.insert(rows.end(), PassTraffic{pass.name});
        ++row->passes;
        for (const FrameGraphDescription::Use& use : pass.reads) row->read += graph.resources[use.resource].bytes;
        for (const FrameGraphDescription::Use& use : pass.writes) row->written += graph.resources[use.resource].bytes;
    }
    return rows;
}

// Of the pass's declarations: whether `test` holds for any.
template <class Pass, class Test>
static bool declared(const Pass& pass, Test test) {
    return std::any_of(pass.reads.begin(), pass.reads.end(), test) || std::any_of(pass.writes.begin(), pass.writes.end(), test);
}

const Texture& PassContext::texture(TextureHandle handle) const {
    const FrameGraph::Impl::Pass& pass = graph_.impl_->passes[pass_];
    const FrameGraph::Impl::Resource& r = graph_.impl_->at(handle.index, true);
    ASSERT(declared(pass, [&](const auto& use) { return use.index == handle.index; }),
           fmt::format("pass \"{}\" uses \"{}\" without declaring it; add it to its reads or writes", pass.name, r.name).c_str());
    return *r.texture;
}

GLuint PassContext::buffer(BufferHandle handle) const {
    const FrameGraph::Impl::Pass& pass = graph_.impl_->passes[pass_];
    const FrameGraph::Impl::Resource& r = graph_.impl_->at(handle.index, false);
    ASSERT(declared(pass, [&](const auto& use) { return use.index == handle.index; }),
           fmt::format("pass \"{}\" uses \"{}\" without declaring it; add it to its reads or writes", pass.name, r.name).c_str());
    return r.buffer;
}

size_t PassContext::bytes(BufferHandle handle) const { return graph_.impl_->at(handle.index, false).bytes; }

const Framebuffer& PassContext::drawTo(std::initializer_list<TextureHandle> colours, TextureHandle depth) {
    const FrameGraph::Impl::Pass& pass = graph_.impl_->passes[pass_];
    const auto attachment = [&](TextureHandle handle) {
        if (!handle) return Attachment{};
        const Texture& target = texture(handle);
        ASSERT(declared(pass, [&](const auto& use) { return use.index == handle.index && use.usage == Usage::target; }),
               fmt::format("pass \"{}\" draws into \"{}\" without declaring it; add it to its writes", pass.name,
                           graph_.impl_->resources[handle.index].name)
                   .c_str());
        return Attachment{&target};
    };
    std::vector<Attachment> attachments;
    for (const TextureHandle colour : colours) attachments.push_back(attachment(colour));
    const Framebuffer& framebuffer = graph_.impl_->pool.framebufferOf(attachments, attachment(depth));
    framebuffer.bind();
    return framebuffer;
}

void PassContext::state(const PassState& state) {
    stated_ = true;
    graph_.impl_->state->set(state);
}

void PassContext::drawFullscreen() const {
    VertexArray& array = graph_.impl_->pool.noAttributes;
    if (!array) array = VertexArray::create();
    array.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace rivulet::gpu
