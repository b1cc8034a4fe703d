// The one entry to the three modes: its grid, the common results of its modes, and errors for bad input.
#include "fluid/voxel/voxelize.h"

#include <gtest/gtest.h>

#include "engine/compute/device_cpu.h"
#include "fluid/voxel/voxelize_surface.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_voxelize_test {
namespace {

using test::Mesh;

constexpr VoxelMode kAllModes[] = {VoxelMode::depth, VoxelMode::solid, VoxelMode::surface};

Result<VoxelModel> voxelize(const Mesh& mesh, const VoxelizeOptions& options) {
    const auto cpu = makeCpuDevice({}, {});
    const MeshView view = mesh.view();
    return voxelizeMesh(*cpu, std::span(&view, 1), options);
}

VoxelizeOptions optionsOf(VoxelMode mode, int resolution) {
    VoxelizeOptions options;
    options.mode = mode;
    options.resolution = resolution;
    return options;
}

VoxelGrid layout(const Mesh& mesh, int resolution) {
    const MeshView view = mesh.view();
    Result<VoxelGrid> grid = layoutGrid(std::span(&view, 1), resolution, size_t{1} << 34U);
    EXPECT_TRUE(grid) << grid.error().message;
    return grid ? std::move(*grid) : VoxelGrid{};
}

TEST(VoxelLayout, ContainsEveryVertexAndIsAsSmallAsPossible) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (int k = 0; k < 3000; ++k) {
        const float scale = std::pow(10.0F, 8.0F * unit(random) - 4.0F);
        const vec3 aside = 100.0F * scale * (vec3(unit(random), unit(random), unit(random)) - 0.5F);
        const vec3 shape(1.0F, k % 3 == 0 ? 1.0F : unit(random), k % 2 == 0 ? 0.0F : unit(random));
        Mesh mesh;
        for (int t = 0; t < 3; ++t) {
            const auto corner = [&] { return aside + scale * shape * vec3(unit(random), unit(random), unit(random)); };
            mesh.triangle(corner(), corner(), corner());
        }
        if (k % 5 == 0) mesh = test::makeBox(aside, aside + scale * (k % 10 == 0 ? vec3(1) : shape));  // no room to spare on several sides
        mesh.positions.push_back(aside + 5.0F * scale);                                                // of no triangle
        const int resolution = 2 + static_cast<int>(500.0F * unit(random) * unit(random));
        const VoxelGrid grid = layout(mesh, resolution);
        ASSERT_EQ(std::max(grid.size.x, std::max(grid.size.y, grid.size.z)), resolution);
        dvec3 low(1e30), high(-1e30);
        for (uint32_t index : mesh.indices) {
            const dvec3 p = (dvec3(mesh.positions[index]) - dvec3(grid.origin)) / static_cast<double>(grid.voxel);
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        const double rounding = 3e-5 * resolution;  // voxels, of a float 100 sizes from the origin
        for (int a = 0; a < 3; ++a) {
            ASSERT_GE(low[a], 0.0) << k;
            ASSERT_LE(high[a], grid.size[a]) << k;
            ASSERT_LE(grid.size[a], std::max(1.0, high[a] - low[a] + 1.0 + rounding)) << k << ": fewer voxels suffice";
            ASSERT_NEAR(low[a], grid.size[a] - high[a], rounding) << k << ": the mesh is in the middle";
        }
        ASSERT_EQ(grid.bits.size(), (grid.count() + 31) / 32 * 4);
    }
}

// Faces on the grid's border and between voxels: a unit cube at 8 sets the outer layer, in each mode.
TEST(VoxelLayout, FacesOnTheBorderSetTheVoxelsWithin) {
    const Mesh cube = test::makeBox(vec3(0), vec3(1));
    for (VoxelMode mode : kAllModes) {
        const Result<VoxelModel> made = voxelize(cube, optionsOf(mode, 8));
        ASSERT_TRUE(made);
        EXPECT_EQ(made->surface.size, ivec3(8));
        EXPECT_EQ(made->surface.voxel, 0.125F);
        EXPECT_EQ(made->surface.origin, vec3(0));
        EXPECT_EQ(made->labels.surface, 512U - 216U);
        ASSERT_EQ(made->labels.materials.size(), 1U);
        EXPECT_EQ(made->labels.materials[0].voxels, 216U);
        EXPECT_DOUBLE_EQ(made->labels.materials[0].volume, 216.0 / 512.0);
        EXPECT_TRUE(made->defects.watertight);
    }
}

size_t ones(const VoxelGrid& grid) {
    size_t n = 0;
    for (uint8_t byte : grid.bits)
        for (; byte != 0; byte = static_cast<uint8_t>(byte & (byte - 1))) ++n;
    return n;
}

TEST(VoxelizeMesh, ModesAgreeOnCommonResults) {
    ASSERT_EQ(voxelModes().names(), (std::vector<std::string>{"depth", "solid", "surface"}));
    for (const VoxelModeRow& row : voxelModes().rows) EXPECT_EQ(voxelModes().find(row.name)->mode, row.mode);
    Mesh mesh = test::makeSphere(vec3(1, 2, 3), 0.5F);
    const Mesh inner = test::makeSphere(vec3(1, 2, 3), 0.3F);
    const auto base = static_cast<uint32_t>(mesh.positions.size());
    for (size_t k = 0; k < inner.indices.size(); k += 3) {  // reversed: the wall of a cavity
        for (size_t corner : {k, k + 2, k + 1}) mesh.indices.push_back(base + inner.indices[corner]);
    }
    mesh.positions.insert(mesh.positions.end(), inner.positions.begin(), inner.positions.end());
    std::vector<VoxelModel> models;
    for (VoxelMode mode : kAllModes) {
        Result<VoxelModel> made = voxelize(mesh, optionsOf(mode, 50));
        ASSERT_TRUE(made) << made.error().message;
        EXPECT_EQ(made->mode, mode);
        EXPECT_GT(made->milliseconds, 0.0);
        ASSERT_EQ(made->labels.materials.size(), 2U);
        EXPECT_EQ(made->labels.surface, ones(made->surface));
        EXPECT_EQ(ones(made->bits), mode == VoxelMode::surface ? ones(made->surface) : made->surface.count() - made->labels.outside);
        models.push_back(std::move(*made));
    }
    const VoxelModel &depth = models[0], &solid = models[1], &surface = models[2];
    EXPECT_EQ(solid.surface.bits, surface.surface.bits);
    VoxelGrid own = layout(mesh, 50);
    const MeshView view = mesh.view();
    voxelizeSurface(GridTriangles(std::span(&view, 1), own), own);
    EXPECT_EQ(surface.surface.bits, own.bits);
    for (size_t k = 0; k < own.bits.size(); ++k) ASSERT_EQ(depth.surface.bits[k] & ~own.bits[k], 0);
    EXPECT_LT(ones(depth.surface), ones(surface.surface));
    EXPECT_TRUE(solid.labels.materials[0].solid);
    EXPECT_FALSE(solid.labels.materials[1].solid) << "the cavity";
    const auto ball = [](double r) { return 4.0 / 3.0 * 3.14159265 * r * r * r; };
    EXPECT_NEAR(solid.labels.materials[1].volume, ball(0.3), 0.2 * ball(0.3));
}

// By connectivity the inside of an open cup is outside; by winding number too, but its wall is solid.
TEST(VoxelizeMesh, OpenMeshesAreInsideByWindingOnly) {
    Mesh bowl = test::makeBox(vec3(0), vec3(1));
    bowl.indices.erase(bowl.indices.begin() + 18, bowl.indices.begin() + 24);  // no lid
    const Result<VoxelModel> depth = voxelize(bowl, optionsOf(VoxelMode::depth, 20)),
                             solid = voxelize(bowl, optionsOf(VoxelMode::solid, 20));
    ASSERT_TRUE(depth && solid);
    EXPECT_TRUE(depth->labels.materials.empty());
    ASSERT_FALSE(solid->labels.materials.empty());
    EXPECT_GT(solid->labels.materials[0].volume, 0.5);
    EXPECT_EQ(solid->defects.boundaryEdges, 4U);
    EXPECT_EQ(depth->defects.boundaryEdges, 4U);
}

std::string errorOf(const Mesh& mesh, const VoxelizeOptions& options = {}, Fault fault = Fault::badInput) {
    const Result<VoxelModel> made = voxelize(mesh, options);
    if (made) return "no error";
    EXPECT_EQ(made.error().fault, fault) << made.error().message;
    return made.error().message;
}

void expectSays(const std::string& message, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' is missing in: " << message;
}

TEST(VoxelizeMesh, BadInputIsNamed) {
    const Mesh good = test::makeBox(vec3(0), vec3(1));
    for (VoxelMode mode : kAllModes) {
        VoxelizeOptions options = optionsOf(mode, 16);
        expectSays(errorOf(Mesh{}, options), {"no triangle"});
        Mesh bad = good;
        bad.indices[4] = 4711;
        expectSays(errorOf(bad, options), {"4711", "36 vertices", "triangle 1"});
        bad = good;
        bad.positions[3].x = std::numeric_limits<float>::quiet_NaN();
        expectSays(errorOf(bad, options), {"1 of 36 vertices", "NaN or infinite"});
        bad = good;
        for (vec3& p : bad.positions) p = vec3(1, 2, 3);
        expectSays(errorOf(bad, options), {"no extent"});
        bad = good;
        for (vec3& p : bad.positions) p += vec3(1e6F, 0, 0);
        expectSays(errorOf(bad, options), {"origin"});
        for (int resolution : {-1, 0, 1}) {
            options.resolution = resolution;
            expectSays(errorOf(good, options), {"2..4096", std::to_string(resolution).c_str()});
        }
        options.resolution = 5000;
        const std::string tooMany = errorOf(good, options);
        expectSays(tooMany, {"2..4096", "5000", "would need", "GB", "a resolution of"});
        // Two grids of bits at least; mode depth needs five more bytes per voxel.
        const double gigabytes = std::stod(tooMany.substr(tooMany.find("would need ") + 11)), voxels = 5000.0 * 5000.0 * 5000.0 / 1e9;
        EXPECT_GE(gigabytes, voxels * (2.0 / 8.0 + (mode == VoxelMode::depth ? 5.0 : 0.0)));
        EXPECT_LE(gigabytes, 1.1 * voxels * (3.0 / 8.0 + (mode == VoxelMode::depth ? 5.0 : 0.0)));

        options.resolution = 100;
        options.memoryLimit = 1 << 19U;
        const std::string message = errorOf(good, options);
        if (mode == VoxelMode::depth) {
            expectSays(message, {"needs", "no resolution fits"});  // its images alone
            continue;
        }
        expectSays(message, {"of 100 needs", "0.5 MB allowed"});
        options.resolution = std::stoi(message.substr(message.rfind("resolution of ") + 14));
        EXPECT_EQ(errorOf(good, options), "no error") << "the reported resolution must fit";
        ++options.resolution;
        expectSays(errorOf(good, options), {"allowed"});
    }
    const auto cpu = makeCpuDevice({}, {});
    EXPECT_FALSE(voxelizeMesh(*cpu, {}, {}));
}

TEST(VoxelizeMesh, OneTriangleIsEnough) {
    Mesh one;
    one.triangle(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0));
    for (VoxelMode mode : kAllModes) {
        const Result<VoxelModel> made = voxelize(one, optionsOf(mode, 10));
        ASSERT_TRUE(made) << made.error().message;
        EXPECT_EQ(made->surface.size, ivec3(10, 10, 1));
        EXPECT_GE(made->labels.surface, 45U);
        EXPECT_LE(made->labels.surface, 65U);
        EXPECT_TRUE(made->labels.materials.empty());
    }
}

TEST(VoxelizeMesh, CanBeCancelledAtAnyTime) {
    const Mesh mesh = test::makeSphere(vec3(0), 1.0F);
    for (VoxelMode mode : kAllModes) {
        VoxelizeOptions options = optionsOf(mode, 24);
        options.thesisOrder = true;
        int calls = 0;
        double last = 0;
        options.progress = [&](double done) {
            EXPECT_GE(done, last);
            EXPECT_LE(done, 1.0);
            last = done;
            ++calls;
            return true;
        };
        ASSERT_TRUE(voxelize(mesh, options));
        EXPECT_EQ(last, 1.0);
        const int all = calls;
        EXPECT_GE(all, 4);
        for (int stop = 1; stop <= all; ++stop) {
            calls = 0;
            options.progress = [&](double) { return ++calls < stop; };
            expectSays(errorOf(mesh, options, Fault::failed), {"cancelled"});
            EXPECT_EQ(calls, stop) << "it stops at once";
        }
    }
}

TEST(VoxelizeMesh, LostFeaturesAreReported) {
    const auto sentence = [](const Mesh& mesh, int resolution) {
        const MeshView view = mesh.view();
        return lostFeatures(std::span(&view, 1), layout(mesh, resolution));
    };
    Mesh plain = test::makeBox(vec3(-5e5F), vec3(5e5F));
    EXPECT_EQ(sentence(plain, 256), "");
    const Mesh small = test::makeBox(vec3(0), vec3(1e-3F));
    for (uint32_t k : small.indices) plain.indices.push_back(k + 36);
    plain.positions.insert(plain.positions.end(), small.positions.begin(), small.positions.end());
    expectSays(sentence(plain, 256), {"1e+06 wide", "features of 0.001:", "a voxel of 3906", "a resolution of 2e+09", "over 1000 TB"});
    VoxelizeOptions options = optionsOf(VoxelMode::surface, 64);
    EXPECT_EQ(errorOf(plain, options), "no error") << "it is voxelised nevertheless";
    EXPECT_EQ(sentence(test::makeSphere(vec3(0), 1.0F, 200), 64), "") << "a smooth mesh loses nothing";
}

// Ten million triangles: a wavy sheet.
TEST(VoxelizeMesh, TakesTenMillionTriangles) {
    constexpr uint32_t kSide = 2237;
    Mesh mesh;
    mesh.positions.reserve(size_t{kSide} * kSide);
    mesh.indices.reserve(size_t{6} * (kSide - 1) * (kSide - 1));
    for (uint32_t z = 0; z < kSide; ++z) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const auto fx = static_cast<float>(x), fz = static_cast<float>(z);
            mesh.positions.emplace_back(fx, 100.0F * std::sin(0.01F * fx) * std::cos(0.01F * fz), fz);
            if (x == 0 || z == 0) continue;
            const uint32_t here = z * kSide + x;
            for (uint32_t k : {here, here - 1, here - kSide, here - 1, here - kSide - 1, here - kSide}) mesh.indices.push_back(k);
        }
    }
    ASSERT_GE(mesh.indices.size(), 30'000'000U - 60'000U);
    const Result<VoxelModel> made = voxelize(mesh, optionsOf(VoxelMode::depth, 64));
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(made->defects.triangles, mesh.indices.size() / 3);
    EXPECT_GE(made->labels.surface, 64U * 64U);
    const MeshView view = mesh.view();
    VoxelGrid grid = layout(mesh, 64);
    voxelizeSurface(GridTriangles(std::span(&view, 1), grid), grid);
    for (size_t k = 0; k < grid.bits.size(); ++k) ASSERT_EQ(made->surface.bits[k] & ~grid.bits[k], 0);
}

}  // namespace
}  // namespace rivulet::voxel_voxelize_test
