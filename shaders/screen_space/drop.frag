// A drop in the air: a sphere of water that refracts the background, which appears upside down, and reflects the environment.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/screen_space/drop.glsl"
flat in vec4 centreView;
flat in vec4 wayView;
flat in float share;
in vec2 place;
layout(location = 0) out vec4 colour;

void main() {
    float radius = centreView.w;
    vec2 off = vec2(sign(place.x) * max(abs(place.x) - wayView.w, 0.0), place.y) / radius;
    float d = length(off), pixel = pixelSize(-centreView.z).x / radius;
    float cover = 1.0 - smoothstep(1.0 - pixel, 1.0 + pixel, d);
    vec3 toEye = towardsEye(centreView.xyz), across = cross(toEye, wayView.xyz);
    float nv = sqrt(max(1.0 - d * d, 0.0));
    float depth = -centreView.z - radius * nv;
    if (cover <= 0.0 || isHidden(depth)) discard;

    vec3 outwards = d > 1.0e-4 ? (wayView.xyz * off.x + across * off.y) / d : vec3(0.0);
    vec3 n = outwards * min(d, 1.0) + toEye * nv;
    // A sphere refracts a ray twice by the same angle, towards its centre.
    float turn = 2.0 * (asin(min(d, 1.0)) - asin(min(d, 1.0) / refractiveIndex));
    vec3 bent = -toEye * cos(turn) - outwards * sin(turn);
    gl_FragDepth = windowOfDepth(cover > 0.5 ? depth : depthBehind());
    vec3 through = seenThrough(centreView.xyz, bent, depth, 0.0);
    colour = vec4(lightOfDrop(through, vec3(centreView.xy, -depth), n, toEye, 0.0), cover * share);
}
