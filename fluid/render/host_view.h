// HostView: a host's camera in Rivulet's convention: right-handed, looking down -z, metres, with a perspective or an orthographic
// projection.
#pragma once

#include "engine/core/result.h"
#include "engine/gpu/host_state.h"
#include "engine/render/frame_view.h"

namespace rivulet {

bool isFinite(const mat4& m);
// The unit vector along `v`, of any length but 0: in double, where the squares of the smallest floats are above 0.
inline vec3 unitAlong(const vec3& v) { return vec3(glm::normalize(dvec3(v))); }

struct HostView {
    FrameView view;  // the same camera; its picture is the host's, mirrored as `flipX` and `flipY` say
    bool flipX = false, flipY = false;
    // The host's clip depth at pixel p of `view`'s picture (centres at 0.5): dot(depthRow, (p.x, p.y, 1, t)), where t is 1 / depth (m) in a
    // perspective and depth in an orthographic projection.
    vec4 depthRow{0.0F};

    // Any matrices of a camera: mirrored, left-handed, scaled, of an oblique near plane (Lengyel 2005). `width`, `height`: of the target,
    // pixels. Error (badInput): a value that is not finite; planes out of order; a matrix that is singular or skews the picture.
    static Result<HostView> of(const FrameView& host, const gpu::HostDepth& depth, int width, int height);
};

}  // namespace rivulet
