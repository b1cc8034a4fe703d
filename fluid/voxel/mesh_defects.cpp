#include "fluid/voxel/mesh_defects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "engine/core/assert.h"

namespace rivulet {
namespace {

constexpr uint32_t kNoNumber = UINT32_MAX;

// Finds the number of a place: an open-addressed table of numbers, at most half full.
class Places {
  public:
    Places(size_t most, std::vector<vec3>& positions) : positions_(positions), slots_(std::bit_ceil(2 * most + 1), kNoNumber) {}
    uint32_t number(const vec3& given) {
        const vec3 p = given + 0.0F;  // -0 is 0
        size_t at = hash(p) & (slots_.size() - 1);
        while (slots_[at] != kNoNumber) {
            if (positions_[slots_[at]] == p) return slots_[at];
            at = (at + 1) & (slots_.size() - 1);
        }
        slots_[at] = static_cast<uint32_t>(positions_.size());
        positions_.push_back(p);
        return slots_[at];
    }

  private:
    static size_t hash(const vec3& p) {
        uint64_t h = 0;
        for (float f : {p.x, p.y, p.z}) h = (h ^ std::bit_cast<uint32_t>(f)) * 0x9E3779B97F4A7C15U;
        return static_cast<size_t>(h ^ (h >> 32U));
    }
    std::vector<vec3>& positions_;
    std::vector<uint32_t> slots_;
};

// Items sorted into buckets by counting: bucket b holds items [start[b], start[b + 1]).
template <class T>
struct Buckets {
    std::vector<uint32_t> start;
    std::vector<T> items;
    // each(put) is called twice and calls put(bucket, item) for every item.
    template <class Each>
    Buckets(size_t buckets, Each each) : start(buckets + 2, 0) {
        each([&](uint32_t bucket, const T&) { ++start[bucket + 2]; });
        for (size_t b = 2; b < start.size(); ++b) start[b] += start[b - 1];
        items.resize(start.back());
        each([&](uint32_t bucket, const T& item) { items[start[bucket + 1]++] = item; });
        start.pop_back();
    }
    std::span<T> operator[](size_t b) { return std::span(items).subspan(start[b], start[b + 1] - start[b]); }
};

// Sets of faces joined by edges (Tarjan 1975), each face with its orientation relative to the first of its set: 1 if they disagree.
class Faces {
  public:
    explicit Faces(size_t count) : parent_(count), turned_(count, 0), twisted_(count, 0) {
        for (size_t k = 0; k < count; ++k) parent_[k] = static_cast<uint32_t>(k);
    }
    struct Root {
        uint32_t face;
        uint8_t turned;
    };
    Root find(uint32_t face) {
        uint8_t turned = 0;
        while (parent_[face] != face) {
            const uint32_t above = parent_[face];
            turned ^= turned_[face];
            if (parent_[above] != above) {  // halve the path
                parent_[face] = parent_[above];
                turned_[face] ^= turned_[above];
                turned ^= turned_[above];
                face = parent_[face];
            } else {
                face = above;
            }
        }
        return {face, turned};
    }
    // `apart`: 1 if one of them must be reversed for both to agree. The root of a set is its lowest face.
    void join(uint32_t a, uint32_t b, uint8_t apart) {
        const Root ra = find(a), rb = find(b);
        const auto between = static_cast<uint8_t>(ra.turned ^ rb.turned ^ apart);
        if (ra.face == rb.face) {
            twisted_[ra.face] |= between;
            return;
        }
        const uint32_t low = std::min(ra.face, rb.face), high = std::max(ra.face, rb.face);
        parent_[high] = low;
        turned_[high] = between;
        twisted_[low] |= twisted_[high];
    }
    bool twisted(uint32_t root) const { return twisted_[root] != 0; }

  private:
    std::vector<uint32_t> parent_;
    std::vector<uint8_t> turned_;   // against the parent
    std::vector<uint8_t> twisted_;  // of a root: the set cannot be oriented
};

// A face's edge in the bucket of its lower place.
struct HalfEdge {
    uint32_t high;      // the edge's other place
    uint32_t faceDown;  // 2 * face, + 1 if the face runs from `high` down
    uint32_t face() const { return faceDown >> 1U; }
    uint8_t down() const { return faceDown & 1U; }
};

// Lists the faces of three different places, in the meshes' order; counts the others.
void weld(std::span<const MeshView> meshes, CleanMesh& mesh) {
    size_t corners = 0, most = 0;
    for (const MeshView& m : meshes) {
        corners += m.indices.size();
        most += std::min(m.positions.size(), m.indices.size());
    }
    ASSERT(corners < size_t{1} << 31U, "a mesh may have fewer than 2^31 corners of triangles");
    mesh.indices.reserve(corners);
    mesh.source.reserve(corners / 3);
    mesh.positions.reserve(most);
    Places places(most, mesh.positions);
    std::vector<uint32_t> known;
    for (const MeshView& m : meshes) {
        known.assign(m.positions.size(), kNoNumber);
        for (size_t t = 0; t < m.triangleCount(); ++t) {
            std::array<uint32_t, 3> corner{};
            for (size_t k = 0; k < 3; ++k) {
                uint32_t& number = known[m.indices[3 * t + k]];
                if (number == kNoNumber) number = places.number(m.positions[m.indices[3 * t + k]]);
                corner[k] = number;
            }
            const auto source = static_cast<uint32_t>(mesh.defects.triangles++);
            if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) {
                ++mesh.defects.degenerateFaces;
                continue;
            }
            mesh.indices.insert(mesh.indices.end(), corner.begin(), corner.end());
            mesh.source.push_back(source);
        }
    }
}

// Keeps the first of equal faces.
void dropDuplicates(CleanMesh& mesh) {
    struct Rest {
        uint32_t second, third, face;
    };
    const auto faces = static_cast<uint32_t>(mesh.source.size());
    const std::vector<uint32_t>& index = mesh.indices;
    Buckets<Rest> byLowest(mesh.positions.size(), [&](auto put) {
        for (uint32_t f = 0; f < faces; ++f) {
            const uint32_t a = index[3 * f], b = index[3 * f + 1], c = index[3 * f + 2];
            if (a < b && a < c)
                put(a, Rest{b, c, f});
            else if (b < c)
                put(b, Rest{c, a, f});
            else
                put(c, Rest{a, b, f});
        }
    });
    std::vector<uint8_t> again(faces, 0);
    for (size_t place = 0; place < mesh.positions.size(); ++place) {
        const std::span<Rest> some = byLowest[place];
        if (some.size() < 2) continue;
        std::sort(some.begin(), some.end(), [](const Rest& a, const Rest& b) {
            return a.second != b.second ? a.second < b.second : (a.third != b.third ? a.third < b.third : a.face < b.face);
        });
        for (size_t k = 1; k < some.size(); ++k) {
            if (some[k].second != some[k - 1].second || some[k].third != some[k - 1].third) continue;
            again[some[k].face] = 1;
            ++mesh.defects.duplicateFaces;
        }
    }
    if (mesh.defects.duplicateFaces == 0) return;
    size_t kept = 0;
    for (size_t f = 0; f < faces; ++f) {
        if (again[f] != 0) continue;
        for (size_t k = 0; k < 3; ++k) mesh.indices[3 * kept + k] = mesh.indices[3 * f + k];
        mesh.source[kept++] = mesh.source[f];
    }
    mesh.indices.resize(3 * kept);
    mesh.source.resize(kept);
}

using Edges = Buckets<HalfEdge>;

// Half-edges by their lower place; those of one edge are adjacent, in the order of their faces.
Edges edgesOf(const CleanMesh& mesh) {
    Edges edges(mesh.positions.size(), [&](auto put) {
        for (uint32_t f = 0; f < mesh.source.size(); ++f) {
            for (uint32_t k = 0; k < 3; ++k) {
                const uint32_t from = mesh.indices[3 * f + k], to = mesh.indices[3 * f + (k + 1) % 3];
                put(std::min(from, to), HalfEdge{std::max(from, to), 2 * f + (from > to ? 1U : 0U)});
            }
        }
    });
    const auto before = [](const HalfEdge& a, const HalfEdge& b) { return a.high != b.high ? a.high < b.high : a.faceDown < b.faceDown; };
    for (size_t place = 0; place < mesh.positions.size(); ++place) std::sort(edges[place].begin(), edges[place].end(), before);
    return edges;
}

// visit(lower place, the edge's half-edges) for every edge.
template <class Visit>
void eachEdge(Edges& edges, size_t places, Visit visit) {
    for (uint32_t place = 0; place < places; ++place) {
        const std::span<HalfEdge> all = edges[place];
        for (size_t first = 0; first < all.size();) {
            size_t end = first + 1;
            while (end < all.size() && all[end].high == all[first].high) ++end;
            visit(place, all.subspan(first, end - first));
            first = end;
        }
    }
}

double areaOf(const CleanMesh& mesh, size_t face) {
    const dvec3 a(mesh.positions[mesh.indices[3 * face]]);
    const dvec3 b(mesh.positions[mesh.indices[3 * face + 1]]), c(mesh.positions[mesh.indices[3 * face + 2]]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

// Numbers the components and reverses the faces in the minority. Returns a flag per face: 1 if reversed.
std::vector<uint8_t> makeConsistent(CleanMesh& mesh, Faces& faces) {
    MeshDefects& defects = mesh.defects;
    const size_t count = mesh.source.size();
    mesh.component.resize(count);
    std::vector<uint8_t> turned(count);
    std::vector<uint32_t> number(count, kNoNumber);  // of a root
    struct Component {
        uint32_t root = 0;
        bool mixed = false;
        std::array<double, 2> area{0.0, 0.0};  // [1]: of the faces that disagree with the first
    };
    std::vector<Component> components;
    for (uint32_t f = 0; f < count; ++f) {
        const Faces::Root root = faces.find(f);
        if (number[root.face] == kNoNumber) {
            number[root.face] = static_cast<uint32_t>(components.size());
            components.push_back({root.face});
        }
        mesh.component[f] = number[root.face];
        turned[f] = root.turned;
        components[number[root.face]].mixed |= root.turned != 0;
    }
    defects.components = components.size();
    for (const Component& c : components) defects.unorientable += faces.twisted(c.root) ? 1 : 0;
    if (std::any_of(components.begin(), components.end(), [](const Component& c) { return c.mixed; })) {
        for (size_t f = 0; f < count; ++f) {
            Component& c = components[mesh.component[f]];
            if (c.mixed) c.area[turned[f]] += areaOf(mesh, f);
        }
    }
    for (size_t f = 0; f < count; ++f) {
        const Component& c = components[mesh.component[f]];
        const uint8_t minority = c.area[1] > c.area[0] ? 0 : 1;
        const bool turn = c.mixed && !faces.twisted(c.root) && turned[f] == minority;
        turned[f] = turn ? 1 : 0;
        if (!turn) continue;
        std::swap(mesh.indices[3 * f + 1], mesh.indices[3 * f + 2]);
        ++defects.flippedFaces;
    }
    return turned;
}

std::string plural(size_t count, const char* one, const char* many) { return fmt::format("{} {}", count, count == 1 ? one : many); }

std::string listed(const std::vector<std::string>& items) {
    std::string all;
    for (size_t k = 0; k < items.size(); ++k) {
        if (k > 0) all += k + 1 == items.size() ? " and " : ", ";
        all += items[k];
    }
    return all;
}

}  // namespace

std::string MeshDefects::sentence() const {
    std::vector<std::string> wrong, done;
    if (boundaryEdges > 0) wrong.push_back(plural(boundaryEdges, "boundary edge (a hole)", "boundary edges (holes)"));
    if (nonManifoldEdges > 0) wrong.push_back(plural(nonManifoldEdges, "edge", "edges") + " of three or more faces");
    if (unorientable > 0) wrong.push_back(plural(unorientable, "part", "parts") + " that cannot be oriented (as a Moebius strip)");
    if (flippedFaces > 0) wrong.push_back(plural(flippedFaces, "face", "faces") + " facing the wrong way");
    if (duplicateFaces > 0) wrong.push_back(plural(duplicateFaces, "repeated face", "repeated faces"));
    if (degenerateFaces > 0) wrong.push_back(plural(degenerateFaces, "face", "faces") + " with two corners at one place");
    if (wrong.empty()) return "";
    if (!watertight) done.emplace_back("inside is decided by winding number");
    if (flippedFaces > 0) done.emplace_back("these faces were reversed");
    if (duplicateFaces + degenerateFaces > 0) done.emplace_back("repeated and degenerate faces were removed");
    if (done.empty()) done.emplace_back("it is closed all the same");
    return "The mesh has " + listed(wrong) + ": " + listed(done) + ".";
}

CleanMesh cleanMesh(std::span<const MeshView> meshes) {
    CleanMesh mesh;
    weld(meshes, mesh);
    dropDuplicates(mesh);
    Edges edges = edgesOf(mesh);
    Faces faces(mesh.source.size());
    eachEdge(edges, mesh.positions.size(), [&](uint32_t, std::span<const HalfEdge> edge) {
        if (edge.size() == 1) ++mesh.defects.boundaryEdges;
        if (edge.size() > 2) ++mesh.defects.nonManifoldEdges;
        if (edge.size() == 2) faces.join(edge[0].face(), edge[1].face(), edge[0].down() == edge[1].down() ? 1 : 0);
    });
    const std::vector<uint8_t> turned = makeConsistent(mesh, faces);
    eachEdge(edges, mesh.positions.size(), [&](uint32_t low, std::span<const HalfEdge> edge) {
        int up = 0;
        for (const HalfEdge& e : edge) up += (e.down() ^ turned[e.face()]) != 0 ? -1 : 1;
        for (int k = 0; k < std::abs(up); ++k) {
            mesh.unmatched.push_back(up > 0 ? low : edge[0].high);
            mesh.unmatched.push_back(up > 0 ? edge[0].high : low);
        }
    });
    mesh.defects.watertight = mesh.defects.boundaryEdges == 0 && mesh.unmatched.empty();
    return mesh;
}

}  // namespace rivulet
