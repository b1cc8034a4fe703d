#include "fluid/sim/solids/bodies.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "engine/core/assert.h"
#include "fluid/sim/methods/method.h"

namespace rivulet {

namespace {

// The smoothing kernels' shapes, as shaders/fluid/methods/shape.h has them.
double shapeOf(bool cubic, double q) {
    const double a = std::max(1.0 - q, 0.0);
    if (!cubic) return a * a * a * a * (4.0 * q + 1.0);
    const double b = std::max(0.5 - q, 0.0);
    return 2.0 * a * a * a - 8.0 * b * b * b;
}

// Sum over a lattice plane `z` spacings away, `x`, `y` off the lattice.
double planeSum(bool cubic, double support, double x, double y, double z) {
    const int n = static_cast<int>(std::ceil(support)) + 1;
    double sum = 0;
    for (int i = -n; i <= n; ++i)
        for (int k = -n; k <= n; ++k) sum += shapeOf(cubic, std::sqrt((i + x) * (i + x) + (k + y) * (k + y) + z * z) / support);
    return sum;
}

// Times the sum of the shape over a sample's own body: its volume over spacing^3 is `volumeTimesSum` over that.
double volumeTimesSum(bool cubic, double support) {
    const int n = static_cast<int>(std::ceil(support));
    double missing = 0;
    for (int z = 1; z <= n; ++z) missing += planeSum(cubic, support, 0, 0, z);
    // A fluid lies anyhow beside the samples: the mean over where.
    constexpr int kOffsets = 8;
    double met = 0;
    for (int i = 0; i < kOffsets; ++i)
        for (int k = 0; k < kOffsets; ++k) met += planeSum(cubic, support, double{1} * i / kOffsets, double{1} * k / kOffsets, 1.0);
    met /= kOffsets * kOffsets;
    // A lattice, as at a support of 2 spacings, keeps its distance from the samples. A fluid in disorder comes nearer. Measured at 2.3
    // spacings: with this factor, boxes 16 spacings high float to 0.3 spacings at the depth of Archimedes with dfsph and pbf.
    const double disorder = 1 + 0.35 * std::max(support - 2, 0.0);
    return missing / met * planeSum(cubic, support, 0, 0, 0) * disorder;
}

// The water that a body moves along, m^3: what it displaces, or the ball of water before a plate of its largest cross-section
// (8/3 r^3, Lamb 1932), whichever is more.
double movedAlong(const BodyShape& shape) {
    Bounds bounds;
    for (const vec3& p : shape.samples) bounds.add(p);
    if (bounds.empty()) return 0;
    const dvec3 size(bounds.size());
    const double area = std::max({size.x * size.y, size.y * size.z, size.x * size.z});
    return std::max(double{shape.volume}, 8.0 / 3.0 * std::pow(area / kPiD, 1.5));
}

}  // namespace

std::vector<float> sampleVolumes(std::span<const vec3> samples, const FluidParams& params) {
    const double h = double{params.supportSpacings} * params.spacing;
    const bool cubic = params.kernel == "cubic_spline";
    const double gamma = volumeTimesSum(cubic, params.supportSpacings);
    // Samples by cells of the size of the support radius.
    const auto cellOf = [&](const vec3& p) {
        const glm::i64vec3 c(glm::floor(dvec3(p) / h));
        return (c.x * 73856093) ^ (c.y * 19349663) ^ (c.z * 83492791);
    };
    std::unordered_map<int64_t, std::vector<uint32_t>> cells;
    for (uint32_t k = 0; k < samples.size(); ++k) cells[cellOf(samples[k])].push_back(k);
    std::vector<float> volumes;
    volumes.reserve(samples.size());
    for (const vec3& p : samples) {
        std::vector<int64_t> near;  // cells that share a number must not be looked at twice
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x)
                    near.push_back(
                        cellOf(p + static_cast<float>(h) * vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))));
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        double sum = 0;
        for (const int64_t cell : near)
            if (const auto found = cells.find(cell); found != cells.end())
                for (const uint32_t k : found->second) sum += shapeOf(cubic, glm::length(dvec3(samples[k]) - dvec3(p)) / h);
        volumes.push_back(static_cast<float>(gamma / sum));
    }
    return volumes;
}

FreeBodies::FreeBodies(std::span<const Body> bodies) {
    for (const Body& b : bodies) add(b);
}

void FreeBodies::add(const Body& body) { own_.push_back({double{body.shape.mass}, dvec3(body.shape.inertia)}); }

BodyHost FreeBodies::host() {
    BodyHost h;
    h.self = this;
    h.remembersNothing = true;
    h.reset = [](void*, std::span<const BodyState>) {};
    h.contacts = [](void*, std::span<const BodyState>, std::span<const vec4>, double, std::vector<BodyContact>&) { return true; };
    h.passed = [](void*, double) {};
    h.added = [](void* self, uint32_t, const Body& body) { static_cast<FreeBodies*>(self)->add(body); };
    h.removed = [](void* self, uint32_t, size_t index) {
        std::vector<Own>& own = static_cast<FreeBodies*>(self)->own_;
        own.erase(own.begin() + static_cast<std::ptrdiff_t>(index));
    };
    h.advance = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
        const std::vector<Own>& own = static_cast<FreeBodies*>(self)->own_;
        ASSERT(loads.size() == own.size() && states.size() == own.size(), "one load and one state a body");
        for (size_t k = 0; k < own.size(); ++k) {
            if (!(own[k].mass > 0)) continue;
            BodyState& s = states[k];
            const dvec3 v = dvec3(s.velocity) + (loads[k].force / own[k].mass + dvec3(gravity)) * seconds;
            dquat q(s.pose.rotation);
            const dvec3& inertia = own[k].inertia;
            const auto times = [&](const dvec3& by, const dvec3& w) {
                const dmat3 r = glm::mat3_cast(q);
                return r * (by * (glm::transpose(r) * w));
            };
            // Angular momentum is what stays; the spin follows from it where the body has turned to.
            const dvec3 momentum = times(inertia, dvec3(s.spin)) + loads[k].torque * seconds;
            const dvec3 spin = times(1.0 / inertia, momentum);
            const double rate = glm::length(spin);
            if (rate > 0) q = glm::normalize(glm::angleAxis(rate * seconds, spin / rate) * q);
            s.spin = vec3(times(1.0 / inertia, momentum));
            s.velocity = vec3(v);
            s.pose.position = vec3(dvec3(s.pose.position) + v * seconds);
            s.pose.rotation = quat(q);
        }
    };
    return h;
}

BodyLoads::BodyLoads(std::span<const Body> bodies, const FluidParams& params) {
    for (const Body& b : bodies) add(b, params);
}

void BodyLoads::add(const Body& body, const FluidParams& params) {
    const double particle = std::pow(double{params.spacing}, 3), mass = body.shape.mass, density = params.restDensity;
    const double layer = density * particle * static_cast<double>(body.shape.samples.size());
    const double with = methodOf(params).hasSound ? std::max(layer - mass, 0.0) : density * movedAlong(body.shape);
    own_.push_back({mass > 0 ? with / mass : 0.0, {}});
}

void BodyLoads::remove(size_t body) { own_.erase(own_.begin() + static_cast<std::ptrdiff_t>(body)); }

BodyLoad BodyLoads::transfer(size_t body, const dvec3& force, const dvec3& torque, double wet, double seconds) {
    Own& own = own_[body];
    BodyLoad& l = own.last;
    const double share = 1.0 / (1.0 + own.added * wet);
    const dvec3 impulse = force * seconds + l.pendingImpulse, turn = torque * seconds + l.pendingAngularImpulse;
    l = {impulse * (share / seconds), turn * (share / seconds), impulse * (1 - share), turn * (1 - share)};
    return l;
}

void BodyLoads::restore(std::span<const BodyLoad> last) {
    for (size_t k = 0; k < own_.size(); ++k) own_[k].last = last[k];
}

void BodyLoads::reset() {
    for (Own& own : own_) own.last = {};
}

}  // namespace rivulet
