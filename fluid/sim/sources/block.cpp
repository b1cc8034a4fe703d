#include "fluid/sim/sources/block.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/core/large_pages.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxelize_solid.h"

namespace rivulet {

namespace {
// A hair more than the edge allows: 0.5 m at 0.02 m is 25, not 24, whatever the rounding.
double along(float lo, float hi, float spacing) { return std::max(std::floor((double{hi} - double{lo}) / spacing + 1e-3), 0.0); }

// -1..1, evenly, of any two numbers (the finalizer of MurmurHash3, Appleby 2011).
float jittered(uint32_t place, uint32_t axis) {
    uint64_t k = (uint64_t{place} << 2U | axis) + 1;
    for (const uint64_t factor : {0xff51afd7ed558ccdULL, 0xc4ceb9fe1a85ec53ULL}) {
        k ^= k >> 33U;
        k *= factor;
    }
    k ^= k >> 33U;
    return static_cast<float>(k >> 40U) / 8388608.0F - 1.0F;
}

// The sites of a block's box: x fastest, centred in it.
struct Lattice {
    ivec3 count;
    vec3 first;  // m
    float spacing;
    Lattice(const BlockParams& b, float s)
        : count(static_cast<int>(along(b.min.x, b.max.x, s)), static_cast<int>(along(b.min.y, b.max.y, s)),
                static_cast<int>(along(b.min.z, b.max.z, s))),
          first(b.min + 0.5F * (b.max - b.min - vec3(count) * s) + vec3(0.5F * s)),
          spacing(s) {}
    vec3 at(const ivec3& c) const { return first + vec3(c) * spacing; }
    size_t place(const ivec3& c) const {
        return (static_cast<size_t>(c.z) * static_cast<size_t>(count.y) + static_cast<size_t>(c.y)) * static_cast<size_t>(count.x) +
               static_cast<size_t>(c.x);
    }
    size_t size() const { return static_cast<size_t>(count.x) * static_cast<size_t>(count.y) * static_cast<size_t>(count.z); }
};

using Sites = std::vector<bool>;  // by place: those in the shape

Sites sitesOfBall(const BlockParams& b, const Lattice& lattice) {
    const vec3 middle = 0.5F * (b.min + b.max), half = 0.5F * (b.max - b.min);
    Sites in(lattice.size());
    for (ivec3 c(0); c.z < lattice.count.z; ++c.z)
        for (c.y = 0; c.y < lattice.count.y; ++c.y)
            for (c.x = 0; c.x < lattice.count.x; ++c.x) in[lattice.place(c)] = glm::length((lattice.at(c) - middle) / half) <= 1;
    return in;
}

// The sites within a circle of 20 spacings have an area that is up to 1.4 % wrong (Gauss's circle problem), in every layer the same. So a
// layer takes as many as it has room for, the innermost first.
Sites sitesAlongAxis(const BlockParams& b, const Lattice& lattice) {
    const int axis = b.axis == "x" ? 0 : b.axis == "y" ? 1 : 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const vec3 middle = 0.5F * (b.min + b.max), half = 0.5F * (b.max - b.min);
    const double spacing = lattice.spacing, base = double{kPi} * half[u] * half[v], height = 2.0 * half[axis];
    const auto volumeBelow = [&](double y) {  // m^3, of the shape; y in m above its base
        return b.shape == "cone" ? base * height / 3 * (1 - std::pow(1 - y / height, 3)) : base * y;
    };
    const double low = double{lattice.first[axis]} - 0.5 * spacing - double{b.min[axis]};
    Sites in(lattice.size());
    std::vector<std::pair<float, size_t>> layer;
    double placed = 0;
    for (int k = 0; k < lattice.count[axis]; ++k) {
        layer.clear();
        ivec3 c(0);
        c[axis] = k;
        for (c[v] = 0; c[v] < lattice.count[v]; ++c[v])
            for (c[u] = 0; c[u] < lattice.count[u]; ++c[u]) {
                const vec3 r = (lattice.at(c) - middle) / half;
                // Sites at the same distance are taken in an order without a direction.
                const float order = jittered(static_cast<uint32_t>(layer.size()), 3);
                layer.emplace_back(glm::length(vec2(r[u], r[v])) * (1 + 1.0e-5F * order), lattice.place(c));
            }
        const double due = (volumeBelow(low + (k + 1) * spacing) - volumeBelow(low)) / (spacing * spacing * spacing);
        const size_t taken = std::min(static_cast<size_t>(std::max(std::round(due - placed), 0.0)), layer.size());
        placed += static_cast<double>(taken);
        std::nth_element(layer.begin(), layer.begin() + static_cast<std::ptrdiff_t>(taken), layer.end());
        for (size_t n = 0; n < taken; ++n) in[layer[n].second] = true;
    }
    return in;
}

// A voxel about each site: its bit is set if the mesh encloses its centre, which is the site.
Sites sitesOfMesh(const Lattice& lattice, std::span<const vec3> triangles) {
    VoxelGrid grid;
    grid.size = lattice.count;
    grid.voxel = lattice.spacing;
    grid.origin = lattice.first - vec3(0.5F * lattice.spacing);
    std::vector<uint32_t> indices(triangles.size());
    std::iota(indices.begin(), indices.end(), 0U);
    const MeshView mesh{triangles, indices, {}, {}};
    voxelizeSolid(cleanMesh(std::span(&mesh, 1)), grid);
    Sites in(lattice.size());
    for (size_t k = 0; k < in.size(); ++k) in[k] = ((grid.bits[k >> 3U] >> (k & 7U)) & 1U) != 0;
    return in;
}
}  // namespace

double blockCount(const BlockParams& b, float spacing) {
    return along(b.min.x, b.max.x, spacing) * along(b.min.y, b.max.y, spacing) * along(b.min.z, b.max.z, spacing);
}

vec3 velocityAt(const BlockParams& b, const vec3& at) {
    const vec3 r = at - 0.5F * (b.min + b.max);
    return b.velocity + glm::cross(b.spin, r) + vec3(glm::dot(b.gradientX, r), glm::dot(b.gradientY, r), glm::dot(b.gradientZ, r));
}

float fastestOf(const BlockParams& b) {
    float fastest = 0;  // of a field that is linear, at a corner
    for (int k = 0; k < 8; ++k)
        fastest = std::max(fastest, glm::length(velocityAt(b, glm::mix(b.min, b.max, vec3(k & 1, (k >> 1) & 1, k >> 2)))));
    return fastest;
}

std::vector<vec3> randomTile(float jitter) {
    std::vector<vec3> offsets(size_t{kTile} * kTile * kTile);
    for (uint32_t place = 0; place < offsets.size(); ++place)
        offsets[place] = jitter * vec3(jittered(place, 0), jittered(place, 1), jittered(place, 2));
    return offsets;
}

void fillBlock(const BlockParams& b, float spacing, std::vector<NewParticle>& to, std::span<const vec3> triangles,
               std::span<const vec3> tile) {
    const Lattice lattice(b, spacing);
    if (lattice.size() == 0) return;
    const Sites in = b.shape == "box"    ? Sites()
                     : b.shape == "ball" ? sitesOfBall(b, lattice)
                     : b.shape == "mesh" ? sitesOfMesh(lattice, triangles)
                                         : sitesAlongAxis(b, lattice);
    const auto has = [&](const ivec3& c) {
        if (glm::any(glm::lessThan(c, ivec3(0))) || glm::any(glm::greaterThanEqual(c, lattice.count))) return false;
        return in.empty() || in[lattice.place(c)];
    };
    // Along an axis only particles between two others: those at a wall or a surface would come too close to the next layer.
    const auto offset = [&](const ivec3& c, uint32_t place) {
        vec3 away(0.0F);
        const vec3 ofTile =
            tile.empty() ? vec3(0.0F) : tile[static_cast<size_t>((c.z % kTile * kTile + c.y % kTile) * kTile + c.x % kTile)];
        for (int axis = 0; axis < 3; ++axis) {
            ivec3 next(0);
            next[axis] = 1;
            if (has(c - next) && has(c + next))
                away[axis] = tile.empty() ? b.jitter * spacing * jittered(place, static_cast<uint32_t>(axis)) : spacing * ofTile[axis];
        }
        return away;
    };
    reserveLarge(to, to.size() + (in.empty() ? lattice.size() : static_cast<size_t>(std::count(in.begin(), in.end(), true))));
    uint32_t place = 0;
    for (ivec3 c(0); c.z < lattice.count.z; ++c.z)
        for (c.y = 0; c.y < lattice.count.y; ++c.y)
            for (c.x = 0; c.x < lattice.count.x; ++c.x, ++place) {
                if (!in.empty() && !in[place]) continue;
                const vec3 at = lattice.at(c) + (b.jitter > 0 ? offset(c, place) : vec3(0.0F));
                to.push_back({at, velocityAt(b, at)});
            }
}

}  // namespace rivulet
