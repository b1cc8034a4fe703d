#include "fluid/flow/skin_search.h"

#include <algorithm>
#include <numeric>

namespace rivulet {

namespace {

constexpr size_t kTrianglesPerBox = 32;

// Bits of x, y and z in turn.
uint64_t interleaved(const uvec3& v) {
    uint64_t code = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
        for (int axis = 0; axis < 3; ++axis) code |= uint64_t{(v[axis] >> bit) & 1U} << (3 * bit + static_cast<unsigned>(axis));
    return code;
}

bool meets(const Bounds& box, const vec3& from, const vec3& way) {
    float enters = 0, leaves = 1;
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(way[axis]) < 1.0e-20F) {
            if (from[axis] < box.min[axis] || from[axis] > box.max[axis]) return false;
            continue;
        }
        const float a = (box.min[axis] - from[axis]) / way[axis], b = (box.max[axis] - from[axis]) / way[axis];
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
    }
    return enters <= leaves;
}

}  // namespace

SkinSearch::SkinSearch(const FlowMesh& mesh) : mesh_(&mesh), places_(mesh.rest) {
    Bounds all;
    for (const vec3& p : mesh.rest) all.add(p);
    const vec3 size = glm::max(all.size(), vec3(1.0e-9F));
    std::vector<uint64_t> code(mesh.triangleCount());
    for (size_t t = 0; t < code.size(); ++t) {
        const vec3 middle = (mesh.rest[mesh.corner[3 * t]] + mesh.rest[mesh.corner[3 * t + 1]] + mesh.rest[mesh.corner[3 * t + 2]]) / 3.0F;
        code[t] = interleaved(uvec3((middle - all.min) / size * 65535.0F));
    }
    order_.resize(code.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::stable_sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) { return code[a] < code[b]; });
    std::vector<vec4> rest;
    for (const vec3& p : mesh.rest) rest.emplace_back(p, 0.0F);
    follow(rest);
}

void SkinSearch::follow(std::span<const vec4> places) {
    for (size_t p = 0; p < places_.size(); ++p) places_[p] = vec3(places[p]);
    boxes_.assign((order_.size() + kTrianglesPerBox - 1) / kTrianglesPerBox, Bounds{});
    for (size_t k = 0; k < order_.size(); ++k)
        for (size_t c = 0; c < 3; ++c) boxes_[k / kTrianglesPerBox].add(places_[mesh_->corner[3 * size_t{order_[k]} + c]]);
}

std::optional<SkinSearch::Hit> SkinSearch::first(const vec3& from, const vec3& to) const {
    const vec3 way = to - from;
    std::optional<Hit> best;
    for (size_t b = 0; b < boxes_.size(); ++b) {
        if (!meets(boxes_[b], from, way)) continue;
        for (size_t k = b * kTrianglesPerBox; k < std::min((b + 1) * kTrianglesPerBox, order_.size()); ++k) {
            const uint32_t* c = &mesh_->corner[3 * size_t{order_[k]}];
            // Moeller and Trumbore 1997.
            const vec3 e1 = places_[c[1]] - places_[c[0]], e2 = places_[c[2]] - places_[c[0]], p = glm::cross(way, e2);
            const float det = glm::dot(e1, p);
            if (std::abs(det) < 1.0e-20F) continue;
            const vec3 s = from - places_[c[0]], q = glm::cross(s, e1);
            const float b1 = glm::dot(s, p) / det, b2 = glm::dot(way, q) / det, share = glm::dot(e2, q) / det;
            if (!(b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && share >= 0 && share <= 1)) continue;
            if (best && share >= best->share) continue;
            best = Hit{{order_[k], b1, b2}, from + way * share, glm::normalize(glm::cross(e1, e2)), share};
        }
    }
    return best;
}

}  // namespace rivulet
