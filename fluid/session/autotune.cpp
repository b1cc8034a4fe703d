#include "fluid/session/autotune.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace rivulet {

namespace {

constexpr int kTurns = 6, kFramesATurn = 3;
constexpr double kFarBehind = 1.5;       // times the fastest so far
constexpr double kFarBehindFirst = 4.0;  // the same in the turn that warms up

const char* rowOf(Plan plan) {
    for (const PlanRow& row : plans().rows)
        if (row.plan == plan) return row.name;
    return "";
}

}  // namespace

std::string nameOf(const PlanTried& tried) {
    return tried.plan == Plan::alone ? tried.backend : fmt::format("{}, {}", tried.backend, rowOf(tried.plan));
}

Result<Autotune> Autotune::create(const SceneFile& scene, Device& device, Plan plan, const Log& log) {
    auto session = Session::create(scene, device, {});
    if (!session) return session.error();
    Autotune trial;
    trial.tried_.backend = backendName(device.backend());
    trial.tried_.plan = plan;
    trial.session_ = std::move(*session);
    trial.timeline_ = std::make_unique<Timeline>();
    trial.work_ = std::make_unique<Cooperation>(*trial.session_, plan, trial.timeline_.get(), log);
    return trial;
}

Status Autotune::run(const DrawFrame& draw, int frames) {
    Session& session = *session_;
    Device& device = session.world().device();
    double whole = 0, stepping = 0, drawing = 0;
    lastMs_ = std::numeric_limits<double>::max();
    for (int k = 0; k <= frames; ++k) {
        const double start = hostSeconds();
        if (!work_->started()) work_->start(frameSeconds(session.scene()), true);
        work_->finish();
        for (const PassTime& t : device.takeTimes())
            if (k > 0) tried_.passes[t.name] += t.ms;
        const double stepped = hostSeconds();
        double uploaded = stepped;
        std::vector<PassTime> drawn;
        const auto next = [&] {
            // Also in the last one: each counted frame is drawn beside a step.
            work_->start(frameSeconds(session.scene()), true);
            uploaded = hostSeconds();
        };
        if (Status done = draw(session, next, drawn); !done) return done;
        const double done = hostSeconds();
        timeline_->add(kDrawingLane, {"drawn", uploaded, done});
        if (k == 0) continue;
        for (const PassTime& t : drawn) tried_.drawing[t.name] += t.ms;
        whole += done - start;
        stepping += stepped - start;
        drawing += done - stepped;
        lastMs_ = std::min(lastMs_, 1000 * (done - start));
    }
    work_->drop();
    device.takeTimes();
    if (const DeviceHealth health = device.health(); health.state != DeviceHealth::works)
        return failed(fmt::format("{} {}: its times are invalid", device.info().name, health.why));
    frames_ += frames;
    frame_.push_back(1000 * whole / frames);
    step_.push_back(1000 * stepping / frames);
    draw_.push_back(1000 * drawing / frames);
    return ok();
}

void Autotune::forget() {
    for (std::vector<double>* ms : {&frame_, &step_, &draw_}) ms->clear();
    tried_.passes.clear();
    tried_.drawing.clear();
    frames_ = 0;
}

bool Autotune::couldHelp() const { return work_->plan() == tried_.plan && (tried_.plan != Plan::thesis || work_->helped()); }

double Autotune::lastMs() const { return lastMs_; }

PlanTried Autotune::result() const {
    PlanTried all = tried_;
    all.frameMs = spreadOf(frame_);
    all.turns = frame_;
    all.stepMs = spreadOf(step_).median;
    all.drawMs = spreadOf(draw_).median;
    all.overlapMs = work_->stats().overlapMs;
    for (auto* passes : {&all.passes, &all.drawing})
        for (auto& [name, ms] : *passes) ms /= std::max(frames_, 1);
    return all;
}

namespace {

struct Contest {
    const PlanRequest& request;
    std::vector<std::unique_ptr<Device>> devices = {};
    std::vector<Autotune> trials = {};
    std::optional<Error> why = {};  // the first device cannot

    void leaveOut(std::string_view backend, const std::string& sentence) const {
        request.log.notice(fmt::format("--cooperate auto skips {}: {}", backend, sentence));
    }

    void enter() {
        for (const char* backend : {"cpu", "gl", "cl"}) {
            devices.push_back(makeDevice(backend, request.gl, {}, request.clDevice));
            Device& device = *devices.back();
            if (std::string_view(backend) != backendName(device.backend())) continue;  // not available here
            const bool cpu = device.backend() == Backend::cpu;
            for (const Plan plan : {Plan::alone, cpu ? Plan::behind : Plan::thesis}) {
                Result<Autotune> made = Autotune::create(request.scene, device, plan, {});
                if (!made) {
                    leaveOut(nameOf({.backend = backend, .plan = plan}), made.error().message);
                    if (plan != Plan::alone) device.forgiveFull();  // the plan before still fits
                    if (!why) why = made.error();
                    break;
                }
                if (made->couldHelp() || plan == Plan::thesis) trials.push_back(std::move(*made));
            }
        }
    }

    // Keeps the trials within `far` times the fastest of the turn.
    Status turn(int at, int frames, double far) {
        std::vector<double> ms(trials.size(), std::numeric_limits<double>::max());
        double best = std::numeric_limits<double>::max();
        for (size_t k = 0; k < trials.size(); ++k) {
            const size_t which = (k + static_cast<size_t>(at)) % trials.size();  // the order rotates
            Autotune& trial = trials[which];
            request.progress((at + static_cast<double>(k) / static_cast<double>(trials.size())) / (kTurns + 1), nameOf(trial.result()));
            Device& device = trial.session().world().device();
            if (device.health().state == DeviceHealth::works) {
                const Status done = trial.run(request.draw, frames);
                if (!done && device.health().state == DeviceHealth::works) return done;  // drawing fails for all
                if (!done) leaveOut(backendName(device.backend()), done.error().message);
                if (done && trial.couldHelp()) ms[which] = trial.lastMs();
            }
            best = std::min(best, ms[which]);
        }
        size_t k = 0;
        std::erase_if(trials, [&](const Autotune&) { return !(ms[k++] <= far * best); });
        return ok();
    }
};

}  // namespace

Result<std::vector<PlanTried>> tryPlans(const PlanRequest& request) {
    if (request.scene.budget.frameMs > 0)
        return badInput(
            "--cooperate auto compares plans with equal settings, but budget.frameMs picks a setting per device: choose a plan instead");
    Contest contest{request};
    contest.enter();
    const double start = hostSeconds();
    // The first turn compiles kernels and fills caches: it is not counted.
    if (Status done = contest.turn(0, 2, kFarBehindFirst); !done) return done.error();
    for (Autotune& trial : contest.trials) trial.forget();
    for (int at = 1; at <= kTurns && (at == 1 || hostSeconds() - start < request.seconds); ++at)
        if (Status done = contest.turn(at, kFramesATurn, kFarBehind); !done) return done.error();
    if (contest.trials.empty()) return contest.why.value_or(failed("no device can run the scene"));
    std::vector<PlanTried> all;
    for (const Autotune& trial : contest.trials) all.push_back(trial.result());
    std::stable_sort(all.begin(), all.end(), [](const PlanTried& a, const PlanTried& b) { return a.frameMs.median < b.frameMs.median; });
    return all;
}

double beyond(const PlanTried& own, const PlanTried& other) {
    std::vector<double> ratios;  // some turns are slower for both
    for (size_t k = 0; k < std::min(own.turns.size(), other.turns.size()); ++k) ratios.push_back(own.turns[k] / other.turns[k] - 1);
    return spreadOf(std::move(ratios)).median;
}

std::string sentenceOf(std::span<const PlanTried> tried, std::string_view named) {
    std::string others;
    for (const PlanTried& t : tried.subspan(1))
        others += fmt::format("{}{} {:.1f}", others.empty() ? "" : ", ", nameOf(t), t.frameMs.median);
    const PlanTried& best = tried.front();
    return fmt::format("--cooperate auto: {}, {:.1f} ms per frame{}{}", nameOf(best), best.frameMs.median,
                       others.empty() ? "" : fmt::format(" ({})", others),
                       named != "auto" && named != best.backend ? fmt::format("; it replaces --backend {}", named) : "");
}

std::vector<CooperationStats::Tried> statsOf(std::span<const PlanTried> tried) {
    std::vector<CooperationStats::Tried> all;
    for (const PlanTried& t : tried) {
        CooperationStats::Tried& row = all.emplace_back(CooperationStats::Tried{nameOf(t), t.frameMs.median, t.passes});
        for (const auto& [name, ms] : t.drawing) row.passes["render: " + name] = ms;
    }
    return all;
}

}  // namespace rivulet
