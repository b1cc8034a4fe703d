// A field that is baked beside the frames is the field that bakeVoxelField makes; it can be cancelled, and run by a host.
#include "fluid/voxel/field_bake.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::field_bake_test {
namespace {

std::vector<BakedMesh> meshes() {
    const test::Mesh a = test::makeSphere(vec3(0), 0.5F, 24), b = test::makeBox(vec3(0.2F), vec3(0.9F));
    return {{a.positions, a.indices, 3}, {b.positions, b.indices, 1}};
}

VoxelField expected(const VoxelFieldOptions& options) {
    const std::vector<BakedMesh> all = meshes();
    const uint8_t surfaces[] = {3, 1};
    const MeshView views[] = {{all[0].positions, all[0].indices, {}, {}}, {all[1].positions, all[1].indices, {}, {}}};
    VoxelFieldOptions o = options;
    o.surfaces = surfaces;
    Result<VoxelField> field = bakeVoxelField(views, o);
    EXPECT_TRUE(field);
    return std::move(*field);
}

void expectSame(const Result<VoxelField>& a, const VoxelField& b) {
    ASSERT_TRUE(a) << a.error().message;
    EXPECT_TRUE(a->surface.bits == b.surface.bits && a->distance == b.distance && a->normal == b.normal && a->closed == b.closed);
}

// A host that runs it when it is asked to.
struct Later {
    void (*function)(void*) = nullptr;
    void* argument = nullptr;
    static void start(void* self, void (*f)(void*), void* a) {
        static_cast<Later*>(self)->function = f;
        static_cast<Later*>(self)->argument = a;
    }
    Jobs jobs() {
        Jobs j;
        j.user = this;
        j.start = start;
        return j;
    }
};

TEST(FieldBake, IsTheFieldOfAnOrdinaryBake) {
    const VoxelFieldOptions options{.resolution = 40};
    FieldBake own(meshes(), options);
    Later host;
    FieldBake hosted(meshes(), options, host.jobs());
    EXPECT_FALSE(hosted.done()) << "the host has not run it yet";
    std::thread worker([&] { host.function(host.argument); });
    const VoxelField field = expected(options);
    expectSame(own.take(), field);
    expectSame(hosted.take(), field);
    EXPECT_TRUE(own.done() && hosted.done());
    worker.join();
}

TEST(FieldBake, ReportsWhatABakeReports) {
    FieldBake bad(meshes(), {.resolution = 1});
    const Result<VoxelField> field = bad.take();
    ASSERT_FALSE(field);
    EXPECT_NE(field.error().message.find("resolution"), std::string::npos);
}

// Destroyed before it was run: nothing of it runs afterwards.
TEST(FieldBake, EndsWhenItIsDestroyed) {
    Later host;
    auto bake = std::make_unique<FieldBake>(meshes(), VoxelFieldOptions{.resolution = 60}, host.jobs());
    std::thread worker([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        host.function(host.argument);
    });
    bake.reset();  // waits for the host to run it, which ends at once
    worker.join();
    for (int k = 0; k < 5; ++k) const FieldBake cancelled(meshes(), {.resolution = 60});
}

}  // namespace
}  // namespace rivulet::field_bake_test
