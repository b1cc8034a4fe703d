// Camera: a position that looks at a target, and OrbitCamera, which moves it.
#pragma once

#include "engine/core/math.h"

namespace rivulet {

struct Camera {
    vec3 position{1.6F, 1.1F, 2.2F};  // m, world
    vec3 target{0.0F};                // m, world
    float fieldOfView = 40.0F;        // deg, vertical
    float nearPlane = 0.01F;          // m
    float farPlane = 100.0F;          // m

    mat4 view() const;                             // world -> view; +Y is up, unless it looks straight up or down
    mat4 projection(float widthOverHeight) const;  // view -> clip, depth -1..1

    // Sets the near and far plane close around `bounds` (world, m), with a margin for the floor.
    void setPlanes(const Bounds& bounds);
};

// The same camera as yaw, pitch and distance about a target. Angles in deg; yaw 0 looks from +z, 90 from +x.
struct OrbitCamera {
    vec3 target{0.0F};
    float yaw = 0.0F, pitch = 20.0F, distance = 2.0F;

    static OrbitCamera from(const Camera& camera);
    void orbit(float yawDegrees, float pitchDegrees);                            // pitch stays within -89..89
    void pan(float right, float up);                                             // in units of `distance`
    void zoom(float steps);                                                      // one step is 10 % of `distance`; positive: nearer
    void frame(const Bounds& bounds, float fieldOfView, float widthOverHeight);  // fits `bounds` into the view; keeps the angles
    void apply(Camera& camera) const;                                            // sets position and target
};

}  // namespace rivulet
