#include "tests/fuzz/fuzz_run.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>

#include "engine/compute/device_cpu.h"
#include "engine/core/json.h"
#include "engine/core/sanitized.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet::fuzz {

namespace {

// After this number of sweeps over all neighbours a case continues with one step a frame.
constexpr uint64_t kDear = 6000;
constexpr rlim_t kHangs = 300;                // s, on the processor
constexpr rlim_t kMemory = rlim_t{6} << 30U;  // bytes: beyond it an allocation fails, and that is to be said plainly

bool plainSentence(const std::string& s) { return s.size() > 10 && s.find('\n') == std::string::npos; }

// Returns "", or the first value that is not finite.
std::string notFinite(const FluidStats& s) {
    for (const auto& [name, value] :
         {std::pair("emitted", s.emitted), std::pair("drained", s.drained), std::pair("backlog", s.backlog),
          std::pair("avgCompression", s.avgCompression), std::pair("maxCompression", s.maxCompression), std::pair("kinetic", s.kinetic),
          std::pair("potential", s.potential), std::pair("centreOfMass.x", s.centreOfMass[0]),
          std::pair("centreOfMass.y", s.centreOfMass[1]), std::pair("centreOfMass.z", s.centreOfMass[2]), std::pair("maxSpeed", s.maxSpeed),
          std::pair("iterations", s.iterations), std::pair("residual", s.residual.value_or(0)), std::pair("dtMin", s.dtMin),
          std::pair("dtMax", s.dtMax)})
        if (!std::isfinite(value)) return fmt::format("stats.{} is {}", name, value);
    return "";
}

class Runner {
  public:
    Runner(const Case& c, int& frame) : case_(c), frame_(frame), draft_(c.scene) {}

    Outcome run() {
        const std::vector<CpuKernelRow> rows = cpuKernels();
        device_ = makeCpuDevice(rows, {.threads = 1, .isa = bestIsa()});
        if (Status sense = checkScene(draft_); !sense) return refused(sense.error());
        if (Status started = start(); !started) return refused(started.error());
        Random random(case_.frameSeed);
        for (frame_ = 0; frame_ < case_.frames && wrong_.empty(); ++frame_) {
            for (const Drag& d : case_.drags)
                if (d.frame == frame_) drag(d);
            if (!wrong_.empty()) break;
            step(frameLength(random));
        }
        if (!wrong_.empty()) {
            outcome_.verdict = Outcome::Verdict::failed;
            outcome_.sentence = fmt::format("frame {}: {}", frame_, wrong_);
        }
        outcome_.limited = static_cast<int>(session_->world().stats().limited.size());
        return outcome_;
    }

  private:
    Outcome refused(const Error& error) {
        outcome_.verdict = plainSentence(error.message) ? Outcome::Verdict::refused : Outcome::Verdict::failed;
        outcome_.sentence = error.message;
        return outcome_;
    }

    Status start() {
        Result<std::unique_ptr<Session>> made = Session::create(draft_, *device_, Log{});
        if (!made) return made.error();
        session_ = std::move(*made);
        asked_ = sweeps_ = 0;
        return ok();
    }

    double frameLength(Random& random) const {
        constexpr double kFrame = 1.0 / kFramesPerSecond;
        if (case_.frameSeed == 0) return kFrame;
        const size_t pick = below(random, 20);
        return pick == 0 ? 0.25 : pick == 1 ? 1.0e-4 : pick == 2 ? 0 : pick == 3 ? 0.05 * uniform(random) : kFrame;
    }

    // As the window takes edits (Viewer::takeEdits).
    void drag(const Drag& d) {
        const SceneFile before = draft_;
        const Status set = setParam(d.path + "=" + d.value, [this](ParamVisitor& v) { draft_.visit(v); });
        if (!set) {
            wrong_ = "a slider's own value is refused: " + set.error().message;
            return;
        }
        if (outcome_.slowed > 0) draft_.fluid.maxSubsteps = 1;
        Status sense = checkScene(draft_);
        if (sense && session_->needsNew(draft_)) {
            sense = start();
        } else if (sense) {
            session_->apply(draft_);
        }
        if (sense) return;
        if (!plainSentence(sense.error().message)) wrong_ = "a drag is refused with: " + sense.error().message;
        ++outcome_.refusedDrags;
        draft_ = before;
    }

    void step(double seconds) {
        FluidWorld& world = session_->world();
        const double before = world.time();
        session_->step(seconds, true);
        asked_ += seconds;
        const FluidStats& stats = world.stats();
        wrong_ = judge(world, stats, seconds, world.time() - before);
        sweeps_ = stats.sweeps;
        outcome_.slept += stats.asleep > 0 ? 1 : 0;
        if (sweeps_ > kDear && outcome_.slowed == 0) {
            outcome_.slowed = frame_ + 1;
            draft_.fluid.maxSubsteps = 1;
            session_->apply(draft_);
        }
    }

    std::string judge(FluidWorld& world, const FluidStats& stats, double seconds, double stepped) {
        const HostParticles p = readParticles(world);
        const float spacing = world.params().spacing;
        const BoxParams& box = world.params().box;
        const double bound = mostSpeed(world, stats, seconds, stepped);
        for (size_t i = 0; i < p.position.size(); ++i) {
            const vec4 &x = p.position[i], &v = p.velocity[i];
            if (!isFinite(vec3(x)) || !std::isfinite(x.w) || !isFinite(vec3(v)))
                return fmt::format("particle {} is at ({}, {}, {}), density {}, velocity ({}, {}, {})", p.id[i], x.x, x.y, x.z, x.w, v.x,
                                   v.y, v.z);
            const vec3 within = glm::clamp(vec3(x), box.min, box.max);
            if (glm::distance(within, vec3(x)) > 1.0e-3F * spacing)
                return fmt::format("particle {} is at ({}, {}, {}), out of the box", p.id[i], x.x, x.y, x.z);
            const double speed = glm::length(dvec3(v));
            if (stepped > 0 && speed > bound)
                return fmt::format("particle {} has {} m/s, {} times what a step allows ({} steps in {} s)", p.id[i], speed, speed / bound,
                                   world.lastSubsteps(), stepped);
        }
        if (std::string bad = notFinite(stats); !bad.empty()) return bad;
        if (stats.nan > 0) return fmt::format("{} particles are NaN", stats.nan);
        if (stats.lost > 0) return fmt::format("{} particles are lost", stats.lost);
        const auto resting =
            std::count_if(p.velocity.begin(), p.velocity.end(), [](const vec4& v) { return v.w < 0 && vec3(v) == vec3(0.0F); });
        if (stepped > 0 && resting != static_cast<std::ptrdiff_t>(stats.asleep))
            return fmt::format("{} particles sleep and stand still, {} in the stats", resting, stats.asleep);
        if (std::set<uint32_t>(p.id.begin(), p.id.end()).size() != p.id.size()) return "two particles have one id";
        const double volume = std::pow(double{spacing}, 3), there = (stats.emitted - stats.drained) / volume;
        if (p.position.size() != stats.particles || std::abs(there - stats.particles) > 0.01)
            return fmt::format("{} particles in the arrays, {} in the stats, {} in the ledger", p.position.size(), stats.particles, there);
        for (const BodyState& b : world.bodies())
            if (!isFinite(b.pose.position) || !isFinite(b.velocity) || !isFinite(b.spin)) return "a body's state is not finite";
        const double accounted = world.time() + world.pending() + world.dropped();
        if (std::abs(accounted - asked_) > 1.0e-9 * std::max(asked_, 1.0))
            return fmt::format("{} s were asked for: {} simulated, {} pending, {} dropped", asked_, world.time(), world.pending(),
                               world.dropped());
        return "";
    }

    double mostSpeed(FluidWorld& world, const FluidStats& stats, double seconds, double stepped) const {
        const bool moving = !world.poses().empty() || !world.bodies().empty() || session_->fields().deforming.size() > 0;
        // One piece of equal steps: else the shortest step ever is all that is known.
        const bool one = seconds <= 1.0 / kFramesPerSecond + 1.0e-9 && world.params().fixedStep == 0.0F && !moving;
        const double dt = one ? stepped / std::max(world.lastSubsteps(), 1) : stats.dtMin;
        return (moving ? 3.003 : 1.001) * double{world.params().spacing} / dt;
    }

    const Case& case_;
    int& frame_;
    SceneFile draft_;
    std::unique_ptr<CpuDevice> device_;
    std::unique_ptr<Session> session_;
    Outcome outcome_;
    std::string wrong_;
    double asked_ = 0;
    uint64_t sweeps_ = 0;
};

// The result that a child process sends to its parent.
std::string packed(const Outcome& o) {
    return fmt::format("{} {} {} {} {} {}", static_cast<int>(o.verdict), o.refusedDrags, o.slowed, o.limited, o.slept, o.sentence);
}

bool unpack(const std::string& text, Outcome& o) {
    int verdict = 0, at = 0;
    if (std::sscanf(text.c_str(), "%d %d %d %d %d %n", &verdict, &o.refusedDrags, &o.slowed, &o.limited, &o.slept, &at) != 5) return false;
    o.verdict = static_cast<Outcome::Verdict>(verdict);
    o.sentence = text.substr(static_cast<size_t>(at));
    return true;
}

// An exception that leaves is a crash.
void child(const Case& c, int& frame, int out) noexcept {
    const rlimit hangs{kHangs, kHangs + 5};
    ::setrlimit(RLIMIT_CPU, &hangs);
    if (!kSanitized) {
        const rlimit memory{kMemory, kMemory};
        ::setrlimit(RLIMIT_AS, &memory);
    }
    const rlimit noCore{0, 0};
    ::setrlimit(RLIMIT_CORE, &noCore);
    const std::string text = packed(Runner(c, frame).run());
    for (size_t sent = 0; sent < text.size();) {
        const ssize_t n = ::write(out, text.data() + sent, text.size() - sent);
        if (n <= 0) break;
        sent += static_cast<size_t>(n);
    }
    ::_exit(0);
}

Outcome failedWith(std::string sentence) {
    Outcome o;
    o.verdict = Outcome::Verdict::failed;
    o.sentence = std::move(sentence);
    return o;
}

}  // namespace

Outcome run(const Case& c) {
    int ends[2];
    void* shared = ::mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED || ::pipe(ends) != 0) return failedWith("no pipe to a child process");
    int& frame = *static_cast<int*>(shared);
    frame = -1;  // while the scene is made
    std::fflush(nullptr);
    const pid_t pid = ::fork();
    if (pid == 0) {
        ::close(ends[0]);
        child(c, frame, ends[1]);
    }
    ::close(ends[1]);
    std::string text;
    char bytes[4096];
    for (ssize_t n = 0; (n = ::read(ends[0], bytes, sizeof bytes)) > 0;) text.append(bytes, static_cast<size_t>(n));
    ::close(ends[0]);
    int status = 0;
    rusage used{};
    ::wait4(pid, &status, 0, &used);
    Outcome o;
    if (WIFSIGNALED(status))
        o = failedWith(
            fmt::format("frame {}: it {} ({})", frame, WTERMSIG(status) == SIGXCPU ? "hangs" : "crashed", strsignal(WTERMSIG(status))));
    else if (WEXITSTATUS(status) != 0 || !unpack(text, o))
        o = failedWith(fmt::format("frame {}: it ended with exit status {}", frame, WEXITSTATUS(status)));
    o.seconds = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                1.0e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    ::munmap(shared, sizeof(int));
    return o;
}

std::string report(const Case& c, const Outcome& outcome) {
    std::string text = fmt::format("{}\n  {}\n  repeat it: RIVULET_FUZZ=\"{}\" test_fuzz\n", outcome.sentence, c.name, c.name);
    for (const std::string& s : c.set) text += "  set: " + s + "\n";
    for (const Drag& d : c.drags) text += fmt::format("  before frame {}, dragged: {} = {}\n", d.frame, d.path, d.value);
    if (outcome.slowed > 0) text += fmt::format("  before frame {}, for its cost: fluid.maxSubsteps = 1\n", outcome.slowed);
    return text + "  the scene, as rivulet run takes it:\n" + sceneText(c.scene);
}

}  // namespace rivulet::fuzz
