#include "fluid/flow/thesis_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/param_fixed.h"

namespace rivulet {

namespace {

constexpr int kMostParts = 16;    // of a step
constexpr float kFarUv = 1.0e4F;  // limit of a usable UV

bool somewhere(const vec2& uv) { return std::abs(uv.x) < kFarUv && std::abs(uv.y) < kFarUv; }

}  // namespace

void ThesisParams::visit(ParamVisitor& v) {
    v.value({"reach", "UV", "support radius of the sums over neighbours", 1.0e-3, 1, kLog, kFixed}, reach);
    v.value({"restDensity", "kg/UV^2", "density at which the pressure is 0", 1.0e-6, 100, kLog}, restDensity);
    v.value({"stiffness", "UV^2/s^2", "k of the pressure k (density - rest density)", 0, 10}, stiffness);
    v.value({"viscosity", "UV^2/s", "viscosity between particles", 0, 0.1}, viscosity);
    v.value({"friction", "", "mu of the friction with the skin; friction grows with the normal force on a particle", 0, 100}, friction);
    v.value({"adhesive", "N", "force that holds a particle on the skin", 0, 1, kLog}, adhesive);
    v.value({"curvature", "N kg/UV^3", "surface tension that holds a particle on the skin, times the density's gradient", 0, 1, kLog},
            curvature);
    v.value({"curvatureMost", "N", "limit on the force of surface tension, which would be infinite for a single particle", 0, 1, kLog},
            curvatureMost);
    v.value({"windPush", "1/s", "acceleration per m/s of wind", 0, 100}, windPush);
    v.value({"disc", "UV", "drawn radius of the largest particle", 1.0e-4, 0.5, kLog}, disc);
}

std::vector<uint32_t> acrossInUv(const FlowMesh& mesh, std::span<const vec2> uvs) {
    std::vector<uint32_t> across = mesh.across;
    for (size_t k = 0; k < across.size(); ++k) {
        if (across[k] == FlowMesh::kOpen) continue;
        const size_t t = k / 3, other = across[k] / 4, edge = across[k] % 4;
        // The edge runs the other way on the other side.
        const bool same = uvs[k] == uvs[3 * other + (edge + 1) % 3] && uvs[3 * t + (k + 1) % 3] == uvs[3 * other + edge];
        if (!same) across[k] = FlowMesh::kOpen;
    }
    return across;
}

vec2 uvAt(std::span<const vec2> uvs, const SkinPoint& at) {
    const vec2* c = &uvs[3 * size_t{at.triangle}];
    return (1 - at.b1 - at.b2) * c[0] + at.b1 * c[1] + at.b2 * c[2];
}

// V = pi h^3 (2 + cos) / (3 (1 - cos)).
double capHeight(double volume, double degrees) {
    const double c = std::cos(degrees * kPiD / 180);
    return std::cbrt(3 * volume * (1 - c) / (kPiD * (2 + c)));
}

Result<ThesisTables> ThesisTables::create(Device& device, const FlowMesh& mesh, std::span<const vec2> given, const ThesisParams& params) {
    if (given.size() != mesh.corner.size())
        return badInput(fmt::format("thesis mode has {} UVs for {} corners: give one for each corner of each triangle", given.size(),
                                    mesh.corner.size()));
    ThesisTables w;
    w.device_ = &device;
    w.params_ = params;
    w.triangles_ = static_cast<uint32_t>(mesh.triangleCount());
    std::vector<vec2> uvs(given.begin(), given.end());
    double area = 0;
    for (size_t t = 0; t < w.triangles_; ++t) {
        vec2* c = &uvs[3 * t];
        if (!somewhere(c[0]) || !somewhere(c[1]) || !somewhere(c[2])) c[0] = c[1] = c[2] = vec2(0.0F);
        const vec2 a = c[1] - c[0], b = c[2] - c[0];
        area += std::abs(double{a.x} * double{b.y} - double{a.y} * double{b.x});
        for (size_t k = 0; k < 3; ++k) w.uvs_.add(vec3(c[k], 0.0F));
    }
    if (!(area > 0)) return badInput("no triangle of the skin has an area in UV, which thesis mode flows in: give it UVs, or mode drops");

    struct Wanted {
        Kernel* kernel;
        const char* path;
    };
    Kernel basis;
    for (const Wanted& k :
         {Wanted{&basis, "flow/basis"}, Wanted{&w.frame_, "flow/thesis_frame"}, Wanted{&w.field_, "flow/thesis_field"},
          Wanted{&w.place_, "flow/thesis_place"}, Wanted{&w.law_, "flow/thesis_law"}, Wanted{&w.leave_, "flow/thesis_leave"}}) {
        Result<Kernel> found = device.kernel(k.path);
        if (!found) return found.error();
        *k.kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&w.density_, "flow/thesis_density"), std::pair(&w.press_, "flow/thesis_press")}) {
        Result<PairKernel> found = PairKernel::find(device, path, {});
        if (!found) return found.error();
        *kernel = *found;
    }
    Buffer point;
    for (auto [buffer, bytes] :
         {std::pair(&w.skin_, size_t{SKIN_UINTS} * w.triangles_ * sizeof(uint32_t)), std::pair(&point, uvs.size() * sizeof(vec4)),
          std::pair(&w.flat_, size_t{5} * w.triangles_ * sizeof(vec4)), std::pair(&w.inverse_, size_t{3} * w.triangles_ * sizeof(vec4)),
          std::pair(&w.force_, w.triangles_ * sizeof(vec4))}) {
        Result<Buffer> room = device.allocate(bytes);
        if (!room) return room.error();
        *buffer = std::move(*room);
    }
    const std::vector<uint32_t> across = acrossInUv(mesh, uvs);
    std::vector<uint32_t> table;
    std::vector<vec4> places;
    table.reserve(size_t{SKIN_UINTS} * w.triangles_);
    for (uint32_t k = 0; k < 3 * w.triangles_; k += 3) {
        table.insert(table.end(), {k, k + 1, k + 2, across[k], across[k + 1], across[k + 2], 0, 1});
        for (size_t c = 0; c < 3; ++c) places.emplace_back(uvs[k + c], 0.0F, 0.0F);
    }
    device.writeAll<uint32_t>(w.skin_, table);
    device.writeAll<vec4>(point, places);
    FlowStep f{};
    f.triangles = w.triangles_;
    device.run(basis, f, {&w.skin_, &point, &w.flat_}, w.triangles_);
    device.finish();
    return w;
}

void ThesisTables::setParams(const ThesisParams& params) {
    ThesisParams next = params;
    keepFixed(next, params_);
    params_ = next;
}

Bounds ThesisTables::around() const {
    Bounds b = uvs_;
    b.add(uvs_.min - vec3(cell()));
    b.add(uvs_.max + vec3(cell()));
    return b;
}

// As wide as the kernels' support; wider if there would be too many cells.
float ThesisTables::cell() const {
    constexpr double kCells = 1 << 15;
    const dvec3 all(uvs_.size());
    return static_cast<float>(std::max({double{params_.reach}, std::sqrt(all.x * all.y / kCells), std::max(all.x, all.y) / kCells}));
}

ThesisStep ThesisTables::stepOf(const FlowStep& f) const {
    ThesisStep t{};
    t.pull = f.pull + params_.windPush * f.wind;
    t.count = f.count;
    t.triangles = f.triangles;
    t.dt = f.dt;
    t.density = f.density;
    t.contactRadius = f.contactRadius;
    t.friction = params_.friction;
    t.adhesive = params_.adhesive;
    t.curvature = params_.curvature;
    t.curvatureMost = params_.curvatureMost;
    return t;
}

void ThesisTables::makeField(const Of& of, const FlowStep& f, bool bent) {
    const ThesisStep t = stepOf(f);
    if (bent) device_->run(frame_, t, {&of.skin, &of.basis, &flat_, &of.drive, &inverse_}, triangles_);
    device_->run(field_, t, {&inverse_, &force_}, triangles_);
}

int ThesisTables::parts(double seconds) const {
    const double h = params_.reach, sound = std::sqrt(double{params_.stiffness});
    const double longest = std::min(0.25 * h / std::max(sound, 1.0e-9), 0.02 * h * h / std::max(double{params_.viscosity}, 1.0e-12));
    return static_cast<int>(std::clamp(std::ceil(seconds / longest), 1.0, double{kMostParts}));
}

Status ThesisTables::press(const Of& of, const FlowStep& f, StepParams s) {
    const ThesisStep t = stepOf(f);
    Particles& p = of.particles;
    device_->run(place_, t, {&p.id, &flat_, &inverse_, &of.drop, &of.motion, &p.positionNext, &p.velocityNext}, f.count);
    if (Status sorted = of.grid.build(s, p); !sorted) return sorted;
    // Stiffness and viscosity are limited to values that the parts of a step resolve stably.
    const double dt = s.dt, h = params_.reach;
    s.stiffness = static_cast<float>(std::min(double{params_.stiffness}, std::pow(0.25 * h / dt, 2)));
    s.force =
        vec4(f.density, params_.restDensity, 1 / params_.reach, static_cast<float>(std::min(double{params_.viscosity}, 0.02 * h * h / dt)));
    const Buffer& neighbors = of.grid.neighbors();
    density_.run(*device_, p, s, {&neighbors, &p.position, &p.velocity, &of.merged}, of.grid.pairThreads());
    press_.run(*device_, p, s, {&neighbors, &p.position, &p.velocity, &of.merged}, of.grid.pairThreads());
    device_->run(law_, t, {&p.id, &force_, &of.merged, &of.drop, &of.motion}, f.count);
    return ok();
}

void ThesisTables::releaseDrops(const Of& of, const FlowStep& f) {
    device_->run(leave_, stepOf(f), {&of.particles.id, &of.basis, &flat_, &of.drop, &of.motion}, f.count);
}

}  // namespace rivulet
