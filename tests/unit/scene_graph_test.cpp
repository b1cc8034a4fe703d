// Transforms, cameras and the scene graph against exact geometry.
#include <gtest/gtest.h>

#include "engine/scene/camera.h"
#include "engine/scene/light.h"
#include "engine/scene/scene.h"
#include "engine/scene/transform.h"

namespace rivulet::scene_graph_test {
namespace {

void expectNear(const vec3& a, const vec3& b, float tolerance) {
    EXPECT_LT(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

TEST(SceneTransform, turnsAboutXThenYThenZ) {
    const Transform t{vec3(1, 2, 3), vec3(90, 90, 0), 2.0F};
    expectNear(transformPoint(t.matrix(), vec3(0, 1, 0)), vec3(1, 2, 3) + 2.0F * vec3(1, 0, 0), 1e-5F);  // y -> z -> x
}

TEST(SceneTransform, fittedPutsTheLongestSideAndTheCentreWhereAsked) {
    const Bounds bounds{vec3(-1, 0, 2), vec3(3, 1, 4)};
    const mat4 m = Transform::fitted(bounds, 0.5F, vec3(7, 8, 9), vec3(0, -90, 0));
    const Bounds placed = transformBounds(m, bounds);
    expectNear(placed.centre(), vec3(7, 8, 9), 1e-5F);
    EXPECT_NEAR(placed.size().z, 0.5F, 1e-5F);  // x became z
}

TEST(SceneTransform, aMirroredMeshKeepsItsOutside) {
    Mesh mesh;
    mesh.positions = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)};
    mesh.normals.assign(3, vec3(0, 0, 1));
    mesh.indices = {0, 1, 2};
    const Mesh flipped = transformed(mesh, glm::scale(mat4(1.0F), vec3(1, 1, -3)));
    const vec3 a = flipped.positions[flipped.indices[0]], b = flipped.positions[flipped.indices[1]],
               c = flipped.positions[flipped.indices[2]];
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), flipped.normals[0]), 0.0F);
    expectNear(flipped.normals[0], vec3(0, 0, -1), 1e-6F);
}

TEST(SceneCamera, orbitAndLookAtAreTheSameCamera) {
    Camera camera;
    camera.position = vec3(1.2F, 0.7F, -2.0F);
    camera.target = vec3(0.3F, 0.1F, 0.2F);
    const vec3 before = camera.position;
    const OrbitCamera orbit = OrbitCamera::from(camera);
    orbit.apply(camera);
    expectNear(camera.position, before, 1e-5F);
    OrbitCamera turned = orbit;
    turned.orbit(360.0F, 500.0F);
    EXPECT_NEAR(turned.pitch, 89.0F, 1e-4F);
    turned.pan(0.1F, 0.2F);
    EXPECT_NEAR(glm::length(turned.target - orbit.target), std::hypot(0.1F, 0.2F) * orbit.distance, 1e-4F);
}

TEST(SceneCamera, theTargetIsInTheMiddleAndFramingHoldsEveryCorner) {
    const Bounds bounds{vec3(-1, 0, -2), vec3(3, 1, 4)};
    for (const float aspect : {0.4F, 1.0F, 2.5F}) {
        Camera camera;
        OrbitCamera orbit;
        orbit.yaw = 33;
        orbit.frame(bounds, camera.fieldOfView, aspect);
        orbit.apply(camera);
        camera.setPlanes(bounds);
        const mat4 clip = camera.projection(aspect) * camera.view();
        const vec4 middle = clip * vec4(camera.target, 1.0F);
        EXPECT_NEAR(middle.x / middle.w, 0.0F, 1e-4F);
        EXPECT_NEAR(middle.y / middle.w, 0.0F, 1e-4F);
        for (int k = 0; k < 8; ++k) {
            const vec3 corner((k & 1) != 0 ? bounds.max.x : bounds.min.x, (k & 2) != 0 ? bounds.max.y : bounds.min.y,
                              (k & 4) != 0 ? bounds.max.z : bounds.min.z);
            const vec4 p = clip * vec4(corner, 1.0F);
            EXPECT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), p.w * 1.0001F);
        }
    }
}

TEST(SceneCamera, straightDownAndOnTheTargetAreNoNaN) {
    Camera camera;
    camera.position = vec3(0, 2, 0);
    camera.target = vec3(0);
    EXPECT_TRUE(isFinite(transformPoint(camera.view(), vec3(1))));
    camera.position = camera.target;
    EXPECT_TRUE(isFinite(transformPoint(camera.view(), vec3(1))));
    EXPECT_GT(OrbitCamera::from(camera).distance, 0.0F);
}

TEST(SceneLight, itsMapHoldsTheBounds) {
    const Bounds bounds{vec3(-1, 0, -2), vec3(3, 1, 4)};
    for (const vec3& direction : {vec3(0.4F, 0.8F, 0.45F), vec3(0, 1, 0), vec3(-3, 0.1F, 0)}) {
        const Bounds mapped = transformBounds(Light{direction, vec3(1)}.projection(bounds), bounds);
        EXPECT_LE(mapped.max.x, 1.0001F);
        EXPECT_LE(mapped.max.y, 1.0001F);
        EXPECT_LE(mapped.max.z, 1.0001F);
        EXPECT_GE(mapped.min.z, -1.0001F);
        const mat4 m = Light{direction, vec3(1)}.projection(bounds);  // nearer the light is nearer in depth
        EXPECT_LT(transformPoint(m, bounds.centre() + 0.1F * direction).z, transformPoint(m, bounds.centre()).z);
    }
}

TEST(SceneGraph, childrenFollowTheirParentsAndHideWithThem) {
    Scene scene;
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {vec3(0), vec3(1)};
    Node parent;
    parent.local = Transform{vec3(0, 5, 0), vec3(0, 90, 0)}.matrix();
    const int index = scene.add(parent);
    Node child;
    child.parent = index;
    child.local = Transform{vec3(1, 0, 0)}.matrix();
    child.mesh = mesh;
    scene.add(child);
    expectNear(transformPoint(scene.worldMatrices()[1], vec3(0)), vec3(0, 5, -1), 1e-5F);
    expectNear(scene.bounds().max, vec3(1, 6, -1), 1e-5F);
    scene.nodes()[0].visible = false;
    EXPECT_FALSE(scene.visible()[1]);
    EXPECT_TRUE(scene.bounds().empty());
}

}  // namespace
}  // namespace rivulet::scene_graph_test
