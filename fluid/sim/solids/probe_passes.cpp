#include "fluid/sim/solids/probe_passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fluid/sim/solids/body_passes.h"
#include "fluid/sim/solids/solid_passes.h"

namespace rivulet {

namespace {

// What a probe's params name in this world: kind, number (PROBE_ALL: all), area.
struct Target {
    ProbeOn on = ProbeOn::none;
    uint32_t index = PROBE_ALL;
    double area = 0;
};

constexpr const char* kFaces[] = {"-x", "+x", "-y", "+y", "-z", "+z"};

Result<Target> boxTarget(const ProbeParams& p, const BoxParams& box, const std::string& key) {
    Target t{.on = ProbeOn::box};
    const bvec3 periodic = box.periodic();
    if (p.face == "all") {
        if (!glm::all(periodic)) return t;
        return badInput(key + ".on is box, and fluid.box is periodic along all axes: remove the probe");
    }
    t.index = static_cast<uint32_t>(std::find(std::begin(kFaces), std::end(kFaces), p.face) - std::begin(kFaces));
    const int axis = static_cast<int>(t.index / 2);
    if (periodic[axis]) return badInput(fmt::format("{}.face is {}, and fluid.box is periodic there: choose another face", key, p.face));
    const dvec3 low = glm::max(dvec3(p.min), dvec3(box.min)), high = glm::min(dvec3(p.max), dvec3(box.max));
    const double a = high[(axis + 1) % 3] - low[(axis + 1) % 3], b = high[(axis + 2) % 3] - low[(axis + 2) % 3];
    const double wall = double{t.index % 2 == 0 ? box.min[axis] : box.max[axis]};
    if (!(a > 0 && b > 0) || double{p.min[axis]} > wall || double{p.max[axis]} < wall)
        return badInput(fmt::format("{}: the region does not reach the face {} of fluid.box: correct min and max", key, p.face));
    t.area = a * b;
    return t;
}

Result<Target> solidTarget(const ProbeParams& p, const ProbeTargets& there, const std::string& key) {
    const auto number = static_cast<size_t>(std::max(p.index, 0));
    const auto checked = [&](ProbeOn on, size_t count, const char* what) -> Result<Target> {
        if (count == 0) return badInput(fmt::format("{}.on is {}, and there is none: add one, or remove the probe", key, p.on));
        if (p.index >= 0 && number >= count)
            return badInput(
                fmt::format("{}.index is {}, and there are {} {}: give 0 to {}, or -1 for all", key, p.index, count, what, count - 1));
        return Target{.on = on, .index = p.index < 0 ? PROBE_ALL : static_cast<uint32_t>(number)};
    };
    if (p.on == "body") {
        if (there.bodies.empty() || p.index < 0) return checked(ProbeOn::body, there.bodies.size(), "bodies");
        const auto found = std::ranges::find(there.bodies, static_cast<uint32_t>(number));
        if (found == there.bodies.end())
            return badInput(
                fmt::format("{}.index is {}, and there is no body {}: remove the probe, or give -1 for all", key, p.index, p.index));
        return Target{.on = ProbeOn::body, .index = static_cast<uint32_t>(found - there.bodies.begin())};
    }
    if (p.on == "plane") return checked(ProbeOn::plane, there.planes, "planes");
    if (p.on == "rigid") return checked(ProbeOn::rigid, there.rigid, "rigid solids");
    if (p.on == "deforming") return checked(ProbeOn::deforming, there.deforming, "deforming solids");
    if (p.on == "still") return checked(ProbeOn::still, there.field ? kMostSurfaces : 0, "surfaces");
    if (p.index < 0) return badInput(key + ".on is collider, and index is -1: give the number of one collider, from 0");
    const std::vector<SolidRef>& all = there.colliders;
    if (number >= all.size())
        return badInput(
            fmt::format("{}.index is {}, and there are {} colliders: give the number of one of them, from 0", key, p.index, all.size()));
    if (all[number].on == ProbeOn::none) return badInput(fmt::format("{}: collider {} is not solid: it bears no load", key, number));
    for (size_t k = 0; k < all.size(); ++k)
        if (k != number && all[k].on == ProbeOn::still && all[number].on == ProbeOn::still && all[k].index == all[number].index)
            return badInput(
                fmt::format("{}: colliders {} and {} share a surface and cannot be measured apart: give them different friction", key,
                            std::min(k, number), std::max(k, number)));
    return Target{.on = all[number].on, .index = all[number].index};
}

Status checkRegion(const ProbeParams& p, const std::string& key) {
    if (p.name.empty()) return badInput(key + ".name is empty: give the probe a name");
    for (int axis = 0; axis < 3; ++axis)
        if (p.min[axis] > p.max[axis]) return badInput(fmt::format("{}.min is above its max along {}: exchange them", key, "xyz"[axis]));
    return ok();
}

dvec3 vectorOf(const vec4& v) { return dvec3(v); }

}  // namespace

ProbeTargets ProbeTargets::of(const Solids& solids) {
    std::vector<uint32_t> bodies(solids.bodies.size());
    std::iota(bodies.begin(), bodies.end(), 0U);
    return {.planes = solids.planes.size(),
            .rigid = solids.rigid.size(),
            .deforming = solids.deforming.size(),
            .bodies = std::move(bodies),
            .field = solids.field != nullptr && !solids.field->empty(),
            .colliders = solids.colliders};
}

Result<ProbePasses> ProbePasses::create(Device& device, const FluidParams& params, const ProbeTargets& targets, const World& world) {
    ProbePasses made(world);
    made.device_ = &device;
    made.field_ = targets.field;
    made.cubic_ = params.kernel == "cubic_spline";
    if (world.traits.linked)
        return badInput("fluid.grid linked_list does not support fluid.probes: remove them, or choose fluid.grid sorted");
    const std::vector<ProbeParams>& list = params.probes;
    if (list.size() > kMost) return badInput(fmt::format("fluid.probes has {} items, at most {} are possible", list.size(), kMost));
    std::vector<Spec> specs;
    std::vector<DeviceProbe> rows;
    for (size_t k = 0; k < list.size(); ++k) {
        const ProbeParams& p = list[k];
        const std::string key = fmt::format("fluid.probes[{}]", k);
        if (Status s = checkRegion(p, key); !s) return s.error();
        for (const Spec& other : specs)
            if (other.name == p.name) return badInput(fmt::format("{}.name is {}, as of another probe: give each its own", key, p.name));
        const Result<Target> target = p.on == "box" ? boxTarget(p, params.box, key) : solidTarget(p, targets, key);
        if (!target) return target.error();
        const double area = p.area > 0 ? double{p.area} : target->area;
        specs.push_back({p.name, target->on == ProbeOn::body ? 0.0 : area});
        rows.push_back({.low = vec4(p.min, 0.0F),
                        .high = vec4(p.max, 0.0F),
                        .about = vec4(p.about, 0.0F),
                        .on = static_cast<uint32_t>(target->on),
                        .index = target->index,
                        .count = static_cast<uint32_t>(list.size()),
                        .padding = 0});
        made.wanted_[static_cast<size_t>(target->on)] = true;
    }
    made.specs_ = std::make_shared<const std::vector<Spec>>(std::move(specs));
    const size_t slots = world.particles.count;
    for (const auto& [buffer, bytes] :
         {std::pair(&made.probes_, rows.size() * sizeof(DeviceProbe)),
          std::pair(&made.rows_, rows.size() * PROBE_THREADS * sizeof(ProbeRow)), std::pair(&made.carried_, 6 * slots * sizeof(vec4)),
          std::pair(&made.before_, slots * sizeof(vec4))}) {
        Result<Buffer> room = device.allocate(bytes);
        if (!room) return room.error();
        *buffer = std::move(*room);
    }
    device.writeAll<DeviceProbe>(made.probes_, rows);
    if (Status found = made.findKernels(); !found) return found.error();
    made.reset();
    return made;
}

Status ProbePasses::findKernels() {
    walled_ = world_.traits.walls;
    const bool matter = world_.traits.matter, moving = wants(ProbeOn::rigid) || wants(ProbeOn::deforming);
    const bool contact = wants(ProbeOn::still), walls = wantsWalls() && walled_, body = wants(ProbeOn::body);
    const auto defines = [](std::vector<Define> list) {
        std::sort(list.begin(), list.end(), [](const Define& a, const Define& b) { return a.name < b.name; });
        return list;
    };
    const auto with = [&](const char* name, bool also, const char* other, bool mass) {
        std::vector<Define> list;
        if (*name != 0) list.push_back({name, "1"});
        if (also) list.push_back({other, "1"});
        if (mass && matter) list.push_back({"MATTER", "1"});
        return defines(std::move(list));
    };
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    const char *atDistance = "fluid/solids/probe_walls", *response = "fluid/solids/probe_response", *carry = "fluid/solids/probe_carry";
    const bool still = wantsStill() && walled_;
    std::vector<Define> deforming = with("FRICTION", true, "MOVING", false);
    deforming.insert(deforming.begin(), {"DEFORMING", "1"});
    for (const Wanted& w : {Wanted{&pressure_.still, atDistance, with("PRESSURE", field_, "FIELD", false), still},
                            Wanted{&pressure_.rigid, atDistance, with("PRESSURE", true, "MOVING", false), moving},
                            Wanted{&friction_.still, atDistance, with("FRICTION", field_, "FIELD", false), still},
                            Wanted{&friction_.rigid, atDistance, with("FRICTION", true, "MOVING", false), wants(ProbeOn::rigid)},
                            Wanted{&friction_.deforming, atDistance, deforming, wants(ProbeOn::deforming)},
                            Wanted{&adhesion_.still, atDistance, with("ADHESION", field_, "FIELD", false), still},
                            Wanted{&carryPressure_, carry, with("PRESSURE", false, "", false), still || moving},
                            Wanted{&carryFriction_, carry, with("FRICTION", false, "", true), still || moving},
                            Wanted{&carryAdhesion_, carry, with("ADHESION", false, "", true), still},
                            Wanted{&carryContact_, carry, with("", false, "", true), contact || moving},
                            Wanted{&integrated_, response, with("", false, "", true), walls},
                            Wanted{&finished_, response, with("FROM_POSITIONS", false, "", true), walls},
                            Wanted{&predicted_, response, with("PREDICTS", false, "", true), walls},
                            Wanted{&arrived_, response, with("ARRIVED", false, "", true), walls},
                            Wanted{&contact_, "fluid/solids/probe_contact", {}, contact},
                            Wanted{&contactMoving_, "fluid/solids/probe_contact", with("MOVING", false, "", false), moving},
                            Wanted{&body_, "fluid/solids/probe_body", {}, body}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device_->kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    pressure_.deforming = pressure_.rigid;
    friction_.readsDisplacement = true;
    if (!(still || moving)) return ok();
    for (auto [kernel, list] : {std::pair(&load_, std::vector<Define>()), std::pair(&loadHeld_, std::vector<Define>{{"HELD", "1"}})}) {
        if (cubic_) list.push_back({"CUBIC", "1"});
        Result<PairKernel> found = PairKernel::find(*device_, "fluid/solids/wall_load", world_.traits, list);
        if (!found) return found.error();
        *kernel = *found;
    }
    return ok();
}

void ProbePasses::begin() { device_->fill(rows_, 0); }

void ProbePasses::end(const std::shared_ptr<ProbeFrame>& into, double time, double seconds) {
    if (!(seconds > 0)) return;
    device_->readLater(
        rows_, rows_.bytes(), [into, time, seconds, specs = specs_, weak = std::weak_ptr(totals_)](std::span<const std::byte> bytes) {
            const std::shared_ptr<Totals> totals = weak.lock();
            if (!totals) return;
            const auto* rows = reinterpret_cast<const ProbeRow*>(bytes.data());
            ProbeFrame frame{time, seconds, {}};
            for (size_t k = 0; k < specs->size(); ++k) {
                dvec3 impulse(0.0), angular(0.0);
                double normal = 0;
                for (size_t t = k * PROBE_THREADS; t < (k + 1) * PROBE_THREADS; ++t) {
                    impulse += vectorOf(rows[t].impulse);
                    angular += vectorOf(rows[t].angular);
                    normal += double{rows[t].impulse.w};
                }
                const Spec& spec = (*specs)[k];
                totals->impulse[k] += impulse;
                totals->angular[k] += angular;
                ProbeReading reading{spec.name, impulse / seconds, angular / seconds, {}, totals->impulse[k], totals->angular[k]};
                if (spec.area > 0) reading.pressure = normal / (spec.area * seconds);
                frame.probes.push_back(std::move(reading));
            }
            totals->arrived.push_back(frame);
            if (totals->arrived.size() > kMostFrames) totals->arrived.pop_front();
            *into = std::move(frame);
        });
}

std::vector<ProbeFrame> ProbePasses::take() {
    std::vector<ProbeFrame> frames(totals_->arrived.begin(), totals_->arrived.end());
    totals_->arrived.clear();
    return frames;
}

void ProbePasses::reset() {
    totals_ = std::make_shared<Totals>();  // reads in flight find the old ones gone
    totals_->impulse.assign(specs_->size(), dvec3(0.0));
    totals_->angular = totals_->impulse;
}

void ProbePasses::carry(const Kernel& kernel, const StepParams& step, const Buffer& into, std::initializer_list<const Buffer*> from,
                        bool matter) {
    std::vector<const Buffer*> buffers = {&world_.grid.cellStart(), &into};
    buffers.insert(buffers.end(), from);
    if (matter && world_.traits.matter) buffers.push_back(&world_.particles.matter);
    device_->dispatch(kernel, std::as_bytes(std::span(&step, 1)), buffers, step.count);
}

void ProbePasses::atDistance(const AtDistance& kernels, const StepParams& step, const Buffer& position, bool movingToo) {
    const SolidPasses& solids = world_.solids;
    const auto dispatch = [&](const Kernel& kernel, const StepParams& s, std::initializer_list<const Buffer*> walls) {
        std::vector<const Buffer*> buffers = {&world_.grid.cellStart(), &position, &probes_, &rows_, &carried_};
        for (const Buffer* wall : walls)
            if (wall != nullptr) buffers.push_back(wall);
        device_->dispatch(kernel, std::as_bytes(std::span(&s, 1)), buffers, PROBE_THREADS);
    };
    if (wantsStill()) {
        if (field_) {
            const SolidPasses::FieldView f = solids.stillField();
            dispatch(kernels.still, step, {f.block, f.distance, f.normal});
        } else {
            dispatch(kernels.still, step, {&solids.planes()});
        }
    }
    if (!movingToo) return;
    for (const SolidPasses::FieldView& f : solids.movingFields()) {
        if (!wants(f.on)) continue;
        StepParams s = step;
        s.force.y = static_cast<float>(f.on);
        s.force.z = static_cast<float>(f.index);
        const bool deforming = f.on == ProbeOn::deforming;
        dispatch(deforming ? kernels.deforming : kernels.rigid, s,
                 {f.block, f.distance, deforming && kernels.readsDisplacement ? f.displacement : nullptr});
    }
}

bool ProbePasses::wantsDistance() const { return walled_ && (wantsStill() || wants(ProbeOn::rigid) || wants(ProbeOn::deforming)); }

void ProbePasses::pressure(const StepParams& step, const Buffer& home, const Buffer& start, const Buffer& position,
                           const Buffer& multiplier, float scale) {
    if (!wantsDistance()) return;
    StepParams s = step;
    s.force = vec4(scale, 0.0F, 0.0F, 0.0F);
    const Particles& p = world_.particles;
    load_.run(*device_, p, s, {&world_.grid.neighbors(), &home, &position, &p.nearWalls, &carried_, &multiplier},
              world_.grid.pairThreads());
    carry(carryPressure_, step, carried_, {&p.nearWalls, &start}, false);
    atDistance(pressure_, step, position, true);
}

void ProbePasses::solved(const StepParams& step, const Buffer& solve) {
    if (!wantsDistance()) return;
    const Particles& p = world_.particles;
    StepParams s = step;
    s.force = vec4(step.mass, 0.0F, 0.0F, 0.0F);
    loadHeld_.run(*device_, p, s, {&world_.grid.neighbors(), &p.position, &p.position, &p.nearWalls, &carried_, &solve, &p.velocity},
                  world_.grid.pairThreads());
    carry(carryPressure_, step, carried_, {&p.nearWalls, &p.position}, false);
    atDistance(pressure_, step, p.position, true);
}

void ProbePasses::friction(const StepParams& step, const Buffer& friction, const Buffer& velocity) {
    if (!wantsDistance()) return;
    carry(carryFriction_, step, carried_, {&friction, &velocity}, true);
    atDistance(friction_, step, world_.particles.position, true);
}

void ProbePasses::adhesion(const StepParams& step) {
    if (!walled_ || !wantsStill()) return;
    carry(carryAdhesion_, step, carried_, {}, true);
    atDistance(adhesion_, step, world_.particles.position, false);
}

void ProbePasses::respond(const Kernel& kernel, const StepParams& step, const Buffer& position, const Buffer& velocity, const Buffer& last,
                          const Buffer* matter) {
    if (!walled_ || !wantsWalls()) return;
    std::vector<const Buffer*> buffers = {&world_.grid.cellStart(), &world_.solids.planes(), &probes_, &rows_, &position, &velocity, &last};
    if (world_.traits.matter) buffers.push_back(matter);
    device_->dispatch(kernel, std::as_bytes(std::span(&step, 1)), buffers, PROBE_THREADS);
}

void ProbePasses::response(const StepParams& step, const Buffer& position, const Buffer& velocity, const Buffer& acceleration,
                           float share) {
    StepParams s = step;
    s.force = vec4(share, 0.0F, 0.0F, 0.0F);
    respond(integrated_, s, position, velocity, acceleration, &world_.particles.matter);
}

void ProbePasses::responseFromPositions(const StepParams& step, const Buffer& start, const Buffer& corrected) {
    respond(finished_, step, start, corrected, world_.particles.acceleration, &world_.particles.matter);
}

void ProbePasses::predicted(const StepParams& step) {
    const Particles& p = world_.particles;
    respond(predicted_, step, p.positionNext, p.velocityNext, p.id, &p.matterOf);
}

void ProbePasses::arrived(const StepParams& step) {
    const Particles& p = world_.particles;
    respond(arrived_, step, p.positionNext, p.velocityNext, p.acceleration, &p.matter);
}

void ProbePasses::remember(ProbeOn on) {
    if (wants(on)) device_->copy(world_.particles.velocityNext, before_, before_.bytes());
}

void ProbePasses::contact(const StepParams& step, ProbeOn on, uint32_t index, const Buffer& distance, const Buffer& normal,
                          const Buffer& block) {
    if (!wants(on)) return;
    const Particles& p = world_.particles;
    StepParams s = step;
    s.force = vec4(0.0F, static_cast<float>(on), static_cast<float>(index), 0.0F);
    carry(carryContact_, step, before_, {&p.velocityNext}, true);
    std::vector<const Buffer*> buffers = {&world_.grid.cellStart(), &before_, &probes_, &rows_, &p.positionNext, &distance, &block};
    if (on == ProbeOn::still) buffers.push_back(&normal);
    device_->dispatch(on == ProbeOn::still ? contact_ : contactMoving_, std::as_bytes(std::span(&s, 1)), buffers, PROBE_THREADS);
}

void ProbePasses::bodies(const StepParams& step) {
    if (!wants(ProbeOn::body) || world_.bodies.sampleCount() == 0) return;  // 0: the water meets none
    const BodyPasses::Samples s = world_.bodies.samples();
    device_->run(body_, step, {s.slotOf, &world_.particles.acceleration, &probes_, &rows_, s.own, s.arm, s.bodies}, PROBE_THREADS);
}

}  // namespace rivulet
