// Where and when the sources of a skin let drops out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fluid/scene/flow_component.h"

namespace rivulet {

namespace {

constexpr size_t kMostEmitted = 4096;  // drops of one source in one step

// Returns two directions perpendicular to the unit vector `n`.
std::pair<vec3, vec3> across(const vec3& n) {
    const vec3 a = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0)));
    return {a, glm::cross(n, a)};
}

}  // namespace

// The eyes of a source: those of its side with the marks that its kind needs.
std::vector<size_t> FlowComponent::eyesOf(const FlowSourceParams& source) const {
    std::vector<size_t> eyes;
    for (const size_t side : {size_t{0}, size_t{1}}) {
        if (source.side == (side == 0 ? "right" : "left")) continue;
        const bool inBrim = source.kind == "brim" && !thesis();  // the thesis has no lids
        if (inBrim ? marks_.eyes[side].lowerLid.size() >= 2 : marks_.eyes[side].tear.has_value()) eyes.push_back(side);
    }
    return eyes;
}

// "", or why the source cannot emit.
std::string FlowComponent::faultOf(const FlowSourceParams& source) const {
    if (source.kind != "corner" && source.kind != "brim") return {};
    if (eyesOf(source).empty())
        return fmt::format(
            "{} has no marks of {}: a source of kind {} needs marks; use spot, strewn or rain, or give `marks` (`rivulet flow-check {}`)",
            params_.mesh, source.side == "both" ? "eyes" : fmt::format("the {} eye", source.side), source.kind, params_.mesh);
    constexpr float kMostOfAnEye = 1.0e5F;  // microlitres a minute
    if (source.rate * params_.amount > kMostOfAnEye)
        return fmt::format(
            "a source of kind {} lets {:.3g} ul a minute out, and an eye no more than {:.0f}: lower its rate, or use spot or rain",
            source.kind, source.rate * params_.amount, kMostOfAnEye);
    return {};
}

SkinPoint FlowComponent::somewhere(const FlowSourceParams& source, Source& state) {
    const FlowMesh& mesh = flow_->mesh();
    std::uniform_real_distribution<float> any(0.0F, 1.0F);
    SkinPoint at;
    for (int tries = 0; tries < 200; ++tries) {
        const double wanted = double{any(state.random)} * areaTo_.back();
        at.triangle = static_cast<uint32_t>(std::lower_bound(areaTo_.begin(), areaTo_.end(), wanted) - areaTo_.begin());
        at.triangle = std::min(at.triangle, static_cast<uint32_t>(mesh.triangleCount() - 1));
        const float r = std::sqrt(any(state.random)), s = any(state.random);
        at.b1 = r * (1 - s);
        at.b2 = r * s;
        if (source.radius == 0 || glm::distance(positionOf(mesh, at), source.position) < source.radius) return at;
    }
    return nearestPoint(mesh, source.position);
}

void FlowComponent::emitOne(const FlowSourceParams& source, Source& state, uint32_t picolitres, std::vector<AirDrop>& air) {
    std::uniform_real_distribution<float> any(-1.0F, 1.0F);
    const auto disc = [&] {
        for (;;) {
            const vec2 p(any(state.random), any(state.random));
            if (glm::dot(p, p) <= 1) return p * source.radius;
        }
    };
    emitted_ += picolitres;
    if (source.kind == "strewn") {
        flow_->add(somewhere(source, state), picolitres, vec3(0.0F), source.film);
    } else if (source.kind == "spot") {
        flow_->add(besideSpot(source, state, disc()), picolitres, vec3(0.0F), source.film);
    } else if (source.kind == "rain") {
        if (around_.empty()) around_ = bounds();
        const vec3 way = glm::length(source.along) > 0 ? glm::normalize(source.along) : vec3(0, -1, 0);
        const auto [a, b] = across(way);
        const float reach = 0.5F * glm::length(around_.size());
        const vec3 middle = source.radius > 0 ? vec3(placed_->toWorld() * glm::dvec4(dvec3(source.position), 1)) : around_.centre();
        const vec2 off = source.radius > 0 ? disc() : vec2(any(state.random), any(state.random)) * reach;
        air.push_back({dvec3(middle + a * off.x + b * off.y - way * (reach * (1.2F + 0.2F * any(state.random)))), dvec3(way * source.speed),
                       picolitres});
    } else {
        const std::vector<size_t> eyes = eyesOf(source);
        const size_t side = eyes[state.random() % eyes.size()];
        if (movedEye(source) == side && !thesis()) {
            // A brim spills a tear at a time.
            emitted_ -= picolitres;
            state.gathered += picolitres;
            const double tear = source.kind == "brim" ? double{params_.liquid.tear} * kMicrolitre : 0;
            if (static_cast<double>(state.gathered) < tear) return;
            const auto whole = static_cast<uint32_t>(std::exchange(state.gathered, 0));
            emitted_ += whole;
            flow_->add(besideSpot(source, state, vec2(0.0F)), whole);
        } else if (source.kind == "corner" || thesis()) {
            flow_->add(tears_[side], picolitres);
        } else {
            const uint32_t from = brimBegin_[side], count = brimBegin_[side + 1] - from;
            flow_->addToBrim(from + static_cast<uint32_t>(state.random() % count), picolitres);
        }
    }
}

// Returns a point of the disc around a spot, `off` (m) from its centre in the tangent plane. All triangles are searched only if the spot
// has moved or the skin is strongly curved under the disc.
SkinPoint FlowComponent::besideSpot(const FlowSourceParams& source, Source& state, const vec2& off) {
    const FlowMesh& mesh = flow_->mesh();
    if (!state.spot || state.spotOf != source.position) {
        state.spot = nearestPoint(mesh, source.position);
        state.spotOf = source.position;
    }
    if (source.radius == 0) return *state.spot;
    const uint32_t* c = &mesh.corner[3 * size_t{state.spot->triangle}];
    const std::vector<vec3>& x = placed_->search().places();
    const vec3 n = glm::normalize(glm::cross(x[c[1]] - x[c[0]], x[c[2]] - x[c[0]]));
    if (!isFinite(n)) return *state.spot;
    const auto [a, b] = across(n);
    const vec3 at =
        (1 - state.spot->b1 - state.spot->b2) * x[c[0]] + state.spot->b1 * x[c[1]] + state.spot->b2 * x[c[2]] + a * off.x + b * off.y;
    const std::optional<SkinSearch::Hit> hit = placed_->search().first(at + n * source.radius, at - n * source.radius);
    return hit ? hit->at : nearestPoint(mesh, at);
}

// The eye nearest to the source's position, if that is set: its tears start there and not at the lid.
std::optional<size_t> FlowComponent::movedEye(const FlowSourceParams& source) const {
    if (source.position == vec3(0.0F) || (source.kind != "corner" && source.kind != "brim")) return std::nullopt;
    std::optional<size_t> nearest;
    float least = 0;
    for (const size_t side : eyesOf(source)) {
        const float d = glm::distance(positionOf(flow_->mesh(), tears_[side]), source.position);
        if (nearest && d >= least) continue;
        nearest = side;
        least = d;
    }
    return nearest;
}

std::vector<FlowComponent::TearPoint> FlowComponent::tearPoints() const {
    std::vector<TearPoint> points;
    const FlowMesh& mesh = flow_->mesh();
    const std::vector<vec3>& x = placed_->search().places();
    const auto add = [&](size_t source, const SkinPoint& at) {
        const uint32_t* c = &mesh.corner[3 * size_t{at.triangle}];
        const vec3 own = (1 - at.b1 - at.b2) * x[c[0]] + at.b1 * x[c[1]] + at.b2 * x[c[2]];
        points.push_back({source, vec3(placed_->toWorld() * glm::dvec4(dvec3(own), 1))});
    };
    for (size_t k = 0; k < params_.sources.size(); ++k) {
        const FlowSourceParams& source = params_.sources[k];
        if (!(source.rate > 0)) continue;
        if (source.kind == "spot") add(k, nearestPoint(mesh, source.position));
        if (source.kind != "corner" && source.kind != "brim") continue;
        const std::optional<size_t> moved = movedEye(source);
        for (const size_t side : eyesOf(source))
            if (marks_.eyes[side].tear) add(k, moved == side ? nearestPoint(mesh, source.position) : tears_[side]);
    }
    return points;
}

std::optional<vec3> FlowComponent::placeMet(const dvec3& from, const dvec3& to) {
    const std::optional<SkinSearch::Hit> hit = placed_->meets(from, to, placed_->time());
    if (!hit) return std::nullopt;
    return positionOf(flow_->mesh(), hit->at);
}

void FlowComponent::emit(double time, double seconds, std::vector<AirDrop>& air) {
    for (size_t k = 0; k < params_.sources.size(); ++k) {
        const FlowSourceParams& source = params_.sources[k];
        Source& state = sources_[k];
        if (!(source.rate * params_.amount > 0) || time < double{source.start} || time >= double{source.stop}) {
            state.begun = false;
            continue;
        }
        if (const std::string fault = faultOf(source); !fault.empty()) {
            noticeOnce(fault);
            continue;
        }
        const double wave = 1 + double{source.swell} * std::sin(2 * std::numbers::pi * time / double{source.period});
        state.due += double{params_.amount} * double{source.rate} * kMicrolitre / 60 * seconds * wave;
        const auto each = static_cast<uint32_t>(std::max(double{source.drop} * kMicrolitre, 1.0));
        // The first drop appears at once.
        if (!std::exchange(state.begun, true)) state.due = std::max(state.due, static_cast<double>(each));
        size_t emitted = 0;
        for (; state.due >= each && emitted < kMostEmitted; ++emitted, state.due -= each) emitOne(source, state, each, air);
        if (emitted == kMostEmitted) {
            state.due = 0;
            noticeOnce(fmt::format(
                "flow.sources[{}] would let more than {} drops out at once: the others are not let out; make its drops larger, or "
                "its rate smaller",
                k, kMostEmitted));
        }
    }
}

}  // namespace rivulet
