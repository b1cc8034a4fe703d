// The kernel collide on cl and gl agrees with the cpu for particles in flight, at walls and in corners; on no device is a particle in a set
// voxel.
#include <gtest/gtest.h>

#include "fluid/sim/solids/solids.h"
#include "fluid/voxel/voxel_field.h"
#include "tests/parity/devices.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::collide_parity_test {
namespace {

constexpr uint32_t kCount = 3000;
constexpr float kSpacing = 0.04F;

// A tilted room of sheets with a ball in it.
test::Mesh room() {
    const vec3 axis = glm::normalize(vec3(0.3F, 0.8F, 0.5F)), u = glm::normalize(glm::cross(axis, vec3(1, 0, 0)));
    test::Mesh mesh = test::makeBox(vec3(-0.5F), vec3(0.5F));
    const test::Mesh ball = test::makeSphere(vec3(0.1F, -0.2F, 0), 0.2F, 16);
    for (uint32_t i : ball.indices) mesh.indices.push_back(i + static_cast<uint32_t>(mesh.positions.size()));
    mesh.positions.insert(mesh.positions.end(), ball.positions.begin(), ball.positions.end());
    for (vec3& p : mesh.positions) p = mat3(u, glm::cross(axis, u), axis) * p;
    return mesh;
}

struct State {
    std::vector<vec4> position, velocity;
};

// A field on a device, and one call of the kernel.
struct Collider {
    Device& device;
    Kernel kernel;
    FieldParams params{};
    Buffer from, to, speed, cellStart, bits, distance, normal;

    Collider(Device& d, const VoxelField& field, FieldContact contact, Surface surface) : device(d) {
        const Result<Kernel> made = device.kernel("fluid/solids/collide");
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        if (made) kernel = *made;
        params = fieldParams(field, contact);
        const auto hold = [&]<class T>(Buffer& buffer, const std::vector<T>& items) {
            buffer = std::move(*device.allocate(items.size() * sizeof(T)));
            device.writeAll<T>(buffer, items);
        };
        hold(bits, field.surface.bits);
        hold(distance, field.distance);
        std::vector<uint32_t> normals = field.normal;
        for (uint32_t word : surfaceWords({}, surface)) normals.push_back(word);
        hold(normal, normals);
        hold(cellStart, std::vector<uint32_t>{kCount});
        for (Buffer* b : {&from, &to, &speed}) *b = std::move(*device.allocate(kCount * sizeof(vec4)));
    }
    State run(const std::vector<vec4>& previous, const State& moved) {
        device.writeAll<vec4>(from, previous);
        device.writeAll<vec4>(to, moved.position);
        device.writeAll<vec4>(speed, moved.velocity);
        device.run(kernel, params, {&from, &to, &speed, &cellStart, &bits, &distance, &normal}, kCount);
        return {device.readAll<vec4>(to, kCount), device.readAll<vec4>(speed, kCount)};
    }
};

State flown(const State& s, float dt) {
    State moved = s;
    for (size_t i = 0; i < s.position.size(); ++i) {
        moved.velocity[i] += vec4(0, -9.81F * dt, 0, 0);
        moved.position[i] += vec4(vec3(moved.velocity[i]) * dt, 0);
    }
    return moved;
}

class CollideParity : public ::testing::TestWithParam<const char*> {};

TEST_P(CollideParity, AgreesWithTheCpuAndNoParticleEntersAVoxel) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const std::unique_ptr<Device> cpu = makeTestCpu();
    const test::Mesh mesh = room();
    const MeshView view = mesh.view();
    const Result<VoxelField> baked = bakeVoxelField(std::span(&view, 1), {.resolution = 64});
    ASSERT_TRUE(baked) << baked.error().message;
    const VoxelField& field = *baked;
    const FieldContact contact{.spacing = kSpacing, .restSpeed = 0.05F};
    const Surface surface{0.2F, 0.3F};
    Collider here(*cpu, field, contact, surface), there(*gpu->device, field, contact, surface);

    State start;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    while (start.position.size() < kCount) {
        const vec3 p = 0.7F * vec3(at(random), at(random), at(random));
        if (field.clearance(p) < here.params.contact) continue;
        start.position.emplace_back(p, 0.5F);
        start.velocity.emplace_back(std::exp(2.5F * at(random)) * vec3(at(random), at(random), at(random)), 0.0F);
    }
    State onCpu = start, onGpu = start;
    size_t touched = 0, apart = 0;
    for (int step = 0; step < 120; ++step) {
        // One GPU run starts each step from the cpu's state, for comparison; another runs on its own, to test that no particle enters.
        const State moved = flown(onCpu, 0.006F);
        const State a = here.run(onCpu.position, moved), b = there.run(onCpu.position, moved);
        for (uint32_t i = 0; i < kCount; ++i) {
            touched += a.position[i] == moved.position[i] ? 0 : 1;
            apart += glm::length(vec3(a.position[i] - b.position[i])) > 1e-4F * field.surface.voxel + 1e-6F ||
                             glm::length(vec3(a.velocity[i] - b.velocity[i])) > 1e-4F * (1.0F + glm::length(vec3(moved.velocity[i])))
                         ? 1
                         : 0;
        }
        onCpu = a;
        const State gpuMoved = flown(onGpu, 0.006F);
        onGpu = there.run(onGpu.position, gpuMoved);
        for (const State* s : {&onCpu, &onGpu})
            for (const vec4& p : s->position) ASSERT_FALSE(field.surface.test(field.surface.cellOf(vec3(p)))) << "step " << step;
    }
    EXPECT_GT(touched, kCount * 10U);
    // Within rounding of a contact, two compilers may decide differently.
    EXPECT_LT(apart, touched / 200) << "of " << touched << " contacts";
}

INSTANTIATE_TEST_SUITE_P(Devices, CollideParity, ::testing::Values("cl", "gl"), [](const auto& p) { return std::string(p.param); });

}  // namespace
}  // namespace rivulet::collide_parity_test
