// Cooperation of CPU and GPU (thesis 2.3), and other ways to overlap work.
#include "fluid/session/cooperation.h"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "engine/compute/device_cpu.h"
#include "engine/core/assert.h"
#include "engine/core/file.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet {

namespace {
constexpr const char* kAheadLane = "cpu: ahead";
}

Table<PlanRow> plans() {
    static constexpr PlanRow rows[] = {
        {"off", "each frame is simulated, then drawn", Plan::alone},
        {"thesis", "the CPU builds the next step's grid cells while the GPU draws the last step", Plan::thesis},
        {"behind", "the cpu simulates the next frame while OpenGL draws the previous one", Plan::behind},
    };
    return {rows};
}

void traceKernels(Device& device, Timeline& timeline) {
    device.onSpan(timeline.lane(fmt::format("{}: kernels", backendName(device.backend()))));
}

Status writeTrace(const std::string& path, const Timeline& timeline, const Log& log) {
    if (const double since = timeline.completeSince(); since > 0)
        log.notice(fmt::format("{}: the run was longer than a trace holds: only the last {:.3g} s are in it", path, hostSeconds() - since));
    return writeFileAtomic(path, timeline.chromeTrace());
}

// Finds cells on the CPU, of particles whose positions are read from a GPU.
struct Cooperation::Cells {
    std::unique_ptr<CpuDevice> cpu;
    Kernel cellOf;
    Buffer position, id, cell;
    StepParams step{};
    bool found = false;

    static Result<Cells*> create() {
        const std::vector<CpuKernelRow> rows = cpuKernels();
        auto made = std::make_unique<Cells>();
        made->cpu = makeCpuDevice(rows);
        Result<Kernel> kernel = made->cpu->kernel("fluid/grid/cell_of");
        if (!kernel) return kernel.error();
        made->cellOf = *kernel;
        return made.release();
    }
    // Reads the positions. Error: out of memory.
    Status fetch(Device& from, const FluidWorld::CellWork& work) {
        step = work.step;
        for (auto [buffer, size] :
             {std::pair(&position, sizeof(vec4)), std::pair(&id, sizeof(uint32_t)), std::pair(&cell, sizeof(uint32_t))}) {
            if (buffer->bytes() >= step.count * size) continue;
            Result<Buffer> larger = cpu->allocate(step.count * size);
            if (!larger) return larger.error();
            *buffer = std::move(*larger);
        }
        from.read(*work.position, std::span(hostPointer<std::byte>(position), step.count * sizeof(vec4)));
        from.read(*work.id, std::span(hostPointer<std::byte>(id), step.count * sizeof(uint32_t)));
        return ok();
    }
    void find() { cpu->run(cellOf, step, {&position, &id, &cell}, step.count); }
};

Cooperation::Cooperation(Session& session, Plan plan, Timeline* timeline, const Log& log)
    : session_(&session), plan_(plan), timeline_(timeline), log_(log), cells_(nullptr, [](Cells* c) { delete c; }) {
    const bool cpu = session.world().device().backend() == Backend::cpu;
    if (plan == Plan::behind && !session.canStepInBackground()) {
        log.notice(cpu ? "--cooperate behind is not possible here: the maps of skins are drawn from buffers that a step writes; each frame "
                         "is stepped, then drawn"
                       : "--cooperate behind needs the cpu backend, which steps while OpenGL draws; with another backend each frame is "
                         "stepped, then drawn");
        plan_ = Plan::alone;
    }
    if (plan == Plan::thesis && cpu) {
        log.notice("--cooperate thesis needs a backend on the GPU, which the CPU assists: here the cpu simulates alone");
        plan_ = Plan::alone;
    }
    if (plan_ == Plan::thesis && !session.world().hasCellWork()) {
        log.notice(
            "--cooperate thesis is not possible with bodies, periodic axes, linked lists or a method that moves particles before sorting "
            "(pbf): cells are unknown before the next step, and the device finds them alone");
        plan_ = Plan::alone;
    }
    if (plan_ != Plan::thesis) return;
    Result<Cells*> made = Cells::create();
    if (made) {
        cells_.reset(*made);
        return;
    }
    log.notice(made.error().message);
    plan_ = Plan::alone;
}

void Cooperation::begin(double seconds, bool wait, double deviceMs) {
    ASSERT(!started_, "call finish() before the next step");
    startedAt_ = hostSeconds();
    seconds_ = seconds;
    wait_ = wait;
    deviceMs_ = deviceMs;
    aheadMs_ = 0;
    if (plan_ != Plan::thesis || session_->world().hasCellWork()) return;
    log_.notice("--cooperate thesis is for a GPU that simulates while the cpu helps: from here on the cpu simulates, alone");
    plan_ = Plan::alone;
}

void Cooperation::start(double seconds, bool wait, double deviceMs) {
    begin(seconds, wait, deviceMs);
    started_ = true;
    if (plan_ == Plan::behind)
        ahead_ = std::async(std::launch::async, [this] {
            const TimedSpan span(timeline_, kAheadLane, "step");
            session_->work(seconds_, wait_, deviceMs_);
        });
    if (plan_ == Plan::thesis) findCells();
}

void Cooperation::findCells() {
    FluidWorld& world = session_->world();
    const std::optional<FluidWorld::CellWork> work = world.cellWork();
    cells_->found = false;
    if (!work) return;
    const double before = hostSeconds();
    {
        const TimedSpan span(timeline_, "main", "places come down");
        if (!cells_->fetch(world.device(), *work)) return;  // the device finds them then
    }
    aheadMs_ = 1000 * (hostSeconds() - before);
    ahead_ = std::async(std::launch::async, [this] {
        const TimedSpan span(timeline_, kAheadLane, "cell_of");
        cells_->find();
        cells_->found = true;
    });
}

void Cooperation::wait() {
    if (ahead_.valid()) ahead_.get();
}

Cooperation::~Cooperation() { drop(); }

void Cooperation::drop() {
    if (plan_ == Plan::behind && started_) finish();
    started_ = false;
    wait();
}

double Cooperation::finish() {
    if (!started_) return 0;
    started_ = false;
    wait();
    if (plan_ == Plan::behind) {
        count();
        return session_->settle();
    }
    if (plan_ == Plan::thesis && cells_->found) {
        cells_->found = false;
        helped_ = true;
        const TimedSpan span(timeline_, "main", "cells go up");
        const double before = hostSeconds();
        session_->world().setCells(std::span(hostPointer<const uint32_t>(cells_->cell), cells_->step.count));
        aheadMs_ += 1000 * (hostSeconds() - before);
    }
    return advance();
}

double Cooperation::step(double seconds, bool wait, double deviceMs) {
    begin(seconds, wait, deviceMs);
    return advance();
}

double Cooperation::advance() {
    count();
    const TimedSpan span(timeline_, "main", "step");
    return aheadMs_ + session_->step(seconds_, wait_, deviceMs_);
}

void Cooperation::count() {
    if (timeline_ == nullptr) return;
    const double since = timeline_->completeSince();
    while (!frames_.empty() && frames_.front() < since) frames_.pop_front();
    frames_.push_back(startedAt_);
}

CooperationStats Cooperation::stats() const {
    CooperationStats s;
    for (const PlanRow& row : plans().rows)
        if (row.plan == plan_) s.plan = row.name;
    if (timeline_ == nullptr || plan_ == Plan::alone) return s;
    const double since = timeline_->completeSince();
    const auto first = std::find_if(frames_.begin(), frames_.end(), [&](double began) { return began >= since; });
    if (first == frames_.end()) return s;
    const auto frames = static_cast<double>(frames_.end() - first);
    std::vector<PassSpan> ahead, drawing;
    for (Timeline::Lane& lane : timeline_->lanes()) {
        std::erase_if(lane.spans, [&](const PassSpan& span) { return span.begin < *first; });
        if (lane.name == kAheadLane) ahead = std::move(lane.spans);
        if (lane.name == kDrawingLane) drawing = std::move(lane.spans);
    }
    for (const PassSpan& span : ahead) s.aheadMs += 1000 * (span.end - span.begin) / frames;
    s.overlapMs = 1000 * overlapSeconds(ahead, drawing) / frames;
    return s;
}

}  // namespace rivulet
