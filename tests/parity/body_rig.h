// BodyRig: bodies in contact on a GPU that is two frames behind.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fluid/scene/solids_bullet.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "shaders/fluid/solids/body_state.h"
#include "tests/parity/devices.h"
#include "tests/parity/late_device.h"

namespace rivulet::body_rig {

constexpr double kFrame = 1.0 / 60;  // s
constexpr double kGravity = 9.81;
constexpr float kTurn = 3.14159265F / 180;  // a degree

// Bodies with what they touch. The water, of which there is a drop in a corner, passes through them.
struct Scenario {
    std::vector<Body> bodies;
    std::vector<BodyForm> forms;
    std::vector<PlaneSolid> planes;
    std::vector<MeshView> still, moving;
    std::vector<Pose> poses;
    vec3 gravity{0, -static_cast<float>(kGravity), 0};
    float step = 1.0F / 240;  // s; 0: as long as the water allows
    uint32_t poison = 0;      // of LateDevice
    void add(const Body& body, const BodyForm& form) {
        bodies.push_back(body);
        bodies.back().meetsWater = false;
        forms.push_back(form);
    }
    void addBox(const vec3& size, const vec3& at, float friction, const quat& turned = quat(1, 0, 0, 0)) {
        Body body;
        body.shape = boxShape(size, 500, 0.05F);
        body.state.pose = {at, turned};
        BodyForm form;
        form.size = size;
        form.friction = friction;
        form.restitution = 0;
        add(body, form);
    }
    void addBall(float radius, const vec3& at, const vec3& velocity, float friction, float restitution) {
        Body body;
        body.shape = sphereShape(radius, 500, 0.05F);
        body.state.pose.position = at;
        body.state.velocity = velocity;
        BodyForm form;
        form.kind = BodyForm::Kind::sphere;
        form.radius = radius;
        form.friction = friction;
        form.restitution = restitution;
        add(body, form);
    }
};

// Their world.
inline FluidParams paramsOf(const Scenario& setup) {
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.05F;
    p.box.min = vec3(-3, 0, -3);
    p.box.max = vec3(3, 4, 3);
    p.blocks = {{vec3(2.9F, 0, 2.9F), vec3(3, 0.1F, 3), vec3(0.0F)}};
    p.gravity = setup.gravity;
    p.fixedStep = setup.step;
    p.maxBodySamples = 1;
    return p;
}

class Rig {
  public:
    Rig(const char* device, const Scenario& setup) : setup_(setup) {
        Result<TestGpu> gpu = makeTestGpu(device);
        if (!gpu) {
            absent = gpu.error().message;
            return;
        }
        gpu_ = std::move(*gpu);
        late = std::make_unique<LateDevice>(*gpu_.device, setup.bodies.size());
        late->poison = setup.poison;
        const FluidParams p = paramsOf(setup);
        contacts = std::make_unique<BulletSolids>(
            BulletSolids::Scene{
                .box = p.box, .planes = setup_.planes, .still = setup_.still, .moving = setup_.moving, .poses = setup_.poses},
            setup_.bodies, setup_.forms);
        auto made = FluidWorld::create(*late, p, {.bodies = setup_.bodies, .bodyHost = contacts->host()}, {});
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        if (made) world = std::move(*made);
    }
    ~Rig() {
        if (!late || !world || mayWait) return;
        EXPECT_EQ(world->stats().bodyWaits, 0U);
        EXPECT_EQ(late->reads, 0U) << "nothing waits";
    }
    Rig(const Rig&) = delete;
    Rig& operator=(const Rig&) = delete;
    void frame(double seconds = kFrame) {
        world->step({.gravity = setup_.gravity}, seconds);
        late->frameEnds();
    }
    // Of the last frame.
    const DeviceBody& row(size_t body = 0) const { return late->rows.back()[body]; }
    dvec3 place(size_t body = 0) const { return dvec3(vec3(row(body).position)); }
    dvec3 velocity(size_t body = 0) const { return dvec3(vec3(row(body).velocity)); }
    // rad, from where it began.
    double turned(size_t body = 0) const {
        const vec4& q = row(body).rotation;
        return 2 * std::acos(std::min(1.0F, std::abs(glm::dot(quat(q.w, q.x, q.y, q.z), setup_.bodies[body].state.pose.rotation))));
    }
    std::string absent;
    bool mayWait = false;  // else a wait fails the test

  private:
    Scenario setup_;
    TestGpu gpu_;

  public:
    std::unique_ptr<LateDevice> late;
    std::unique_ptr<BulletSolids> contacts;
    std::unique_ptr<FluidWorld> world;
};

}  // namespace rivulet::body_rig
