#include "fluid/render/host_view.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "fluid/render/host_lighting.h"

namespace rivulet {

bool isFinite(const mat4& m) {
    for (int column = 0; column < 4; ++column)
        if (!rivulet::isFinite(vec3(m[column])) || !std::isfinite(m[column].w)) return false;
    return true;
}

namespace {

using glm::dvec4;

constexpr double kSkew = 1.0e-3;   // of two unit vectors: rounding of a host's floats is less
constexpr double kAlike = 1.0e-9;  // difference of two clip depths

Status usable(const FrameView& v, bool parallel) {
    if (!std::isfinite(v.unitsPerMetre) || !(v.unitsPerMetre > 0))
        return badInput("view: the units per metre must be positive and finite: 1 for metres, 100 for centimetres");
    if (parallel && !(v.nearPlane >= 0))
        return badInput("view: the near plane of an orthographic projection must be 0 or more; move the eye back along the view axis");
    if ((!parallel && !(v.nearPlane > 0)) || !(v.farPlane > v.nearPlane) || !std::isfinite(v.farPlane))
        return badInput(
            "view: the near and the far plane must be positive and finite, the second beyond the first; for an infinite projection, give "
            "the depth of the farthest object");
    if (!rivulet::isFinite(v.lightDirWorld) || v.lightDirWorld == vec3(0.0F))
        return badInput("view: the light's direction is 0 or not finite; give a vector towards it");
    if (!isRadiance(v.lightColour)) return badInput("view: the light's colour is negative or not finite; give radiance");
    return ok();
}

// The rows of a matrix world (m) -> clip.
struct Rows {
    dvec4 x, y, z, w;
    Rows(const dmat4& m) : x(row(m, 0)), y(row(m, 1)), z(row(m, 2)), w(row(m, 3)) {}
    static dvec4 row(const dmat4& m, int k) { return {m[0][k], m[1][k], m[2][k], m[3][k]}; }
};

// A camera as the rows of its matrix show it: axes in the world (unit), and the shares of clip x and y.
struct Axes {
    dvec3 right, up, forward, eye;
    double scaleX = 0, scaleY = 0;  // projection[0][0], [1][1]
    double shiftX = 0, shiftY = 0;  // clip x, y on the axis
};

Error skewed() {
    return badInput(
        "view: the view matrix and the projection skew the picture: its two axes are not at right angles; use a perspective or an "
        "orthographic "
        "projection, and a view without shear");
}
Error singular() {
    return badInput(
        "view: the view matrix or the projection is singular; use matrices of a camera, for example glm::lookAt and glm::perspective");
}

// Sets right, up and their scales from what is across the axis; they are made exactly perpendicular.
Status setAcross(Axes& a, const dvec3& x, const dvec3& y) {
    a.scaleX = glm::length(x);
    a.scaleY = glm::length(y);
    if (!(a.scaleX > 0) || !(a.scaleY > 0) || !std::isfinite(a.scaleX * a.scaleY)) return singular();
    a.right = x / a.scaleX;
    a.up = y / a.scaleY;
    const double skew = glm::dot(a.right, a.up);
    if (std::abs(skew) > kSkew) return skewed();
    a.up = glm::normalize(a.up - skew * a.right);
    return ok();
}

// Where the three planes meet.
Result<dvec3> meet(const dvec4& a, const dvec4& b, const dvec4& c) {
    const dmat3 rows = glm::transpose(dmat3(dvec3(a), dvec3(b), dvec3(c)));
    const double volume = glm::length(dvec3(a)) * glm::length(dvec3(b)) * glm::length(dvec3(c));
    if (!(std::abs(glm::determinant(rows)) > 1.0e-9 * volume)) return singular();
    return glm::inverse(rows) * -dvec3(a.w, b.w, c.w);
}

Result<Axes> perspectiveAxes(const Rows& m) {
    Axes a;
    const double s = glm::length(dvec3(m.w));
    if (!(s > 0)) return singular();
    a.forward = dvec3(m.w) / s;
    const dvec3 x = dvec3(m.x) / s, y = dvec3(m.y) / s;
    a.shiftX = glm::dot(x, a.forward);
    a.shiftY = glm::dot(y, a.forward);
    if (Status set = setAcross(a, x - a.shiftX * a.forward, y - a.shiftY * a.forward); !set) return set.error();
    Result<dvec3> eye = meet(m.x, m.y, m.w);
    if (!eye) return eye.error();
    a.eye = *eye;
    return a;
}

// `viewZ`: the row world (m) -> z of the host's view. The eye is where it is 0, in the middle of the picture.
Result<Axes> orthographicAxes(const Rows& m, const dvec4& viewZ, const FrameView& host, double lowest) {
    Axes a;
    const double s = glm::length(dvec3(viewZ));
    if (!(s > 0)) return singular();
    if (Status set = setAcross(a, dvec3(m.x), dvec3(m.y)); !set) return set.error();
    const dvec3 back = dvec3(viewZ) / s;
    if (std::abs(glm::dot(back, a.right)) > kSkew || std::abs(glm::dot(back, a.up)) > kSkew) return skewed();
    Result<dvec3> eye = meet(m.x, m.y, viewZ);
    if (!eye) return eye.error();
    a.eye = *eye;
    // Right-handed views look down -z, left-handed ones down +z: the one whose planes are within the clip space.
    const double at = glm::dot(m.z, dvec4(*eye, 1)), slope = glm::dot(dvec3(m.z), back) / s;
    const auto outside = [&](double sign) {
        double sum = 0;
        for (const double plane : {double{host.nearPlane}, double{host.farPlane}}) {
            const double z = at + sign * slope * plane;
            sum += std::max({lowest - z, z - 1, 0.0});
        }
        return sum;
    };
    constexpr double kRounding = 1.0e-4;
    a.forward = outside(1) + kRounding < outside(-1) ? back : -back;
    return a;
}

}  // namespace

Result<HostView> HostView::of(const FrameView& host, const gpu::HostDepth& depth, int width, int height) {
    if (!isFinite(host.view) || !isFinite(host.projection))
        return badInput("view: the view matrix or the projection has a value that is not finite");
    const mat4& p = host.projection;
    const bool parallel = p[0][3] == 0 && p[1][3] == 0 && p[2][3] == 0;
    if (parallel == (p[3][3] == 0))
        return badInput(
            "view: the projection is neither a perspective nor an orthographic projection; use glm::perspective, glFrustum or "
            "glm::ortho, and move an offset of the eye into the view");
    if (host.view[0].w != 0 || host.view[1].w != 0 || host.view[2].w != 0 || host.view[3].w != 1)
        return badInput("view: the view matrix projects; use glm::lookAt, and put the projection into the other matrix");
    if (Status can = usable(host, parallel); !can) return can.error();

    dmat4 view(host.view);
    for (int column = 0; column < 3; ++column) view[column] *= double{host.unitsPerMetre};
    const dmat4 projection(host.projection);
    Rows m(projection * view);
    if (parallel)
        for (dvec4* row : {&m.x, &m.y, &m.z}) *row /= m.w.w;
    if (depth.upperLeft) m.y = -m.y;
    const dvec4 viewZ = Rows::row(view, 2);
    Result<Axes> found = parallel ? orthographicAxes(m, viewZ, host, depth.zeroToOne ? 0 : -1) : perspectiveAxes(m);
    if (!found) return found.error();
    Axes& a = *found;

    HostView out;
    if (glm::dot(glm::cross(a.right, a.up), a.forward) > 0) {  // a mirror image
        // Of y where the host's projection mirrors it, so that its view's up stays up.
        out.flipY = (p[1][1] < 0) != depth.upperLeft;
        out.flipX = !out.flipY;
        (out.flipY ? a.up : a.right) *= -1;
        (out.flipY ? a.shiftY : a.shiftX) *= -1;
    }
    // The host's unit of depth, in metres.
    const double unit = parallel ? 1 / glm::length(dvec3(viewZ))
                                 : glm::length(dvec3(projection[0][3], projection[1][3], projection[2][3])) / glm::length(dvec3(m.w));
    const double n = host.nearPlane * unit, f = host.farPlane * unit;
    out.view = host;
    out.view.unitsPerMetre = 1.0F;
    out.view.width = width;
    out.view.height = height;
    out.view.nearPlane = static_cast<float>(n);
    out.view.farPlane = static_cast<float>(f);
    out.view.cameraPosWorld = vec3(a.eye);
    out.view.lightDirWorld = unitAlong(host.lightDirWorld);
    dmat4 canonical(glm::transpose(dmat3(a.right, a.up, -a.forward)));
    canonical[3] = dvec4(-(dmat3(canonical) * a.eye), 1);
    out.view.view = mat4(canonical);
    dmat4 own(0.0);
    own[0][0] = a.scaleX;
    own[1][1] = a.scaleY;
    own[2][2] = parallel ? -2 / (f - n) : -(f + n) / (f - n);
    own[3][2] = parallel ? -(f + n) / (f - n) : -2 * f * n / (f - n);
    own[2][3] = parallel ? 0 : -1;
    own[3][3] = parallel ? 1 : 0;
    own[2][0] = -a.shiftX;
    own[2][1] = -a.shiftY;
    out.view.projection = mat4(own);

    // Clip z at a point eye + x right + y up + d forward, over clip w.
    const double w = parallel ? 1 : glm::length(dvec3(m.w));
    const double alongX = glm::dot(dvec3(m.z), a.right) / w, alongY = glm::dot(dvec3(m.z), a.up) / w;
    const double ahead = glm::dot(dvec3(m.z), a.forward) / w, atEye = glm::dot(m.z, dvec4(a.eye, 1)) / w;
    const dvec2 perPixel(2 / (width * a.scaleX), 2 / (height * a.scaleY));
    const dvec2 first((-a.shiftX - 1) / a.scaleX, (-a.shiftY - 1) / a.scaleY);  // at pixel 0
    const double constant = alongX * first.x + alongY * first.y + (parallel ? atEye : ahead), variable = parallel ? ahead : atEye;
    // Of the near and the far plane.
    const double between = std::abs(variable * (parallel ? f - n : 1 / n - 1 / f));
    if (!(between > kAlike) || !std::isfinite(constant) || !std::isfinite(variable)) return singular();
    out.depthRow = vec4(alongX * perPixel.x, alongY * perPixel.y, constant, variable);
    return out;
}

}  // namespace rivulet
