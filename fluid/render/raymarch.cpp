#include "fluid/render/raymarch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>

#include "engine/core/parallel.h"

namespace rivulet {

namespace {

constexpr int kTile = 16;          // pixels
constexpr int kBlock = 8;          // cells: the larger of two sizes of emptiness
constexpr double kNearest = 1e-4;  // spacings, of a hit
constexpr double kPeak = 0.2;      // a peak of less between two steps does not reach the surface

struct Ray {
    dvec3 from{0.0}, along{0.0};  // world; `along` for a metre of depth
    double length = 1;            // of `along`
    dvec3 at(double t) const { return from + t * along; }
};

// Depths between which a ray is in a box; enter > leave: it misses.
struct Span {
    double enter, leave;
    int axis = -1;  // of the face it enters by
};
Span through(const Ray& ray, const dvec3& low, const dvec3& high) {
    Span span{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (int k = 0; k < 3; ++k) {
        if (ray.along[k] == 0) {
            if (ray.from[k] < low[k] || ray.from[k] > high[k]) return {1, 0};
            continue;
        }
        const double a = (low[k] - ray.from[k]) / ray.along[k], b = (high[k] - ray.from[k]) / ray.along[k];
        if (std::min(a, b) > span.enter) {
            span.enter = std::min(a, b);
            span.axis = k;
        }
        span.leave = std::min(span.leave, std::max(a, b));
    }
    return span;
}

struct Hit {
    double depth = double{kNoDepth};
    dvec3 normal{0.0};  // world
    double water = 0;   // m
};

class Marcher {
  public:
    explicit Marcher(const IsoSurface& surface) : surface_(surface), edge_(surface.cells().edge()) {
        const std::vector<ivec3>& cells = surface.cells().cells();
        blocks_.build(static_cast<uint32_t>(cells.size()), kBlock * edge_,
                      [&](uint32_t i, const auto& add) { add(ivec3(glm::floor(dvec3(cells[i]) / double{kBlock}))); });
        for (const ivec3& c : cells) {
            low_ = glm::min(low_, edge_ * dvec3(c));
            high_ = glm::max(high_, edge_ * dvec3(c + 1));
        }
    }

    Hit march(const Ray& ray, double from, double until, const Bounds& box) const {
        Span span = through(ray, low_, high_);
        bool glass = false;  // the ray enters the box: water there is cut flat
        if (!box.empty()) {
            const Span cut = through(ray, dvec3(box.min), dvec3(box.max));
            glass = cut.enter > std::max(span.enter, from);
            span = {std::max(span.enter, cut.enter), std::min(span.leave, cut.leave), cut.axis};
        }
        Hit hit;
        const double end = std::min(span.leave, until);
        double t = std::max(span.enter, from);
        if (t >= end) return hit;

        double value = surface_.value(ray.at(t)), before = t, earlier = t, valueBefore = value, valueEarlier = value;
        bool inside = value > IsoSurface::kLevel;
        double entered = t;
        if (inside) {
            hit.depth = t;
            hit.normal = -glm::normalize(ray.along);
            if (glass) {
                hit.normal = dvec3(0.0);
                hit.normal[span.axis] = ray.along[span.axis] > 0 ? -1 : 1;
            }
        }
        const auto enter = [&](double at) {
            entered = at;
            inside = true;
            if (hit.depth < double{kNoDepth}) return;
            hit.depth = at;
            hit.normal = surface_.normal(ray.at(at));
        };
        const auto leave = [&](double at) {
            hit.water += (at - entered) * ray.length;
            inside = false;
        };
        while (t < end) {
            earlier = before;
            valueEarlier = valueBefore;
            before = t;
            valueBefore = value;
            t = std::min(next(ray, t, value), end);
            value = surface_.value(ray.at(t));
            const bool in = value > IsoSurface::kLevel;
            if (in && !inside) {
                enter(crossing(ray, before, t));
            } else if (!in && inside) {
                leave(crossing(ray, before, t));
            } else if (!in && valueBefore > kPeak && valueBefore > valueEarlier && valueBefore >= value) {
                const double peak = highest(ray, earlier, t);
                if (surface_.value(ray.at(peak)) > IsoSurface::kLevel) {
                    enter(crossing(ray, earlier, peak));
                    leave(crossing(ray, peak, t));
                }
            }
        }
        if (inside) leave(end);
        return hit;
    }

  private:
    // Where to look next: behind emptiness, or a step on.
    double next(const Ray& ray, double t, double value) const {
        const double hair = 1e-6 * edge_ / ray.length;
        const dvec3 p = ray.at(t);
        const ivec3 block = blocks_.cellOf(p), cell = surface_.cells().cellOf(p);
        if (!blocks_.occupied(block)) return leaving(ray, block, kBlock * edge_, t) + hair;
        if (!surface_.cells().occupied(cell)) return leaving(ray, cell, edge_, t) + hair;
        // Half a spacing and more lies between the surface and values such as these; a hole or a sheet is not narrower.
        const double far = value < 0.02 ? 0.5 : value > 0.85 ? 0.7 : 0;
        return t + surface_.spacing() / ray.length * std::max(far, std::clamp(0.6 * std::abs(value - IsoSurface::kLevel), 0.08, 0.4));
    }
    static double leaving(const Ray& ray, const ivec3& cell, double edge, double t) {
        double end = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            if (ray.along[k] == 0) continue;
            end = std::min(end, (edge * (cell[k] + (ray.along[k] > 0 ? 1 : 0)) - ray.from[k]) / ray.along[k]);
        }
        return std::max(end, t);
    }
    double crossing(const Ray& ray, double a, double b) const {
        const bool inside = surface_.value(ray.at(a)) > IsoSurface::kLevel;
        while ((b - a) * ray.length > kNearest * surface_.spacing()) {
            const double middle = 0.5 * (a + b);
            ((surface_.value(ray.at(middle)) > IsoSurface::kLevel) == inside ? a : b) = middle;
        }
        return 0.5 * (a + b);
    }
    // Of a value that rises and falls between a and b.
    double highest(const Ray& ray, double a, double b) const {
        for (int k = 0; k < 16; ++k) {
            const double c = (2 * a + b) / 3, d = (a + 2 * b) / 3;
            if (surface_.value(ray.at(c)) < surface_.value(ray.at(d)))
                a = c;
            else
                b = d;
        }
        return 0.5 * (a + b);
    }

    const IsoSurface& surface_;
    double edge_;
    SparseCells blocks_;
    dvec3 low_{std::numeric_limits<double>::max()}, high_{std::numeric_limits<double>::lowest()};
};

}  // namespace

std::vector<vec4> bodyAtWalls(std::span<const vec4> particles, float spacing, const Bounds& box, float holds) {
    std::vector<vec4> all;
    std::copy_if(particles.begin(), particles.end(), std::back_inserter(all),
                 [least = bodyDensity(holds)](const vec4& p) { return p.w >= least; });
    if (box.empty()) return all;
    const float reach = ANISOTROPY_SUPPORT_HOST * spacing;
    for (int axis = 0; axis < 3; ++axis)  // one after the other: in an edge and a corner there are mirrored ones of mirrored ones
        for (size_t i = 0, count = all.size(); i < count; ++i)
            for (const float wall : {box.min[axis], box.max[axis]}) {
                vec4 p = all[i];
                if (!(std::abs(p[axis] - wall) < reach)) continue;
                p[axis] = 2 * wall - p[axis];
                all.push_back(p);
            }
    return all;
}

RaymarchPicture raymarch(const IsoSurface& surface, const FrameView& view, const RaymarchOptions& options) {
    RaymarchPicture picture;
    picture.width = std::max(view.width, 0);
    picture.height = std::max(view.height, 0);
    const size_t pixels = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
    picture.depth.assign(pixels, kNoDepth);
    picture.water.assign(pixels, vec4(0.0F));
    if (surface.count() == 0) return picture;
    const Marcher marcher(surface);
    const dmat4 toWorld = glm::inverse(dmat4(view.view)), projection(view.projection);
    const dmat3 turn(toWorld);
    const int across = (picture.width + kTile - 1) / kTile, tiles = across * ((picture.height + kTile - 1) / kTile);
    std::mutex telling;
    std::atomic<bool> stopped = false;
    int done = 0;
    const auto pixel = [&](int x, int y) {
        const dvec2 clip(2 * (x + 0.5) / picture.width - 1, 2 * (y + 0.5) / picture.height - 1);
        const dvec2 place((clip.x + projection[2][0] - projection[3][0]) / projection[0][0],
                          (clip.y + projection[2][1] - projection[3][1]) / projection[1][1]);
        const dvec3 v = view.parallel() ? dvec3(0, 0, -1) : dvec3(place, -1);
        const dvec3 from = view.parallel() ? dvec3(toWorld * glm::dvec4(place, 0, 1)) : dvec3(toWorld[3]);
        const Ray ray{from, turn * v, glm::length(v)};
        const size_t at = static_cast<size_t>(y) * static_cast<size_t>(picture.width) + static_cast<size_t>(x);
        const double until = options.until.empty() ? double{view.farPlane} : double{options.until[at]};
        const Hit hit = marcher.march(ray, double{view.nearPlane}, until, options.box);
        if (hit.depth >= double{kNoDepth}) return;
        picture.depth[at] = static_cast<float>(hit.depth);
        picture.water[at] = vec4(vec3(glm::transpose(turn) * hit.normal), static_cast<float>(hit.water));
    };
    parallelFor(0, tiles, [&](int tile) {
        if (stopped) return;
        const int left = kTile * (tile % across), bottom = kTile * (tile / across);
        for (int y = bottom; y < std::min(bottom + kTile, picture.height); ++y)
            for (int x = left; x < std::min(left + kTile, picture.width); ++x) pixel(x, y);
        const std::lock_guard lock(telling);
        if (!options.progress(static_cast<double>(++done) / tiles)) stopped = true;
    });
    return picture;
}

}  // namespace rivulet
