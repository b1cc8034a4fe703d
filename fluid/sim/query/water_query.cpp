#include "fluid/sim/query/water_query.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/surface/iso_surface.h"
#include "shaders/fluid/query/query_params.h"

namespace rivulet {

namespace {

// The part of a ray that lies in the grid.
struct Inside {
    vec3 from{0.0F}, way{0.0F};  // m; unit
    double begin = 0;            // m, of the ray, where it is at `from`
    float length = -1;           // m; negative: none
    uint32_t edges = 0;          // RAY_*
};

Inside clip(const FluidRay& ray, const dvec3& low, const dvec3& high) {
    Inside in;
    const dvec3 origin(ray.origin);
    const dvec3 steps = glm::abs(dvec3(ray.direction));
    const double largest = std::max({steps.x, steps.y, steps.z});
    if (!isFinite(ray.origin) || !isFinite(ray.direction) || !(largest > 0) || !(ray.reach >= 0)) return in;
    const dvec3 way = glm::normalize(dvec3(ray.direction) / largest);
    double begin = 0, end = double{ray.reach};
    for (int k = 0; k < 3; ++k) {
        if (way[k] == 0) {
            if (!(origin[k] >= low[k] && origin[k] <= high[k])) return in;
            continue;
        }
        const double a = (low[k] - origin[k]) / way[k], b = (high[k] - origin[k]) / way[k];
        if (std::min(a, b) > begin) {
            begin = std::min(a, b);
            in.edges |= RAY_ENTERS;
        }
        if (std::max(a, b) < end) {
            end = std::max(a, b);
            in.edges |= RAY_LEAVES;
        }
    }
    if (!(begin <= end)) return in;
    in.from = vec3(origin + way * begin);
    in.way = vec3(way);
    in.begin = begin;
    in.length = static_cast<float>(end - begin);
    return in;
}

std::vector<FluidSample> samplesOf(const vec4* answers, size_t count) {
    std::vector<FluidSample> samples(count);
    for (size_t k = 0; k < count; ++k) samples[k] = {answers[2 * k].w, vec3(answers[2 * k]), vec3(answers[2 * k + 1])};
    return samples;
}

std::vector<vec4> placesOf(std::span<const vec3> places) {
    std::vector<vec4> asked;
    asked.reserve(places.size());
    for (const vec3& p : places) asked.emplace_back(p, 0.0F);
    return asked;
}

}  // namespace

Result<WaterQuery> WaterQuery::create(Device& device, const FluidParams& params, const PairTraits& traits) {
    WaterQuery q;
    q.device_ = &device;
    // Wendland's kernel at distance 0, on a lattice that is at rest density 1.
    const double support = double{params.supportSpacings};
    q.weight_ = static_cast<float>(21.0 / (2.0 * std::numbers::pi * support * support * support) / wendlandLatticeSum(support));
    std::vector<Define> defines;
    if (traits.linked) defines.push_back({"LINKED_LIST", "1"});
    for (auto [kernel, path] : {std::pair(&q.sample_, "fluid/query/sample_water"), std::pair(&q.cast_, "fluid/query/cast_rays")}) {
        Result<Kernel> found = device.kernel(path, defines);
        if (!found) return found.error();
        *kernel = *found;
    }
    return q;
}

// Two answers each.
Status WaterQuery::ask(Kernel kernel, const Water& water, std::span<const vec4> asked, uint32_t count) {
    for (auto [buffer, bytes] : {std::pair(&asked_, asked.size_bytes()), std::pair(&answers_, 2 * size_t{count} * sizeof(vec4))}) {
        if (buffer->bytes() >= bytes) continue;
        Result<Buffer> more = device_->allocate(2 * bytes);
        if (!more) return more.error();
        *buffer = std::move(*more);
    }
    device_->writeAll<vec4>(asked_, asked);
    QueryParams block{};
    block.step = water.step;
    block.count = count;
    block.weight = weight_;
    block.level = static_cast<float>(IsoSurface::kLevel);
    block.stride = 0.5F * water.step.spacing;
    device_->run(kernel, block, {&water.grid.cellStart(), &water.position, &water.velocity, &asked_, &answers_}, count);
    return ok();
}

Result<std::vector<FluidSample>> WaterQuery::sample(const Water& water, std::span<const vec3> places) {
    if (places.empty()) return std::vector<FluidSample>();
    if (Status s = ask(sample_, water, placesOf(places), static_cast<uint32_t>(places.size())); !s) return s.error();
    return samplesOf(device_->readAll<vec4>(answers_, 2 * places.size()).data(), places.size());
}

Status WaterQuery::sampleLater(const Water& water, std::span<const vec3> places, std::function<void(std::span<const FluidSample>)> then) {
    const size_t count = places.size();
    if (count > 0)
        if (Status s = ask(sample_, water, placesOf(places), static_cast<uint32_t>(count)); !s) return s;
    device_->readLater(answers_, 2 * count * sizeof(vec4), [count, then = std::move(then)](std::span<const std::byte> bytes) {
        then(samplesOf(reinterpret_cast<const vec4*>(bytes.data()), count));
    });
    return ok();
}

Result<std::vector<FluidHit>> WaterQuery::cast(const Water& water, std::span<const FluidRay> rays) {
    if (rays.empty()) return std::vector<FluidHit>();
    const StepParams& s = water.step;
    const dvec3 edge = 1.0 / dvec3(vec3(s.gridScale)), cells(s.cellsX, s.cellsY, s.cellsZ);
    // A hair inside, so that the rounded ends are in the grid, too.
    constexpr double kHair = 1.0e-3;
    const dvec3 low = dvec3(vec3(s.gridOrigin)) + (1.0 + kHair) * edge, high = dvec3(vec3(s.gridOrigin)) + (cells - 1.0 - kHair) * edge;
    std::vector<Inside> parts;
    std::vector<vec4> asked;
    parts.reserve(rays.size());
    asked.reserve(2 * rays.size());
    for (const FluidRay& ray : rays) {
        const Inside& in = parts.emplace_back(clip(ray, low, high));
        asked.emplace_back(in.from, static_cast<float>(in.edges));
        asked.emplace_back(in.way, in.length);
    }
    if (Status done = ask(cast_, water, asked, static_cast<uint32_t>(rays.size())); !done) return done.error();
    const std::vector<vec4> answers = device_->readAll<vec4>(answers_, 2 * rays.size());
    std::vector<FluidHit> hits(rays.size());
    for (size_t k = 0; k < rays.size(); ++k) {
        const vec4 &at = answers[2 * k], &steep = answers[2 * k + 1];
        FluidHit& hit = hits[k];
        hit.inside = steep.w != 0;
        if (at.w < 0) continue;
        hit.hit = true;
        hit.distance = static_cast<float>(parts[k].begin + double{at.w});
        hit.place = parts[k].from + parts[k].way * at.w;
        hit.velocity = vec3(at);
        const float length = glm::length(vec3(steep));
        // A surface that stands nowhere up faces whence the ray came.
        hit.normal = length > 0 ? -vec3(steep) / length : hit.inside ? parts[k].way : -parts[k].way;
    }
    return hits;
}

}  // namespace rivulet
