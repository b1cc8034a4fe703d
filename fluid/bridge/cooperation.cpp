// The thesis's cooperation of CPU and GPU (2.3), and what else may overlap.
#include "fluid/bridge/cooperation.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "engine/compute/device_cpu.h"
#include "fluid/bridge/run_stats.h"
#include "fluid/sim/cpu_kernels.h"

namespace rivulet {

namespace {
constexpr const char* kAheadLane = "cpu: ahead";
}

Table<PlanRow> plans() {
    static constexpr PlanRow rows[] = {
        {"off", "a frame is stepped, then drawn", Plan::alone},
        {"thesis", "the CPU finds the next step's cells while the GPU draws the step just done", Plan::thesis},
        {"behind", "the cpu steps on while OpenGL draws the frame before", Plan::behind},
    };
    return {rows};
}

void traceKernels(Device& device, Timeline& timeline) {
    device.onSpan(timeline.lane(fmt::format("{}: kernels", backendName(device.backend()))));
}

// Finds cells on the CPU, of particles whose places come down from a GPU.
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
        Result<Kernel> kernel = made->cpu->kernel("fluid/cell_of");
        if (!kernel) return kernel.error();
        made->cellOf = *kernel;
        return made.release();
    }
    // The places, on their way down. Error: out of memory.
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
    if (plan == Plan::behind && !session.mayWorkAside()) {
        log.notice(
            cpu ? "--cooperate behind: a skin's maps are drawn from what is being stepped, so that a frame is stepped, then drawn"
                : "--cooperate behind is for the cpu, which steps while OpenGL draws; with another backend a frame is stepped, then drawn");
        plan_ = Plan::alone;
    }
    if (plan == Plan::thesis && cpu) {
        log.notice("--cooperate thesis is for a GPU that simulates while the cpu helps: here the cpu simulates, alone");
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

void Cooperation::start(double seconds, bool wait, double deviceMs) {
    ASSERT(!started_, "finish() a step before the next");
    started_ = true;
    seconds_ = seconds;
    wait_ = wait;
    deviceMs_ = deviceMs;
    aheadMs_ = 0;
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
    if (!work) {
        if (!told_ && world.lastSubsteps() > 0 && world.device().backend() != Backend::cpu)
            log_.notice(
                "--cooperate thesis: with bodies, periodic axes or a method that moves particles before it sorts them (pbf) no cell is "
                "known "
                "before the next step: the device finds them");
        told_ = told_ || world.lastSubsteps() > 0;
        return;
    }
    const double before = hostSeconds();
    {
        const TimedSpan span(timeline_, "main", "places come down");
        if (!cells_->fetch(world.device(), *work)) return;  // then the device finds them
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
    ++frames_;
    wait();
    if (plan_ == Plan::behind) return session_->settle();
    if (plan_ == Plan::thesis && cells_->found) {
        cells_->found = false;
        helped_ = true;
        const TimedSpan span(timeline_, "main", "cells go up");
        const double before = hostSeconds();
        session_->world().giveCells(std::span(hostPointer<const uint32_t>(cells_->cell), cells_->step.count));
        aheadMs_ += 1000 * (hostSeconds() - before);
    }
    const TimedSpan span(timeline_, "main", "step");
    return aheadMs_ + session_->step(seconds_, wait_, deviceMs_);
}

CooperationStats Cooperation::stats() const {
    CooperationStats s;
    for (const PlanRow& row : plans().rows)
        if (row.plan == plan_) s.plan = row.name;
    if (timeline_ == nullptr || frames_ == 0 || plan_ == Plan::alone) return s;
    std::vector<PassSpan> ahead, drawing;
    for (Timeline::Lane& lane : timeline_->lanes()) {
        if (lane.name == kAheadLane) ahead = std::move(lane.spans);
        if (lane.name == kDrawingLane) drawing = std::move(lane.spans);
    }
    for (const PassSpan& span : ahead) s.aheadMs += 1000 * (span.end - span.begin) / frames_;
    s.overlapMs = 1000 * overlapSeconds(ahead, drawing) / frames_;
    return s;
}

std::string sentenceOf(std::span<const PlanTried> tried, std::string_view named) {
    std::string others;
    for (const PlanTried& t : tried.subspan(1)) others += fmt::format("{}{} {:.1f}", others.empty() ? "" : ", ", nameOf(t), t.frameMs);
    const PlanTried& best = tried.front();
    return fmt::format("--cooperate auto: {}, {:.1f} ms a frame{}{}", nameOf(best), best.frameMs,
                       others.empty() ? "" : fmt::format(" ({})", others),
                       named != "auto" && named != best.backend ? fmt::format("; --backend {} is left for it", named) : "");
}

std::string nameOf(const PlanTried& tried) {
    const char* plan = "";
    for (const PlanRow& row : plans().rows)
        if (row.plan == tried.plan) plan = row.name;
    return tried.plan == Plan::alone ? tried.backend : fmt::format("{}, {}", tried.backend, plan);
}

Result<std::vector<PlanTried>> tryPlans(const SceneFile& scene, const GlFacts& gl, const DrawFrame& draw, const Log& log, int frames,
                                        const std::string& clDevice) {
    std::vector<PlanTried> all;
    std::optional<Error> why;  // the first device cannot
    for (const char* backend : {"cpu", "gl", "cl"}) {
        const std::unique_ptr<Device> device = makeDevice(backend, gl, {}, clDevice);
        if (std::string_view(backend) != backendName(device->backend())) continue;  // there is none
        for (const PlanRow& row : plans().rows) {
            if ((row.plan == Plan::behind) != (row.plan == Plan::behind && device->backend() == Backend::cpu)) continue;
            if (row.plan == Plan::thesis && device->backend() == Backend::cpu) continue;
            Result<std::unique_ptr<Session>> session = Session::create(scene, *device, {});
            if (!session) {
                log.notice(fmt::format("--cooperate auto leaves {} out: {}", backend, session.error().message));
                if (!why) why = session.error();
                break;
            }
            Cooperation work(**session, row.plan, nullptr, {});
            if (work.plan() != row.plan) continue;
            PlanTried tried{backend, row.plan, 0, {}};
            std::vector<double> ms;
            std::map<std::string, PassTime> sums;
            work.start(frameSeconds(scene), false);
            double last = hostSeconds();
            for (int f = 0; f < 2 * frames; ++f) {
                work.finish();
                std::vector<PassTime> passes = device->takeTimes(), drawn;
                if (Status done = draw(
                        **session, [&] { work.start(frameSeconds(scene), false); }, drawn);
                    !done)
                    return done.error();
                const double now = hostSeconds();
                if (f >= frames) {
                    ms.push_back(1000 * (now - last));
                    for (PassTime& p : drawn) p.name = "render: " + p.name;
                    for (const std::vector<PassTime>* list : {&passes, &drawn})
                        for (const PassTime& p : *list) {
                            PassTime& sum = sums[p.name];
                            sum.name = p.name;
                            sum.ms += p.ms / frames;
                            sum.calls += p.calls;
                        }
                }
                last = now;
            }
            work.finish();
            if (const DeviceHealth health = device->health(); health.state != DeviceHealth::works) {
                log.notice(fmt::format("--cooperate auto leaves {} out: it {}", backend, health.why));
                break;
            }
            if (row.plan == Plan::thesis && !work.helped()) continue;
            tried.frameMs = spreadOf(std::move(ms)).median;
            for (auto& [name, sum] : sums) tried.passes.push_back(std::move(sum));
            all.push_back(std::move(tried));
        }
    }
    if (all.empty()) return why.value_or(failed("no device could try the scene"));
    std::stable_sort(all.begin(), all.end(), [](const PlanTried& a, const PlanTried& b) { return a.frameMs < b.frameMs; });
    return all;
}

}  // namespace rivulet
