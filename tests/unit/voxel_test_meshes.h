// Meshes made by tests of voxels and collision, and a plain OBJ reader for those of tests/meshes.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxel_grid.h"

namespace rivulet::test {

struct Mesh {
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;
    MeshView view() const { return {positions, indices, {}, {}}; }
    void triangle(const vec3& a, const vec3& b, const vec3& c) {
        for (const vec3& p : {a, b, c}) {
            indices.push_back(static_cast<uint32_t>(positions.size()));
            positions.push_back(p);
        }
    }
    void quad(const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
};

inline Mesh makeBox(const vec3& low, const vec3& high) {
    Mesh m;
    const auto corner = [&](int k) {
        return vec3((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z);
    };
    const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : faces) m.quad(corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3]));
    return m;
}

inline Mesh makeSphere(const vec3& centre, float radius, int rings = 24) {
    Mesh m;
    const auto at = [&](int ring, int side) {
        const float polar = kPi * static_cast<float>(ring) / static_cast<float>(rings);
        const float round = kPi * static_cast<float>(side % (2 * rings)) / static_cast<float>(rings);
        const float out = ring == 0 || ring == rings ? 0.0F : std::sin(polar);  // so that it closes to the last bit
        return centre + radius * vec3(out * std::cos(round), std::cos(polar), out * std::sin(round));
    };
    for (int r = 0; r < rings; ++r) {
        for (int s = 0; s < 2 * rings; ++s) {
            if (r > 0) m.triangle(at(r, s), at(r, s + 1), at(r + 1, s));
            if (r + 1 < rings) m.triangle(at(r, s + 1), at(r + 1, s + 1), at(r + 1, s));
        }
    }
    return m;
}

// A square of side `size` about `centre`, turned so that `normal` is its normal.
inline Mesh makeSheet(const vec3& centre, const vec3& normal, float size) {
    const vec3 n = glm::normalize(normal);
    const vec3 u = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0))) * (0.5F * size);
    const vec3 v = glm::cross(n, u);
    Mesh m;
    m.quad(centre - u - v, centre + u - v, centre + u + v, centre - u + v);
    return m;
}

// Triangles of every sort: ordinary, huge, tiny, needles, edge-on, without area.
inline Mesh makeJumble(unsigned seed, int count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    const auto point = [&] { return vec3(at(random), at(random), at(random)); };
    Mesh m;
    for (int k = 0; k < count; ++k) {
        const vec3 a = point(), b = point(), c = point();
        switch (k % 7) {
            case 0:
                m.triangle(a, b, c);
                break;
            case 1:
                m.triangle(a, a + 0.05F * b, a + 0.05F * c);
                break;  // tiny
            case 2:
                m.triangle(a, b, a + 1e-4F * c);
                break;  // needle
            case 3:
                m.triangle(a, vec3(b.x, b.y, a.z), vec3(c.x, c.y, a.z));
                break;  // edge-on to four faces
            case 4:
                m.triangle(a, b, 0.5F * (a + b));
                break;  // almost no area
            case 5:
                m.triangle(a, a, b);
                break;  // a segment
            default:
                m.triangle(a, a, a);
                break;  // a point
        }
    }
    return m;
}

inline CleanMesh cleaned(const Mesh& mesh) {
    const MeshView view = mesh.view();
    return cleanMesh(std::span(&view, 1));
}

// A grid with no voxel set.
inline VoxelGrid gridOf(const ivec3& size, const vec3& low, float voxel) {
    VoxelGrid grid;
    grid.size = size;
    grid.origin = low;
    grid.voxel = voxel;
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    return grid;
}

// `resolution` voxels along the mesh's longest side, its low corner `margin` voxels inside the grid.
inline VoxelGrid gridAround(const Mesh& mesh, int resolution, float margin = 0.0F) {
    Bounds bounds;
    for (uint32_t index : mesh.indices) bounds.add(mesh.positions[index]);
    const vec3 size = bounds.size();
    const float voxel = std::max({size.x, size.y, size.z}) / static_cast<float>(resolution);
    return gridOf(glm::max(ivec3(glm::ceil(size / voxel + 2.0F * margin)), ivec3(1)), bounds.min - margin * voxel, voxel);
}

inline std::filesystem::path testMesh(const std::string& name) { return std::filesystem::path(RIVULET_SOURCE_DIR) / "tests/meshes" / name; }
inline std::filesystem::path spotMesh() { return std::filesystem::path(RIVULET_SOURCE_DIR) / "assets/meshes/spot.obj"; }

// Every mesh of tests/meshes, and Spot.
inline std::vector<std::filesystem::path> testMeshes() {
    std::vector<std::filesystem::path> paths = {spotMesh()};
    for (const char* folder : {"generated", "classic"})
        for (const auto& entry : std::filesystem::directory_iterator(testMesh(folder)))
            if (entry.path().extension() == ".obj") paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
}

// `v` and `f` lines only; polygons as fans.
inline Mesh readObj(const std::filesystem::path& path) {
    Mesh m;
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            vec3 p;
            words >> p.x >> p.y >> p.z;
            m.positions.push_back(p);
        } else if (word == "f") {
            std::vector<uint32_t> corners;
            while (words >> word) {
                const long n = std::stol(word);
                corners.push_back(static_cast<uint32_t>(n > 0 ? n - 1 : static_cast<long>(m.positions.size()) + n));
            }
            for (size_t k = 2; k < corners.size(); ++k) {
                for (uint32_t c : {corners[0], corners[k - 1], corners[k]}) m.indices.push_back(c);
            }
        }
    }
    return m;
}

}  // namespace rivulet::test
