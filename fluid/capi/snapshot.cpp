// rivulet.h: snapshots and recordings.
#include <fmt/format.h>

#include <thread>
#include <utility>

#include "engine/core/json.h"
#include "fluid/capi/call.h"
#include "fluid/capi/drawing.h"
#include "fluid/capi/versioned.h"
#include "fluid/io/world_frame.h"

namespace rivulet::capi {
namespace {

// A flag that is set for the length of a call, unless another call has set it.
class Claim {
  public:
    explicit Claim(std::atomic<bool>& flag) : flag_(flag), mine_(!flag.exchange(true)) {}
    ~Claim() {
        if (mine_) flag_ = false;
    }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    bool mine() const { return mine_; }

  private:
    std::atomic<bool>& flag_;
    bool mine_;
};

// The thread of a call that draws, for its length.
class Drawer {
  public:
    explicit Drawer(std::atomic<std::thread::id>& thread) : thread_(thread) { thread_ = std::this_thread::get_id(); }
    ~Drawer() { thread_ = std::thread::id(); }
    Drawer(const Drawer&) = delete;
    Drawer& operator=(const Drawer&) = delete;

  private:
    std::atomic<std::thread::id>& thread_;
};

Status inUse() { return badInput("the snapshot is in use: a call fills or draws it; exchange two snapshots"); }

// Runs `work` while another call of the context may run that needs no OpenGL.
template <class Work>
rivulet_status whileStepping(rivulet_snapshot* snapshot, rivulet_error* why, const Work& work) {
    return guarded(why, [&]() -> Status {
        if (snapshot == nullptr) return badInput("snapshot is NULL");
        rivulet_context& context = *snapshot->context;
        if (!context.water) return badInput("the context has no OpenGL: set rivulet_context_options.find");
        if (context.lost) return lostContext();
        if (context.callback.frame != nullptr && context.callback.thread == std::this_thread::get_id() && !context.callback.left())
            return badInput("the context is in use: callbacks must not call back into it");
        if (context.current != nullptr && gpu::currentContext().context != context.current) return notCurrent();
        const Claim mine(snapshot->used), alone(context.drawing);
        if (!mine.mine()) return inUse();
        if (!alone.mine()) return badInput("the context is in use: another call draws or uses OpenGL");
        const Drawer drawer(context.drawer);
        const JobsScope jobs(context.jobs);
        return work();
    });
}

}  // namespace

Status recordFrame(rivulet_world& world) {
    if (!world.recording) return ok();
    frameOf(*world.world, world.recorded);
    const Status added = world.recording->add(world.recorded);
    if (!added) world.recording.reset();
    return added;
}

}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

rivulet_status rivulet_snapshot_create(rivulet_context* context, rivulet_snapshot** snapshot, rivulet_error* why) {
    return guarded(why, [&]() -> Status {
        if (snapshot == nullptr) return badInput("snapshot is NULL: pass the address of a handle");
        *snapshot = nullptr;
        if (context == nullptr) return badInput("context is NULL: create one with rivulet_context_create");
        if (Status can = ready(*context, Needs::memory); !can) return can;
        auto made = std::make_unique<rivulet_snapshot>();
        made->context = context;
        if (context->memoryLimit > 0) made->upload.limitMemory(context->memoryLimit);
        ++context->children;
        *snapshot = made.release();
        return ok();
    });
}

void rivulet_snapshot_destroy(rivulet_snapshot* snapshot) { destroy(snapshot); }

rivulet_status rivulet_world_snapshot(rivulet_world* world, rivulet_snapshot* snapshot, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (snapshot == nullptr) return badInput("snapshot is NULL");
        if (snapshot->context != world->context) return badInput("the snapshot is of another context: create one in the world's");
        const Claim mine(snapshot->used);
        if (!mine.mine()) return inUse();
        snapshot->look = world->params.look;
        snapshot->liquid = world->params.fluid.liquid;
        return snapshot->taken.take(*world->world, world->fallingDrops, world->hangingDrops);
    });
}

rivulet_status rivulet_world_record(rivulet_world* world, const char* path, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        std::optional<RecordingWriter>& recording = world->recording;
        if (recording) {
            if (path != nullptr) return badInput("the world is being recorded: end that with path NULL first");
            const Status closed = recording->frames() > 0 ? recording->close() : ok();
            recording.reset();
            return closed;
        }
        if (path == nullptr) return badInput("path is NULL, and the world is not being recorded");
        WorldParams none;
        const VisitFn defaults = [&none](ParamVisitor& v) { none.visit(v); };
        const Device& device = *world->context->device;
        Result<RecordingWriter> writer =
            RecordingWriter::open(path, textOf({.version = RIVULET_VERSION,
                                                .device = fmt::format("{}: {}", backendName(device.backend()), device.info().name),
                                                .scene = writeJson([world](ParamVisitor& v) { world->params.visit(v); }, &defaults)}));
        if (!writer) return writer.error();
        recording.emplace(std::move(*writer));
        return ok();
    });
}

rivulet_status rivulet_snapshot_replay(rivulet_snapshot* snapshot, const rivulet_world* world, const char* path, size_t frame,
                                       rivulet_recorded* recorded, rivulet_error* why) {
    return with(snapshot, why, Needs::memory, [&]() -> Status {
        if (world == nullptr) return badInput("world is NULL: the frame has its look");
        if (path == nullptr) return badInput("path is NULL");
        const Claim mine(snapshot->used);
        if (!mine.mine()) return inUse();
        const FileFacts facts = factsOf(path);
        if (!snapshot->recording || snapshot->recordingPath != path || !(snapshot->recordingFacts == facts)) {
            Result<RecordingReader> reader = RecordingReader::open(path);
            if (!reader) return reader.error();
            snapshot->recording.emplace(std::move(*reader));
            snapshot->recordingPath = path;
            snapshot->recordingFacts = facts;
        }
        RecordingReader& reader = *snapshot->recording;
        if (frame >= reader.frames())
            return badInput(fmt::format("{} has {} frames: give a frame from 0 to {}", path, reader.frames(), reader.frames() - 1));
        const size_t limit = snapshot->context->memoryLimit;
        Result<RecordedFrame> read = limit > 0 ? reader.read(frame, limit) : reader.read(frame);
        if (!read) return read.error();
        const double time = read->time;
        snapshot->look = world->params.look;
        snapshot->liquid = world->params.fluid.liquid;
        snapshot->taken.take(std::move(*read), world->world->particles().viscosity);
        if (recorded == nullptr) return ok();
        return writeStruct(rivulet_recorded{.size = 0, .frames = reader.frames(), .time = time}, recorded, "rivulet_recorded", "recorded");
    });
}

rivulet_status rivulet_snapshot_draw(rivulet_snapshot* snapshot, const rivulet_view* view, const rivulet_target* target,
                                     rivulet_error* why) {
    return whileStepping(snapshot, why, [&]() -> Status {
        Result<WaterDraw> draw = waterDraw(snapshot->look, snapshot->liquid, view, target);
        if (!draw) return draw.error();
        const gpu::HostState keep(savesOf(*snapshot->context));
        const Result<FluidView> fluid = snapshot->upload.view(snapshot->taken, snapshot->look);
        if (!fluid) return fluid.error();
        return drawWater(*snapshot->context->water, keep, *fluid, *draw);
    });
}

rivulet_status rivulet_snapshot_buffers(rivulet_snapshot* snapshot, rivulet_buffers* buffers, rivulet_error* why) {
    return whileStepping(snapshot, why, [&]() -> Status {
        const gpu::HostState keep(savesOf(*snapshot->context));
        const Result<FluidView> fluid = snapshot->upload.view(snapshot->taken, plainLook(snapshot->look));
        if (!fluid) return fluid.error();
        return writeStruct(buffersOf(*fluid), buffers, "rivulet_buffers", "buffers");
    });
}
