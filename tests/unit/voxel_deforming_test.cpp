// A field baked again in parts equals a complete bake, and its displacements are the motion of the mesh.
#include "fluid/voxel/deforming_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "engine/core/jobs.h"
#include "fluid/voxel/distance_band.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_deforming_test {
namespace {

using test::Mesh;
using Places = std::vector<vec3>;

// n x n quads over [-1, 1]^2 in x and z, vertices shared.
Mesh makeGrid(int n) {
    Mesh m;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i)
            m.positions.emplace_back(2.0F * static_cast<float>(i) / static_cast<float>(n) - 1.0F, 0.0F,
                                     2.0F * static_cast<float>(j) / static_cast<float>(n) - 1.0F);
    }
    const auto at = [&](int i, int j) { return static_cast<uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i)
            for (uint32_t k : {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)}) m.indices.push_back(k);
    }
    return m;
}

Places mapped(const Places& rest, const std::function<vec3(const vec3&)>& to) {
    Places out;
    for (const vec3& p : rest) out.push_back(to(p));
    return out;
}

constexpr float kReach = 1.6F;
const Bounds kBox{vec3(-kReach), vec3(kReach)};

DeformingField create(const Mesh& mesh, int resolution, const Bounds& reach = kBox) {
    const MeshView view = mesh.view();
    Result<DeformingField> field = DeformingField::create(std::span(&view, 1), reach, {.resolution = resolution});
    EXPECT_TRUE(field) << field.error().message;
    return std::move(*field);
}

// Updates, compares with a complete bake of the same places, and checks that the layers outside the reported ones are unchanged.
DeformingField::Change expectAsFresh(DeformingField& field, const Mesh& mesh, const Places& places, const char* name) {
    const VoxelField before = field.field();
    const std::vector<vec4> displacedBefore(field.displacement().begin(), field.displacement().end());
    const Result<DeformingField::Change> change = field.update(places);
    EXPECT_TRUE(change) << name;
    Mesh moved = mesh;
    moved.positions = places;
    const DeformingField fresh = create(moved, field.field().surface.size.x - 11);
    EXPECT_EQ(fresh.field().surface.size, field.field().surface.size) << name;
    EXPECT_TRUE(field.field().surface.bits == fresh.field().surface.bits) << name;
    EXPECT_TRUE(field.field().distance == fresh.field().distance) << name;
    EXPECT_TRUE(field.field().normal == fresh.field().normal) << name;
    const ivec3 size = before.surface.size;
    const size_t layer = static_cast<size_t>(size.x + 1) * static_cast<size_t>(size.y + 1);
    size_t astray = 0;
    for (size_t k = 0; k < before.distance.size(); ++k) {
        const auto z = static_cast<int>(k / layer);
        if (z >= change->firstLayer && z < change->endLayer) continue;
        astray += before.distance[k] != field.field().distance[k] || before.normal[k] != field.field().normal[k] ||
                          displacedBefore[k] != field.displacement()[k]
                      ? 1
                      : 0;
    }
    for (int z = 0; z < size.z; ++z) {
        if (z >= change->firstLayer && z < change->endLayer) continue;
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) astray += before.surface.test({x, y, z}) != field.field().surface.test({x, y, z}) ? 1 : 0;
        }
    }
    EXPECT_EQ(astray, 0U) << name << ": changed outside the layers reported";
    return *change;
}

// The voxels of the whole grid.
size_t allVoxels(const DeformingField& field) { return field.field().surface.count(); }

TEST(VoxelDeforming, EqualsACompleteBake) {
    const Mesh mesh = makeGrid(12);
    DeformingField field = create(mesh, 45);
    const auto wave = [](float phase) {
        return [phase](const vec3& p) { return p + vec3(0, 0.4F * std::sin(3.0F * p.x + phase), 0.1F * std::cos(phase + p.z)); };
    };
    expectAsFresh(field, mesh, mapped(mesh.positions, wave(0.3F)), "all vertices");
    expectAsFresh(field, mesh, mapped(mesh.positions, wave(1.9F)), "all vertices again, far");
    Places places = mapped(mesh.positions, wave(1.9F));
    const DeformingField::Change none = expectAsFresh(field, mesh, places, "none");
    EXPECT_EQ(none.voxels, 0U);
    const DeformingField::Change still = expectAsFresh(field, mesh, places, "none again");
    EXPECT_EQ(still.endLayer, 0) << "nothing to upload";
    places[20].y += 0.15F;
    const DeformingField::Change one = expectAsFresh(field, mesh, places, "one vertex");
    EXPECT_GT(one.voxels, 0U);
    EXPECT_LT(one.voxels, allVoxels(field) / 10);
    EXPECT_LT(one.endLayer - one.firstLayer, field.field().surface.size.z);
    places[20].y -= 0.3F;
    places[90] += vec3(0.1F, -0.7F, 0.2F);
    places[168] = vec3(1.6F, 1.6F, -1.6F);
    expectAsFresh(field, mesh, places, "three, far apart");
    expectAsFresh(field, mesh, mesh.positions, "back to rest");
}

TEST(VoxelDeforming, EqualsACompleteBakeForAnyTriangles) {
    const Mesh mesh = test::makeJumble(5, 70);
    DeformingField field = create(mesh, 33);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    Places places = mesh.positions;
    for (const size_t count : {1U, 3U, 210U, 9U, 40U, 200U, 2U}) {
        for (size_t k = 0; k < count; ++k) {
            const size_t v = count > 100 ? k : random() % places.size();
            places[v] = vec3(at(random), at(random), at(random)) * 1.5F;
        }
        expectAsFresh(field, mesh, places, "jumble");
    }
}

// If the reach equals the mesh's bounds, the grid and its content equal those of a static field.
TEST(VoxelDeforming, StartsAsTheStaticField) {
    const Mesh mesh = test::makeJumble(8, 70);
    Bounds bounds;
    for (uint32_t k : mesh.indices) bounds.add(mesh.positions[k]);
    const MeshView view = mesh.view();
    const uint8_t surface = 11;
    const VoxelFieldOptions options{.resolution = 30, .surfaces = std::span(&surface, 1)};
    const Result<VoxelField> fixed = bakeVoxelField(std::span(&view, 1), options);
    const Result<DeformingField> deforming = DeformingField::create(std::span(&view, 1), bounds, options);
    ASSERT_TRUE(fixed && deforming);
    EXPECT_EQ(fixed->surface.origin, deforming->field().surface.origin);
    EXPECT_EQ(fixed->surface.bits, deforming->field().surface.bits);
    EXPECT_EQ(fixed->distance, deforming->field().distance);
    EXPECT_EQ(fixed->normal, deforming->field().normal);
    for (const vec4& d : deforming->displacement()) ASSERT_EQ(d, vec4(0.0F));
}

TEST(VoxelDeforming, SameForAnyNumberOfThreads) {
    const Mesh mesh = makeGrid(16);
    const Places places = mapped(mesh.positions, [](const vec3& p) { return p + vec3(0, 0.3F * std::sin(4.0F * p.x * p.z), 0); });
    DeformingField many = create(mesh, 40);
    ASSERT_TRUE(many.update(places));
    const Workers one(1);
    const JobsScope scope(one.jobs());
    DeformingField alone = create(mesh, 40);
    ASSERT_TRUE(alone.update(places));
    EXPECT_TRUE(many.field().distance == alone.field().distance && many.field().normal == alone.field().normal);
    EXPECT_TRUE(std::equal(many.displacement().begin(), many.displacement().end(), alone.displacement().begin()));
}

// A sheet under linear maps: the nearest point is the foot of the perpendicular, and the inverse map gives its old place.
TEST(VoxelDeforming, DisplacementIsTheMotionOfTheNearestPoint) {
    const float c = std::cos(0.11F), s = std::sin(0.11F);
    const struct {
        const char* name;
        mat3 linear;
        vec3 shift;
    } motions[] = {{"translation", mat3(1.0F), vec3(0.05F, -0.12F, 0.03F)},
                   {"rotation about z", mat3(c, s, 0, -s, c, 0, 0, 0, 1), vec3(0)},
                   {"rotation about y", mat3(c, 0, -s, 0, 1, 0, s, 0, c), vec3(0.02F, 0, 0)},
                   {"shear in its plane", mat3(1, 0, 0, 0, 1, 0, 0.2F, 0, 1), vec3(0)},
                   {"shear out of it", mat3(1, 0.3F, 0, 0, 1, 0, 0, 0, 1), vec3(0, 0.1F, 0)}};
    const Mesh mesh = makeGrid(9);
    for (const auto& motion : motions) {
        DeformingField field = create(mesh, 50);
        const Places places = mapped(mesh.positions, [&](const vec3& p) { return motion.linear * p + motion.shift; });
        ASSERT_TRUE(field.update(places));
        const VoxelGrid& grid = field.field().surface;
        const vec3 u = motion.linear * vec3(1, 0, 0), v = motion.linear * vec3(0, 0, 1);
        const vec3 n = glm::normalize(glm::cross(v, u));
        const mat3 inverse = glm::inverse(motion.linear);
        size_t checked = 0, k = 0;
        float worst = 0, most = 0;
        for (int z = 0; z <= grid.size.z; ++z) {
            for (int y = 0; y <= grid.size.y; ++y) {
                for (int x = 0; x <= grid.size.x; ++x, ++k) {
                    const vec4 got = field.displacement()[k];
                    if (!(field.field().distance[k] < field.field().band)) {
                        ASSERT_EQ(got, vec4(0.0F)) << motion.name << ": beyond the band";
                        continue;
                    }
                    const vec3 p = grid.origin + grid.voxel * vec3(x, y, z);
                    const vec3 foot = p - n * glm::dot(n, p - motion.shift);
                    const vec3 rest = inverse * (foot - motion.shift);
                    if (std::abs(rest.x) > 1.0F || std::abs(rest.z) > 1.0F) continue;
                    worst = std::max(worst, glm::length(vec3(got) - (foot - rest)));
                    most = std::max(most, glm::length(vec3(got)));
                    ++checked;
                }
            }
        }
        EXPECT_GT(checked, 5000U) << motion.name;
        EXPECT_GT(most, 0.05F) << motion.name;
        EXPECT_LT(worst, 2e-6F) << motion.name;
        // A second update with the same places: no motion.
        ASSERT_TRUE(field.update(places));
        for (const vec4& d : field.displacement()) ASSERT_EQ(d, vec4(0.0F)) << motion.name;
    }
}

// One vertex is lifted: points nearest to the other vertices have no displacement, points nearest to the tip move with it.
TEST(VoxelDeforming, DisplacementOfATent) {
    const Mesh mesh = makeGrid(6);
    DeformingField field = create(mesh, 64);
    const size_t tip = 3 * 7 + 3;
    Places places = mesh.positions;
    const vec3 lift(0.02F, 0.2F, -0.01F);
    places[tip] += lift;
    ASSERT_TRUE(field.update(places));
    const VoxelGrid& grid = field.field().surface;
    const auto at = [&](const vec3& p) {
        const ivec3 c(glm::round((p - grid.origin) / grid.voxel));
        return field.displacement()[(static_cast<size_t>(c.z) * static_cast<size_t>(grid.size.y + 1) + static_cast<size_t>(c.y)) *
                                        static_cast<size_t>(grid.size.x + 1) +
                                    static_cast<size_t>(c.x)];
    };
    EXPECT_LT(glm::length(vec3(at(places[tip] + vec3(0, 2.0F * grid.voxel, 0))) - lift), 1e-6F) << "above the tip only the tip is near";
    EXPECT_EQ(at(vec3(-0.8F, 0.05F, 0.8F)), vec4(0.0F)) << "far from the moved vertex";
    // On a tent's side the displacement decreases linearly from tip to rim: halfway up the middle edge it is half.
    const vec3 half = 0.5F * (places[tip] + places[tip + 7]);
    EXPECT_NEAR(glm::length(vec3(at(half))) / glm::length(lift), 0.5F, 0.15F);
}

void expectSays(const std::string& message, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' is missing in: " << message;
}

TEST(VoxelDeforming, BadInputIsNamed) {
    const Mesh mesh = makeGrid(3);
    const MeshView views[] = {mesh.view(), mesh.view()};
    const auto errorOf = [&](size_t meshes, const Bounds& reach, const VoxelFieldOptions& options) {
        const Result<DeformingField> field = DeformingField::create(std::span(views, meshes), reach, options);
        return field ? std::string("no error") : field.error().message;
    };
    expectSays(errorOf(2, kBox, {}), {"one mesh", "2"});
    expectSays(errorOf(0, kBox, {}), {"one mesh"});
    expectSays(errorOf(1, Bounds{}, {}), {"reach"});
    expectSays(errorOf(1, {vec3(-0.5F), vec3(0.5F)}, {}), {"Vertex 0", "(-1, 0, -1)", "(0.5, 0.5, 0.5)", "widen"});
    expectSays(errorOf(1, kBox, {.resolution = 0}), {"2..2048"});
    expectSays(errorOf(1, kBox, {.resolution = 400}), {"GB", "a resolution of"});

    DeformingField field = create(mesh, 20);
    const std::vector<float> before = field.field().distance;
    Places places = mesh.positions;
    places.pop_back();
    Result<DeformingField::Change> change = field.update(places);
    ASSERT_FALSE(change);
    expectSays(change.error().message, {"16 vertices", "15 places"});
    places = mesh.positions;
    places[7].y = 1.7F;
    change = field.update(places);
    ASSERT_FALSE(change);
    expectSays(change.error().message, {"Vertex 7", "1.7"});
    places[7].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(field.update(places));
    EXPECT_EQ(field.field().distance, before) << "an update that failed changes nothing";
}

}  // namespace
}  // namespace rivulet::voxel_deforming_test
