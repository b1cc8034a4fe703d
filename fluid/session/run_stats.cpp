#include "fluid/session/run_stats.h"

#include <fmt/format.h>
#include <json/json.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

#include "engine/core/json_text.h"

namespace rivulet {

Spread spreadOf(std::vector<double> values) {
    Spread spread;
    spread.count = values.size();
    if (values.empty()) return spread;
    std::sort(values.begin(), values.end());
    size_t n = values.size();
    spread.min = values.front();
    spread.max = values.back();
    spread.median = n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
    spread.p95 = values[std::min(n - 1, (n * 95 + 99) / 100 - 1)];  // the nearest rank
    return spread;
}

void Samples::add(double value) {
    all_.min = all_.count == 0 ? value : std::min(all_.min, value);
    all_.max = all_.count == 0 ? value : std::max(all_.max, value);
    if (all_.count++ % every_ != 0) return;
    kept_.push_back(value);
    if (kept_.size() < kMost) return;
    for (size_t k = 0; k < kMost / 2; ++k) kept_[k] = kept_[2 * k];
    kept_.resize(kMost / 2);
    every_ *= 2;
}

Spread Samples::spread() const {
    Spread spread = spreadOf(kept_);
    spread.count = all_.count;
    spread.min = all_.min;
    spread.max = all_.max;
    return spread;
}

std::optional<double> bulkFront(std::span<const vec4> positions, const BoxParams& box, float spacing) {
    // The floor in squares of half a spacing: a particle covers the nearest 2 x 2, a slab is four squares wide.
    double square = 0.5 * static_cast<double>(spacing);
    vec3 size = box.max - box.min;
    if (!(square > 0) || !(size.x > 0) || !(size.z > 0)) return std::nullopt;
    constexpr int kSlab = 4;
    auto along = static_cast<int64_t>(std::ceil(static_cast<double>(size.x) / square / kSlab - 1e-6)) * kSlab;
    auto across = static_cast<int64_t>(std::max(1.0, std::round(static_cast<double>(size.z) / square)));
    constexpr int64_t kMostSquares = 1 << 28;
    if (along > kMostSquares || across > kMostSquares || along * across > kMostSquares) return std::nullopt;
    std::vector<bool> covered(static_cast<size_t>(along * across));
    for (const vec4& p : positions) {
        if (!isFinite(vec3(p)) || p.y >= box.min.y + 2 * spacing) continue;
        double x = std::round(static_cast<double>(p.x - box.min.x) / square), z = std::round(static_cast<double>(p.z - box.min.z) / square);
        if (x < 0 || z < 0 || x > static_cast<double>(along) || z > static_cast<double>(across)) continue;
        auto column = static_cast<int64_t>(x), row = static_cast<int64_t>(z);
        for (int64_t i = std::max<int64_t>(column - 1, 0); i <= std::min(column, along - 1); ++i)
            for (int64_t k = std::max<int64_t>(row - 1, 0); k <= std::min(row, across - 1); ++k)
                covered[static_cast<size_t>(i * across + k)] = true;
    }
    std::vector<double> share(static_cast<size_t>(along / kSlab));
    for (size_t slab = 0; slab < share.size(); ++slab) {
        auto from = covered.begin() + static_cast<int64_t>(slab) * kSlab * across;
        share[slab] = static_cast<double>(std::count(from, from + kSlab * across, true)) / static_cast<double>(kSlab * across);
    }
    constexpr double kWet = 0.25;
    for (size_t slab = share.size(); slab-- > 0;) {
        if (share[slab] < kWet) continue;
        double next = slab + 1 < share.size() ? share[slab + 1] : kWet;
        double between = share[slab] > next ? (share[slab] - kWet) / (share[slab] - next) : 0;
        if (slab + 1 == share.size()) between = 0.5;  // it has reached the far wall
        return static_cast<double>(box.min.x) + (static_cast<double>(slab) + 0.5 + between) * kSlab * square;
    }
    return std::nullopt;
}

bool inSetVoxel(const VoxelGrid& surface, const vec4& p) {
    if (surface.count() == 0 || !isFinite(vec3(p))) return false;
    int64_t cell[3];
    for (int axis = 0; axis < 3; ++axis) {
        double c =
            std::floor((static_cast<double>(p[axis]) - static_cast<double>(surface.origin[axis])) / static_cast<double>(surface.voxel));
        if (!(c >= 0 && c < surface.size[axis])) return false;
        cell[axis] = static_cast<int64_t>(c);
    }
    auto bit = static_cast<size_t>((cell[2] * surface.size.y + cell[1]) * surface.size.x + cell[0]);
    return ((surface.bits[bit / 8] >> (bit % 8)) & 1U) != 0;
}

RunRecorder::RunRecorder(FluidWorld& world, SolidFields fields, bool readBack, const SkinFlows* flows)
    : world_(&world), flows_(flows), fields_(std::move(fields)), readBack_(readBack), penetrated_(world.particles().count) {}

bool RunRecorder::inSolid(const vec4& p) const {
    if (fields_.still != nullptr && inSetVoxel(fields_.still->surface, p)) return true;
    for (const VoxelField* field : fields_.deforming)
        if (inSetVoxel(field->surface, p)) return true;
    for (size_t k = 0; k < fields_.rigid.size(); ++k)
        if (inSetVoxel(fields_.rigid[k]->surface, vec4(world_->poses()[k].toOwn(vec3(p)), p.w))) return true;
    return false;
}

void RunRecorder::drawn(double renderMs, double frameMs, std::span<const PassTime> passes) {
    if (renderMs > 0) render_.add(renderMs);
    frame_.add(frameMs);
    wallMs_ += frameMs;
    for (const PassTime& pass : passes) passes_["render: " + pass.name].add(pass.ms);
}

void RunRecorder::transferred(const TransferFacts& facts) {
    transfer_.add(facts.ms);
    transferStats_.way = facts.way;
    transferStats_.why = facts.why;
    transferStats_.bytes += static_cast<double>(facts.bytes);
    transferStats_.waits = facts.waits;
}

void RunRecorder::stepped(double simulateMs, std::span<const PassTime> passes) {
    simulate_.add(simulateMs);
    for (const PassTime& pass : passes) passes_[pass.name].add(pass.ms);
    substeps_ += static_cast<uint64_t>(world_->lastSubsteps());
    const FluidStats& f = world_->stats();
    iterations_ += f.iterations * world_->lastSubsteps();
    awake_ += static_cast<double>(f.particles - f.asleep) * world_->lastSubsteps();
    present_ += static_cast<double>(f.particles) * world_->lastSubsteps();
    takeLoads();
    if (!readBack_) return;

    HostParticles now = readParticles(*world_);
    double sum = 0;
    size_t counted = 0;
    for (size_t i = 0; i < now.position.size(); ++i) {
        const vec4& p = now.position[i];
        if (!isFinite(vec3(p)) || !std::isfinite(p.w)) continue;
        double compression = std::max(static_cast<double>(p.w) - 1, 0.0);
        sum += compression;
        ++counted;
        maxCompression_ = std::max(maxCompression_, compression);
        if (now.id[i] < penetrated_.size() && inSolid(p)) penetrated_[now.id[i]] = true;
    }
    if (counted > 0) {
        compressionSum_ += sum / static_cast<double>(counted);
        ++compressionFrames_;
    }
    last_ = endOf(now, *world_);
}

RunRecorder::End RunRecorder::endOf(const HostParticles& now, const FluidWorld& world) {
    const FluidParams& params = world.params();
    End end;
    end.particles = now.position.size();
    dvec3 sum(0.0);
    double counted = 0;
    for (size_t i = 0; i < now.position.size(); ++i) {
        vec3 p(now.position[i]), v(now.velocity[i]);
        if (!isFinite(p) || !isFinite(v)) continue;
        const auto mass = static_cast<double>(now.mass[i]);
        sum += mass * dvec3(p);
        end.kinetic += 0.5 * mass * glm::dot(dvec3(v), dvec3(v));
        end.potential -= mass * glm::dot(dvec3(params.gravity), dvec3(p));
        counted += mass;
    }
    if (counted > 0) end.centreOfMass = sum / counted;
    end.front = bulkFront(now.position, params.box, world.particles().spacing);
    const vec3 slack(2 * world.particles().spacing);
    for (const vec4& p : now.position) {
        const vec3 x(p);
        end.within += isFinite(x) && glm::clamp(x, params.box.min - slack, params.box.max + slack) == x ? 1 : 0;
    }
    return end;
}

void RunRecorder::takeLoads() {
    std::vector<ProbeFrame> arrived = world_->takeLoads();
    std::move(arrived.begin(), arrived.end(), std::back_inserter(loads_));
}

RunStats::Ledger ledgerOf(const FluidStats& late, double inWorld, double one, const SkinFlows::Ledger* skins) {
    RunStats::Ledger l;
    l.emitted = late.emitted;
    l.drained = late.drained;
    l.inWorld = inWorld;
    // The world counts particles, skins picolitres: the balance is in each unit, so that rounding is no error.
    double missing = std::abs(std::round((l.emitted - l.inWorld - l.drained - late.withdrawn) / one)) * one;
    if (skins != nullptr) {
        l.pending = late.pendingVolume;
        l.inWorld += l.pending;
        // The volume from skins to the world, less what became particles, is pending; the volume back is what skins received, up to
        // rounding.
        constexpr double kPicolitre = 1.0e-15;  // m^3
        const double handed = std::abs(skins->poured - late.deposited - late.pendingVolume) + std::abs(late.withdrawn - skins->taken);
        missing += skins->error + (handed < kPicolitre ? 0 : handed);
        l.emitted += skins->emitted - late.deposited;
        l.onSurface = skins->onSurface;
        l.inAir = skins->inAir;
        l.evaporated = skins->evaporated;
        l.drained += skins->drained;
    }
    l.error = l.emitted > 0 ? missing / l.emitted : 0;
    return l;
}

RunStats RunRecorder::finish(std::string scene) {
    FluidWorld& world = *world_;
    world.device().finish();
    world.device().poll();
    takeLoads();
    const FluidStats& late = world.stats();
    End end = last_;
    if (!world.interrupted())
        end = endOf(readParticles(world), world);
    else if (simulate_.count() == 0)
        end.particles = end.within = late.particles;
    const FluidParams& params = world.params();

    RunStats stats;
    stats.scene = std::move(scene);
    stats.machine = machineName();
    const DeviceInfo& device = world.device().info();
    stats.device = device.driver.empty() ? device.name : fmt::format("{}, {}", device.name, device.driver);
    stats.backend = backendName(world.device().backend());
    stats.method = params.method;
    stats.particles = static_cast<uint32_t>(end.particles);
    stats.frames = frame_.count();
    stats.seconds = world.time();
    stats.wallSeconds = wallMs_ * 1e-3;
    stats.simulateMs = simulate_.spread();
    stats.renderMs = render_.spread();
    stats.frameMs = frame_.spread();
    stats.transfer = transferStats_;
    stats.transfer.ms = transfer_.spread();
    if (transfer_.count() > 0) stats.transfer.bytes /= static_cast<double>(transfer_.count());
    for (const auto& [name, ms] : passes_) stats.passes[name] = ms.spread();

    stats.kinetic = end.kinetic;
    stats.potential = end.potential;
    stats.centreOfMass = end.centreOfMass;
    stats.avgCompression = compressionFrames_ > 0 ? compressionSum_ / static_cast<double>(compressionFrames_) : late.avgCompression;
    stats.maxCompression = readBack_ ? maxCompression_ : late.maxCompression;
    stats.front = end.front;
    stats.volume = stats.particles * std::pow(static_cast<double>(world.particles().spacing), 3);
    // The world's content is counted from positions; sources and sinks are counted by their passes.
    const double volumeOfOne = std::pow(static_cast<double>(world.particles().spacing), 3);
    const bool skins = flows_ != nullptr && !flows_->empty();
    const SkinFlows::Ledger onSkins = skins ? flows_->ledger() : SkinFlows::Ledger{};
    stats.ledger = ledgerOf(late, static_cast<double>(end.within) * volumeOfOne, volumeOfOne, skins ? &onSkins : nullptr);
    stats.lost = late.lost;
    stats.nan = late.nan;
    stats.penetrations = static_cast<uint32_t>(std::count(penetrated_.begin(), penetrated_.end(), true));
    stats.substeps = substeps_;
    stats.iterations = substeps_ > 0 ? iterations_ / static_cast<double>(substeps_) : 0.0;
    stats.asleep = late.asleep;
    stats.awakeShare = present_ > 0 ? awake_ / present_ : 1.0;
    stats.residual = late.residual;
    stats.origin = world.origin();
    stats.dropped = world.dropped();
    stats.voxelsRewritten = world.voxelsRewritten();
    const auto offStand = [&](const VoxelField& field) {
        const float spacing = world.particles().spacing;
        const double off = static_cast<double>(fieldParams(field, {.spacing = spacing}).contact) - 0.5 * static_cast<double>(spacing);
        stats.standOff = std::max(stats.standOff.value_or(0.0), off);
    };
    if (fields_.still != nullptr) offStand(*fields_.still);
    for (const auto* list : {&fields_.rigid, &fields_.deforming})
        for (const VoxelField* field : *list) offStand(*field);
    stats.dtMin = late.dtMin;
    stats.dtMax = late.dtMax;
    stats.limited = late.limited;
    stats.loads = loads_;
    return stats;
}

namespace {

// JSON has no NaN and no infinity.
Json::Value number(double v) { return std::isfinite(v) ? Json::Value(v) : Json::Value(); }

Json::Value jsonOf(const dvec3& v) {
    Json::Value list(Json::arrayValue);
    for (int axis = 0; axis < 3; ++axis) list.append(number(v[axis]));
    return list;
}

// A series of each probe: time and seconds of its frames, then the values of each. A change of the probes begins new series.
Json::Value seriesOf(const std::vector<ProbeFrame>& frames) {
    Json::Value all(Json::objectValue);
    for (const ProbeFrame& frame : frames)
        for (const ProbeReading& p : frame.probes) {
            Json::Value& series = all[p.name];
            series["time"].append(number(frame.time));
            series["seconds"].append(number(frame.seconds));
            series["force"].append(jsonOf(p.force));
            series["torque"].append(jsonOf(p.torque));
            if (p.pressure) series["pressure"].append(number(*p.pressure));
            series["impulse"] = jsonOf(p.impulse);
            series["angularImpulse"] = jsonOf(p.angularImpulse);
        }
    return all;
}

Json::Value jsonOf(const Spread& spread) {
    Json::Value v(Json::objectValue);
    v["min"] = number(spread.min);
    v["median"] = number(spread.median);
    v["p95"] = number(spread.p95);
    return v;
}

}  // namespace

std::string writeRunStats(const RunStats& stats) {
    Json::Value v(Json::objectValue);
    v["version"] = RIVULET_VERSION;
    v["scene"] = stats.scene;
    v["machine"] = stats.machine;
    v["device"] = stats.device;
    v["backend"] = stats.backend;
    v["method"] = stats.method;
    v["cooperation"]["plan"] = stats.cooperation.plan;
    v["cooperation"]["aheadMs"] = number(stats.cooperation.aheadMs);
    v["cooperation"]["overlapMs"] = number(stats.cooperation.overlapMs);
    for (const CooperationStats::Tried& tried : stats.cooperation.tried) {
        Json::Value row(Json::objectValue);
        row["plan"] = tried.plan;
        row["frameMs"] = number(tried.frameMs);
        for (const auto& [name, ms] : tried.passes) row["passes"][name] = number(ms);
        v["cooperation"]["tried"].append(std::move(row));
    }
    v["particles"] = stats.particles;
    v["frames"] = Json::UInt64(stats.frames);
    v["seconds"] = number(stats.seconds);
    v["wallSeconds"] = number(stats.wallSeconds);
    v["transfer"]["way"] = stats.transfer.way;
    v["transfer"]["why"] = stats.transfer.why;
    v["transfer"]["ms"] = jsonOf(stats.transfer.ms);
    v["transfer"]["bytes"] = number(stats.transfer.bytes);
    v["transfer"]["waits"] = Json::UInt64(stats.transfer.waits);
    v["simulateMs"] = jsonOf(stats.simulateMs);
    v["renderMs"] = jsonOf(stats.renderMs);
    v["frameMs"] = jsonOf(stats.frameMs);
    v["passes"] = Json::Value(Json::objectValue);
    for (const auto& [name, spread] : stats.passes) v["passes"][name] = jsonOf(spread);
    v["density"]["avgCompression"] = number(stats.avgCompression);
    v["density"]["maxCompression"] = number(stats.maxCompression);
    v["energy"]["kinetic"] = number(stats.kinetic);
    v["energy"]["potential"] = number(stats.potential);
    v["centreOfMass"] = Json::Value();
    if (stats.centreOfMass) {
        v["centreOfMass"] = Json::Value(Json::arrayValue);
        for (int axis = 0; axis < 3; ++axis) v["centreOfMass"].append(number((*stats.centreOfMass)[axis]));
    }
    v["front"] = stats.front ? Json::Value(*stats.front) : Json::Value();
    v["volume"] = number(stats.volume);
    v["lost"] = stats.lost;
    v["penetrations"] = stats.penetrations;
    v["nan"] = stats.nan;
    v["standOff"] = stats.standOff ? Json::Value(*stats.standOff) : Json::Value();
    v["voxelsRewritten"] = Json::UInt64(stats.voxelsRewritten);
    v["substeps"] = Json::UInt64(stats.substeps);
    v["iterations"] = number(stats.iterations);
    v["sleep"]["asleep"] = stats.asleep;
    v["sleep"]["awakeShare"] = number(stats.awakeShare);
    v["residual"] = stats.residual ? number(*stats.residual) : Json::Value();
    v["origin"] = Json::Value(Json::arrayValue);
    for (int axis = 0; axis < 3; ++axis) v["origin"].append(number(stats.origin[axis]));
    v["dropped"] = number(stats.dropped);
    v["dt"]["min"] = number(stats.dtMin);
    v["dt"]["max"] = number(stats.dtMax);
    const RunStats::Ledger& l = stats.ledger;
    for (const auto& [name, value] : {std::pair("emitted", l.emitted), std::pair("onSurface", l.onSurface), std::pair("inAir", l.inAir),
                                      std::pair("inWorld", l.inWorld), std::pair("debt", l.pending), std::pair("evaporated", l.evaporated),
                                      std::pair("drained", l.drained), std::pair("error", l.error)})
        v["ledger"][name] = number(value);
    v["limited"] = Json::Value(Json::arrayValue);
    for (const std::string& sentence : stats.limited) v["limited"].append(sentence);

    if (!stats.loads.empty()) v["probes"] = seriesOf(stats.loads);

    return jsonText(v, 9);
}

std::string machineName() {
    auto valueAfter = [](const char* file, std::string_view key, char separator) {
        std::ifstream stream(file);
        std::string line;
        while (std::getline(stream, line)) {
            if (!line.starts_with(key)) continue;
            size_t from = line.find_first_not_of(" \t\"", line.find(separator) + 1);
            if (from == std::string::npos) return std::string();
            size_t to = line.find_last_not_of(" \t\"");
            return line.substr(from, to - from + 1);
        }
        return std::string();
    };
    std::string processor = valueAfter("/proc/cpuinfo", "model name", ':');
    std::string system = valueAfter("/etc/os-release", "PRETTY_NAME", '=');
    if (processor.empty()) processor = "unknown processor";
    return fmt::format("{}, {} threads{}{}", processor, std::thread::hardware_concurrency(), system.empty() ? "" : ", ", system);
}

}  // namespace rivulet
