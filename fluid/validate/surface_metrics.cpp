#include "fluid/validate/surface_metrics.h"

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"

namespace rivulet {

namespace {

// Reorders them.
double percentile(std::vector<double>& of, double share) {
    const auto at = of.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(of.size() - 1));
    std::nth_element(of.begin(), at, of.end());
    return *at;
}

}  // namespace

void fillNormals(SurfaceMap& map, const FrameView& view, float radius) {
    const dmat4 projection(view.projection);
    const auto depthAt = [&](int x, int y) {
        return double{map.depth[static_cast<size_t>(std::clamp(y, 0, map.height - 1)) * static_cast<size_t>(map.width) +
                                static_cast<size_t>(std::clamp(x, 0, map.width - 1))]};
    };
    const auto point = [&](int x, int y, double depth) {
        const double u = 2 * (x + 0.5) / map.width - 1, v = 2 * (y + 0.5) / map.height - 1;
        return depth * dvec3((u + projection[2][0]) / projection[0][0], (v + projection[2][1]) / projection[1][1], -1);
    };
    map.normal.assign(map.depth.size(), vec3(0, 0, 1));
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const size_t i = static_cast<size_t>(y) * static_cast<size_t>(map.width) + static_cast<size_t>(x);
            if (!map.there(i)) continue;
            const double here = depthAt(x, y), near = 0.5 * double{radius};
            const dvec3 p = point(x, y, here);
            dvec3 along[2];
            for (int axis = 0; axis < 2; ++axis) {
                const int dx = axis == 0 ? 1 : 0, dy = 1 - dx;
                const double ahead = depthAt(x + dx, y + dy), behind = depthAt(x - dx, y - dy);
                const dvec3 to = point(x + dx, y + dy, ahead) - p, from = p - point(x - dx, y - dy, behind);
                const double a = std::abs(ahead - here), b = std::abs(behind - here);
                along[axis] = a < near && b < near ? 0.5 * (to + from) : a < b ? to : from;
            }
            map.normal[i] = vec3(glm::normalize(glm::cross(along[0], along[1])));
        }
}

double angleBetween(const vec3& a, const vec3& b) {
    const dvec3 m(a), r(b);
    return glm::degrees(std::atan2(glm::length(glm::cross(m, r)), glm::dot(m, r)));
}

SurfaceErrors compareSurfaces(const SurfaceMap& measured, const SurfaceMap& reference, float radius) {
    ASSERT(measured.depth.size() == reference.depth.size(), "surfaces are compared at one size");
    SurfaceErrors e;
    std::vector<double> angles, offs;
    double squares = 0;
    size_t either = 0;
    for (size_t i = 0; i < measured.depth.size(); ++i) {
        const bool a = measured.there(i), b = reference.there(i);
        either += a || b ? 1 : 0;
        if (!a || !b) continue;
        angles.push_back(angleBetween(measured.normal[i], reference.normal[i]));
        const double off = double{measured.depth[i]} - double{reference.depth[i]};
        offs.push_back(std::abs(off) / double{radius});
        squares += off * off;
        e.normalMean += angles.back();
    }
    e.pixels = angles.size();
    e.overlap = either > 0 ? static_cast<double>(e.pixels) / static_cast<double>(either) : 1;
    if (e.pixels == 0) return e;
    e.normalMean /= static_cast<double>(e.pixels);
    e.depthRms = std::sqrt(squares / static_cast<double>(e.pixels)) / double{radius};
    e.normalMedian = percentile(angles, 0.5);
    e.normal95 = percentile(angles, 0.95);
    e.depthMedian = percentile(offs, 0.5);
    return e;
}

double overlapOf(const std::vector<bool>& a, const std::vector<bool>& b) {
    ASSERT(a.size() == b.size(), "silhouettes are compared at one size");
    size_t both = 0, either = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        both += a[i] && b[i] ? 1 : 0;
        either += a[i] || b[i] ? 1 : 0;
    }
    return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 1;
}

std::vector<bool> silhouetteBand(const std::vector<bool>& covered, int width, int reach) {
    const int height = static_cast<int>(covered.size()) / width;
    std::vector<bool> band(covered.size());
    const auto at = [&](int x, int y) { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool here = covered[at(x, y)];
            for (int k = -reach; k <= reach && !band[at(x, y)]; ++k)
                band[at(x, y)] = (x + k >= 0 && x + k < width && covered[at(x + k, y)] != here) ||
                                 (y + k >= 0 && y + k < height && covered[at(x, y + k)] != here);
        }
    return band;
}

void UnexplainedChange::add(std::span<const uint8_t> rgba, std::span<const uint8_t> reference, const std::vector<bool>& covered) {
    ASSERT(rgba.size() == 4 * pixels_ && reference.size() == 4 * pixels_ && covered.size() == pixels_, "frames have this size");
    std::vector<bool> band = silhouetteBand(covered, width_, kSilhouettePixels);
    for (size_t i = 0; i < pixels_ && !last_.empty(); ++i) {
        const bool water = covered[i] || lastCovered_[i], edge = band[i] || lastBand_[i];
        for (size_t c = 4 * i; c < 4 * i + 3 && (water || edge); ++c) {
            const double beyond = std::max(std::abs(rgba[c] - last_[c]) - std::abs(reference[c] - lastReference_[c]), 0);
            for (Mean* of : {water ? &all_ : nullptr, edge ? &edge_ : nullptr}) {
                if (of == nullptr) continue;
                of->sum += beyond;
                of->count += 1;
            }
        }
    }
    last_.assign(rgba.begin(), rgba.end());
    lastReference_.assign(reference.begin(), reference.end());
    lastCovered_ = covered;
    lastBand_ = std::move(band);
}

void Flicker::add(std::span<const uint8_t> rgba) {
    ASSERT(rgba.size() == 4 * where_.size(), "frames have the size of the mask");
    for (size_t i = 0; i < where_.size(); ++i)
        for (size_t c = 0; c < 3 && where_[i]; ++c) {
            const double v = rgba[4 * i + c];
            sum_[3 * i + c] += v;
            squares_[3 * i + c] += v * v;
        }
    ++frames_;
}

double Flicker::rms() const {
    double variance = 0;
    size_t count = 0;
    for (size_t k = 0; k < sum_.size(); ++k) {
        if (!where_[k / 3]) continue;
        const double mean = sum_[k] / std::max(frames_, 1);
        variance += std::max(squares_[k] / std::max(frames_, 1) - mean * mean, 0.0);
        ++count;
    }
    return count > 0 ? std::sqrt(variance / static_cast<double>(count)) : 0;
}

}  // namespace rivulet
