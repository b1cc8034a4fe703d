#include "fluid/flow/placed_flow.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shaders/flow/flow_step.h"

namespace rivulet {

void addPendant(const HungDrop& d, const vec3& absorption, std::vector<vec4>& rows) {
    double widest = 0;
    for (int k = 0; k <= 20; ++k) widest = std::max(widest, d.profile.square(0.05 * k));
    rows.emplace_back(vec3(d.foot), static_cast<float>(d.profile.length));
    rows.emplace_back(vec3(d.axis), static_cast<float>(d.opacity));
    rows.emplace_back(d.profile.swell);
    rows.emplace_back(vec3(d.lean), static_cast<float>(std::sqrt(widest)));
    rows.emplace_back(absorption, 0.0F);
}

double radiusOf(const AirDrop& d) {
    constexpr double kPicolitre = 1.0e-15;  // m^3
    return std::cbrt(3 * d.picolitres * kPicolitre / (4 * std::numbers::pi));
}

PlacedFlow::PlacedFlow(SurfaceFlow& flow, Motion motion) : flow_(&flow), motion_(std::move(motion)), search_(flow.mesh()) { moveTo(0); }

void PlacedFlow::moveTo(double time) {
    time_ = time;
    toWorld_ = motion_(time);
}

void PlacedFlow::restore(double time, const dmat4& toWorld) {
    time_ = time;
    toWorld_ = toWorld;
    seen_ = UINT64_MAX;
}

void PlacedFlow::look() {
    const SurfaceFlow::Shape shape = flow_->shape();
    if (seen_ == shape.number && seenFrom_ == shape.from) return;
    seen_ = shape.number;
    seenFrom_ = shape.from;
    search_.follow(shape.places);
}

std::optional<SkinSearch::Hit> PlacedFlow::meets(const dvec3& from, const dvec3& to, double then) {
    look();
    const dmat4 now = glm::inverse(toWorld_), later = then == time_ ? now : glm::inverse(motion_(then));
    return search_.first(vec3(now * dvec4(from, 1)), vec3(later * dvec4(to, 1)));
}

SkinPoint PlacedFlow::nearest(const vec3& x) {
    look();
    return nearestPoint(flow_->mesh(), search_.places(), x);
}

void PlacedFlow::land(const SkinSearch::Hit& where, const AirDrop& drop) {
    // The drop keeps its velocity along the skin, relative to the skin's rigid motion, limited to the speed of a drop that runs by itself.
    constexpr double kMoment = 1.0e-4;  // s
    const dvec4 at(dvec3(where.position), 1);
    const dvec3 carried = dvec3(motion_(time_ + kMoment) * at - motion_(time_) * at) / kMoment;
    vec3 v = vec3(glm::transpose(dmat3(toWorld_)) * (drop.velocity - carried));
    v -= where.normal * glm::dot(v, where.normal);
    constexpr float kMost = 0.2F;  // m/s
    if (const float speed = glm::length(v); speed > kMost) v *= kMost / speed;
    flow_->add(where.at, drop.picolitres, v);
}

HungDrop PlacedFlow::hung(const HangingDrop& drop) const {
    constexpr double kMostLean = 1.2, kPicolitre = 1.0e-15;
    const SurfaceFlowParams& p = flow_->params();
    const dmat3 turn(toWorld_);
    const dvec3 up = glm::normalize(dvec3(drop.up)), pull(drop.pull);
    const double away = std::max(glm::dot(pull, up), 1.0e-3);
    const double l = std::sqrt(double{p.surfaceTension} / (double{p.density} * away));
    const double curvature = std::max(double{drop.curvature}, 0.0);
    HungDrop made;
    made.profile = flow_->pendant()->profile(curvature * l, drop.picolitres * kPicolitre / (l * l * l));
    made.profile.length *= l;
    made.profile.swell *= l * l;
    dvec3 lean = pull / away - up;
    if (const double much = glm::length(lean); much > kMostLean) lean *= kMostLean / much;
    // The skin, a ball, comes through the plane of the foot by this much.
    const double bent = std::min(curvature * std::sqrt(made.profile.square(0)), 1.0);
    const double through = curvature > 0 ? (1 - std::sqrt(1 - bent * bent)) / curvature : 0.0;
    made.foot = dvec3(toWorld_ * dvec4(dvec3(drop.position) - through * up, 1));
    made.axis = turn * up;
    made.lean = turn * lean;
    made.opacity = std::clamp(double{(drop.share - HANGS_FROM) / (HANGS_FULLY - HANGS_FROM)}, 0.0, 1.0);
    return made;
}

std::vector<HungDrop> PlacedFlow::hanging() const {
    std::vector<HungDrop> all;
    for (const HangingDrop& drop : flow_->hanging()) all.push_back(hung(drop));
    return all;
}

Bounds PlacedFlow::bounds() const {
    Bounds own, all;
    for (const vec3& p : search_.places()) own.add(p);
    if (own.empty()) return all;
    const mat4 m(toWorld_);
    for (int k = 0; k < 8; ++k) {
        const vec3 corner((k & 1) != 0 ? own.max.x : own.min.x, (k & 2) != 0 ? own.max.y : own.min.y, (k & 4) != 0 ? own.max.z : own.min.z);
        all.add(vec3(m * vec4(corner, 1.0F)));
    }
    return all;
}

FirstMet firstMet(std::span<PlacedFlow* const> skins, const dvec3& from, const dvec3& to, double then) {
    FirstMet first{.skin = skins.size(), .where = {}};
    for (size_t k = 0; k < skins.size(); ++k)
        if (const std::optional<SkinSearch::Hit> hit = skins[k]->meets(from, to, then);
            hit && (first.skin == skins.size() || hit->share < first.where.share))
            first = {k, *hit};
    return first;
}

}  // namespace rivulet
