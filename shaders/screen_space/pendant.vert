// A drop that hangs, or has just let go, as a quad that covers it.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/quads.glsl"
#include "shaders/screen_space/pendant.glsl"
flat out Pendant drop;
out vec3 through;  // m, a point of the line of sight, in view
void main() {
    Pendant p;
    int at = PENDANT_ROWS * row();
    vec4 foot = texelFetch(pendants, at), axis = texelFetch(pendants, at + 1), lean = texelFetch(pendants, at + 3);
    p.foot = vec4((frame.view * vec4(foot.xyz, 1.0)).xyz, foot.w);
    p.axis = vec4(mat3(frame.view) * axis.xyz, axis.w);
    p.swell = texelFetch(pendants, at + 2);
    p.lean = vec4(mat3(frame.view) * lean.xyz, lean.w);
    p.absorption = texelFetch(pendants, at + 4).rgb;
    drop = p;
    // A ball about it, from above its foot to its tip.
    vec3 top = p.foot.xyz + p.axis.xyz * (PENDANT_ABOVE * p.foot.w), tip = centreLine(p, 1.0);
    vec3 middle = 0.5 * (top + tip);
    float radius = length(vec2(0.5 * distance(top, tip), p.lean.w));
    vec3 toEye = towardsEye(middle), right = normalize(cross(vec3(0.0, 1.0, 0.0), toEye)), up = cross(toEye, right);
    vec2 off = (corner() * 2.0 - 1.0) * 1.1 * radius;
    through = middle + toEye * radius + right * off.x + up * off.y;
    gl_Position = !beyond() && -middle.z - radius > frame.planes.x ? frame.projection * vec4(through, 1.0) : kNowhere;
}
