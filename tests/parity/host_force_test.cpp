// A force that the host registers without a fork of Rivulet, on cpu, cl and gl: the motion equals the analytical solution.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "engine/app/context_egl.h"
#include "engine/core/json.h"
#include "engine/gpu/device_gl.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"
#include "tests/parity/host_force_kernels.h"

namespace rivulet::host_force_test {
namespace {

// The host's part: its Params and four functions.
struct Swirl {
    vec3 push{0.0F}, axis{0.0F};
    float turn = 0;
    bool on = true;
    void visit(ParamVisitor& v) {
        v.value({"push", "m/s^2", "for all", -100, 100}, push);
        v.value({"turn", "1/s^2", "about the axis", -100, 100}, turn);
    }

    static Result<ForcePass> make(void* self, Device& device, const MethodSetup&) {
        Result<Kernel> kernel = device.kernel("host/host_swirl");
        if (!kernel) return kernel.error();
        Result<Buffer> made = device.allocate(sizeof(vec4));
        if (!made) return made.error();
        auto swirl = std::make_shared<Buffer>(std::move(*made));
        return ForcePass([own = static_cast<const Swirl*>(self), kernel = *kernel, swirl](StepContext& c) {
            const vec4 about(own->axis, own->turn);
            c.device.write(*swirl, std::as_bytes(std::span(&about, 1)));
            StepParams p = c.params;
            p.force = vec4(own->push, 0.0F);
            c.device.run(kernel, p, {&c.grid.cellStart(), &c.particles.position, swirl.get(), &c.particles.acceleration},
                         c.particles.count);
        });
    }
    HostForce row() {
        return {.name = "swirl",
                .doc = "a push and a swirl",
                .self = this,
                .on = [](void* self, const FluidParams&) { return static_cast<Swirl*>(self)->on; },
                .make = make,
                .fastest = [](void*) { return 5.0F; },
                .visit = [](void* self, ParamVisitor& v) { static_cast<Swirl*>(self)->visit(v); }};
    }
};

Result<TestGpu> makeDevice(const std::string& name) {
    TestGpu made;
    if (name == "cpu") {
        std::vector<CpuKernelRow> rows = cpuKernels();
        rows.push_back(hostSwirl());
        made.device = makeCpuDevice(rows);
        return made;
    }
    std::ifstream file(RIVULET_SOURCE_DIR "/tests/parity/host_swirl.kernel", std::ios::binary);
    ShaderFiles files = ShaderFiles::developer();
    files.add("shaders/host/host_swirl.kernel", std::string(std::istreambuf_iterator<char>(file), {}));
    Result<TestGpu> there = makeTestGpu(name);  // the device, if there is one, and its context
    if (!there) return there;
    made.context = there->context;
    if (name == "gl") {
        made.device = makeGlDevice(files);
        return made;
    }
    Result<std::unique_ptr<Device>> cl = makeClDevice(files);
    if (!cl) return cl.error();
    made.device = std::move(*cl);
    return made;
}

FluidParams weightless() {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.04F;
    p.gravity = vec3(0.0F);
    p.box.max = vec3(2.0F);
    p.blocks = {{vec3(0.8F), vec3(1.2F), vec3(0.1F, 0.0F, 0.0F)}};
    return p;
}

class HostForces : public testing::TestWithParam<const char*> {};

// A block in free fall under the host's own gravity: each particle follows Galileo's law, within the error of the time integration.
TEST_P(HostForces, ABlockFallsWithTheHostsAcceleration) {
    Result<TestGpu> there = makeDevice(GetParam());
    if (!there) GTEST_SKIP() << there.error().message;
    Swirl swirl;
    swirl.push = vec3(0.5F, -3.0F, 0.0F);
    const FluidParams p = weightless();
    const HostForce row = swirl.row();
    auto made = FluidWorld::create(*there->device, p, {}, {}, {}, std::span(&row, 1));
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    const std::vector<vec3> before = positions(world);
    dvec3 middle(0.0);
    for (const vec3& x : before) middle += dvec3(x) / static_cast<double>(before.size());
    for (int k = 0; k < 24; ++k) world.step({.gravity = p.gravity}, 1.0 / 60);
    there->device->finish();
    there->device->poll();
    const double t = 0.4, dt = world.stats().dtMax;
    dvec3 now(0.0);
    for (const vec3& x : positions(world)) now += dvec3(x) / static_cast<double>(before.size());
    const dvec3 a(swirl.push), expected = middle + dvec3(0.1, 0, 0) * t + 0.5 * a * t * t;
    // Symplectic Euler is a t dt / 2 ahead.
    EXPECT_LT(glm::length(now - expected), 0.5 * glm::length(a) * t * dt * 1.1 + 1e-4);
    EXPECT_GT(glm::length(now - middle), 0.2);
    EXPECT_EQ(world.stats().speedLimited, 0U);

    // Without the force it continues in a straight line.
    swirl.on = false;
    const dvec3 v = dvec3(0.1, 0, 0) + a * t;
    world.step({.gravity = p.gravity}, 1.0 / 60);
    dvec3 then(0.0);
    for (const vec3& x : positions(world)) then += dvec3(x) / static_cast<double>(before.size());
    EXPECT_LT(glm::length(then - now - v / 60.0), 1e-4);
}

// Torque about an axis: a body of water begins to rotate as a whole, equally on every device.
TEST_P(HostForces, ASwirlTurnsWaterAboutItsAxis) {
    Result<TestGpu> there = makeDevice(GetParam());
    if (!there) GTEST_SKIP() << there.error().message;
    Swirl swirl;
    swirl.axis = vec3(1.0F);
    swirl.turn = 4.0F;
    FluidParams p = weightless();
    p.blocks[0].velocity = vec3(0.0F);
    const HostForce row = swirl.row();
    auto made = FluidWorld::create(*there->device, p, {}, {}, {}, std::span(&row, 1));
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    for (int k = 0; k < 6; ++k) world.step({.gravity = p.gravity}, 1.0 / 60);
    const ParticleView view = world.particles();
    const std::vector<vec4> x = there->device->readAll<vec4>(*view.position, view.count),
                            v = there->device->readAll<vec4>(*view.velocity, view.count);
    dvec3 spin(0.0);
    double inertia = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        const dvec3 d = dvec3(x[i]) - dvec3(1.0);
        spin += glm::cross(d, dvec3(v[i]));
        inertia += d.x * d.x + d.z * d.z;
    }
    // dL/dt = turn * inertia, which is nearly constant in this time.
    EXPECT_NEAR(spin.y / inertia, 4.0 * 0.1, 0.02 * 0.4);
    EXPECT_LT(std::abs(spin.x) + std::abs(spin.z), 1e-3 * spin.y);
}

INSTANTIATE_TEST_SUITE_P(Devices, HostForces, testing::Values("cpu", "cl", "gl"), [](const auto& row) { return std::string(row.param); });

TEST(HostForceRows, ParamsAreVisibleAndNamesUnique) {
    Result<TestGpu> there = makeDevice("cpu");
    ASSERT_TRUE(there);
    Swirl swirl;
    const HostForce rows[] = {swirl.row(), swirl.row()};
    const FluidParams p = weightless();
    const auto twice = FluidWorld::create(*there->device, p, {}, {}, {}, rows);
    ASSERT_FALSE(twice);
    EXPECT_NE(twice.error().message.find("two forces 'swirl'"), std::string::npos);
    HostForce taken = swirl.row();
    taken.name = "air";
    EXPECT_FALSE(FluidWorld::create(*there->device, p, {}, {}, {}, std::span(&taken, 1)));
    HostForce empty = swirl.row();
    empty.make = nullptr;
    EXPECT_FALSE(FluidWorld::create(*there->device, p, {}, {}, {}, std::span(&empty, 1)));
    auto world = FluidWorld::create(*there->device, p, {}, {}, {}, std::span(rows, 1));
    ASSERT_TRUE(world);
    const VisitFn visit = [&](ParamVisitor& v) { (*world)->visitForces(v); };
    EXPECT_NE(writeJson(visit).find("\"turn\""), std::string::npos);
    ASSERT_TRUE(setParam("swirl.turn=2.5", visit));
    EXPECT_EQ(swirl.turn, 2.5F);
    // A kernel that the device lacks is reported, and the world runs without the force.
    const std::vector<CpuKernelRow> known = cpuKernels();
    auto plain = makeCpuDevice(known);
    auto without = FluidWorld::create(*plain, p, {}, {}, {}, std::span(rows, 1));
    ASSERT_TRUE(without);
    (*without)->step({.gravity = p.gravity}, 1.0 / 60);
    ASSERT_FALSE((*without)->stats().limited.empty());
    EXPECT_NE((*without)->stats().limited[0].find("host/host_swirl"), std::string::npos);
}

}  // namespace
}  // namespace rivulet::host_force_test
