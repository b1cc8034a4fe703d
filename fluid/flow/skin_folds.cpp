#include "fluid/flow/skin_folds.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "fluid/voxel/nearest_weights.h"

namespace rivulet {

namespace {

// How far the search goes along the skin, over `reach`, and how many triangles it visits.
constexpr float kRound = 1.6F;
constexpr size_t kMostSeen = 6000;
// A triangle represents the smaller ones that lie wholly within this share of `reach` of its middle. The search covers 1 + kTogether of
// `reach`, so none that matters is missed.
constexpr float kTogether = 0.25F;
// Normals further apart face away from each other.
constexpr float kAway = -0.2F;

// Places of a skin, no further apart than `apart`: the middle of small triangles, several on large ones.
struct Sample {
    vec3 x;
    uint32_t triangle;
};

class Samples {
  public:
    Samples(const FlowMesh& mesh, float cell) : cell_(cell) {
        for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
            const vec3 a = mesh.rest[mesh.corner[3 * size_t{t}]], b = mesh.rest[mesh.corner[3 * size_t{t} + 1]],
                       c = mesh.rest[mesh.corner[3 * size_t{t} + 2]];
            const float longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
            const int rows = static_cast<int>(std::clamp(std::ceil(longest / cell), 1.0F, 256.0F));
            for (int i = 0; i < rows; ++i)
                for (int k = 0; k < rows - i; ++k) {
                    const float b1 = (static_cast<float>(i) + 1.0F / 3) / static_cast<float>(rows),
                                b2 = (static_cast<float>(k) + 1.0F / 3) / static_cast<float>(rows);
                    all_.push_back({positionOf(mesh, {t, b1, b2}), t});
                }
        }
        for (uint32_t k = 0; k < all_.size(); ++k) cells_[keyOf(ivec3(glm::floor(all_[k].x / cell_)))].push_back(k);
    }
    const std::vector<Sample>& all() const { return all_; }
    template <class F>
    void eachWithin(const vec3& x, float reach, F&& see) const {
        const ivec3 low(glm::floor((x - reach) / cell_)), high(glm::floor((x + reach) / cell_));
        for (int z = low.z; z <= high.z; ++z)
            for (int y = low.y; y <= high.y; ++y)
                for (int i = low.x; i <= high.x; ++i) {
                    const auto found = cells_.find(keyOf({i, y, z}));
                    if (found == cells_.end()) continue;
                    for (const uint32_t k : found->second)
                        if (glm::distance(all_[k].x, x) < reach) see(all_[k].triangle);
                }
    }

  private:
    static uint64_t keyOf(const ivec3& c) {
        constexpr uint64_t kMask = (uint64_t{1} << 21U) - 1;
        return (static_cast<uint64_t>(c.x) & kMask) | (static_cast<uint64_t>(c.y) & kMask) << 21U |
               (static_cast<uint64_t>(c.z) & kMask) << 42U;
    }
    float cell_;
    std::vector<Sample> all_;
    std::unordered_map<uint64_t, std::vector<uint32_t>> cells_;
};

float distanceTo(const FlowMesh& m, uint32_t t, const vec3& x) {
    const dvec3 a(m.rest[m.corner[3 * size_t{t}]]), b(m.rest[m.corner[3 * size_t{t} + 1]]), c(m.rest[m.corner[3 * size_t{t} + 2]]);
    const std::array<double, 3> w = nearestWeights(dvec3(x), a, b, c);
    return static_cast<float>(glm::distance(w[0] * a + w[1] * b + w[2] * c, dvec3(x)));
}

}  // namespace

std::vector<float> skinFolds(const FlowMesh& mesh, float reach) {
    std::vector<float> folds(mesh.triangleCount(), kNoFold);
    if (!(reach > 0)) return folds;
    std::vector<vec3> normal(mesh.triangleCount());
    for (size_t t = 0; t < normal.size(); ++t) {
        const vec3 a = mesh.rest[mesh.corner[3 * t]];
        const vec3 n = glm::cross(mesh.rest[mesh.corner[3 * t + 1]] - a, mesh.rest[mesh.corner[3 * t + 2]] - a);
        normal[t] = glm::dot(n, n) > 0 ? glm::normalize(n) : vec3(0.0F);
    }
    // A ball about each triangle decides most distance tests.
    std::vector<vec4> ball;
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
        const vec3 middle = positionOf(mesh, {t, 1.0F / 3, 1.0F / 3});
        float radius = 0;
        for (size_t c = 0; c < 3; ++c) radius = std::max(radius, glm::distance(middle, mesh.rest[mesh.corner[3 * size_t{t} + c]]));
        ball.emplace_back(middle, radius);
    }
    const auto within = [&](uint32_t t, const vec3& x, float most) {
        const float far = glm::distance(vec3(ball[t]), x);
        return far < most || (far - ball[t].w < most && distanceTo(mesh, t, x) < most);
    };
    std::vector<uint32_t> open, speaker(mesh.triangleCount(), UINT32_MAX);
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
        if (speaker[t] != UINT32_MAX) continue;
        speaker[t] = t;
        open.assign(1, t);
        for (size_t next = 0; next < open.size(); ++next)
            for (size_t edge = 0; edge < 3; ++edge) {
                const uint32_t across = mesh.across[3 * size_t{open[next]} + edge], other = across / 4;
                if (across == FlowMesh::kOpen || speaker[other] != UINT32_MAX) continue;
                if (glm::distance(vec3(ball[t]), vec3(ball[other])) + ball[other].w > kTogether * reach) continue;
                speaker[other] = t;
                open.push_back(other);
            }
    }
    const Samples samples(mesh, reach);
    std::vector<uint32_t> seen(mesh.triangleCount(), UINT32_MAX);
    for (uint32_t k = 0; k < samples.all().size(); ++k) {
        const Sample& own = samples.all()[k];
        if (speaker[own.triangle] != own.triangle) continue;
        open.assign(1, own.triangle);
        seen[own.triangle] = k;
        for (size_t next = 0; next < open.size() && open.size() < kMostSeen; ++next)
            for (size_t edge = 0; edge < 3; ++edge) {
                const uint32_t across = mesh.across[3 * size_t{open[next]} + edge];
                if (across == FlowMesh::kOpen || seen[across / 4] == k) continue;
                seen[across / 4] = k;
                if (within(across / 4, own.x, kRound * reach)) open.push_back(across / 4);
            }
        float& nearest = folds[own.triangle];
        samples.eachWithin(own.x, (1 + kTogether) * reach, [&](uint32_t other) {
            if (seen[other] == k && glm::dot(normal[own.triangle], normal[other]) >= kAway) return;
            // From its own middle and corners, if these can be nearer.
            if (glm::distance(vec3(ball[other]), vec3(ball[own.triangle])) - ball[other].w - ball[own.triangle].w >= nearest) return;
            nearest = std::min(nearest, distanceTo(mesh, other, own.x));
            for (size_t c = 0; c < 3; ++c)
                nearest = std::min(nearest, distanceTo(mesh, other, mesh.rest[mesh.corner[3 * size_t{own.triangle} + c]]));
        });
    }
    for (size_t t = 0; t < folds.size(); ++t)
        if (const float nearest = folds[speaker[t]]; speaker[t] != t && nearest < kNoFold)
            folds[t] = std::max(nearest - kTogether * reach, 0.0F);
    return folds;
}

}  // namespace rivulet
