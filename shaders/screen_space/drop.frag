// A drop in the air: a sphere of water that refracts the background, which appears upside down, and reflects the environment.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
uniform sampler2D sceneColour;
uniform sampler2D sceneDepth;  // window depth
#if defined(OVER_WATER)
uniform sampler2D waterDepth;  // m
#endif
uniform float refractiveIndex;
flat in vec4 centreView;
flat in vec4 wayView;
flat in float share;
in vec2 place;
layout(location = 0) out vec4 colour;

void main() {
    float radius = centreView.w;
    vec2 off = vec2(sign(place.x) * max(abs(place.x) - wayView.w, 0.0), place.y) / radius;
    float d = length(off), pixel = -centreView.z * frame.ray.x / radius;
    float cover = 1.0 - smoothstep(1.0 - pixel, 1.0 + pixel, d);
    vec3 toEye = -normalize(centreView.xyz), across = cross(toEye, wayView.xyz);
    float nv = sqrt(max(1.0 - d * d, 0.0));
    ivec2 here = ivec2(gl_FragCoord.xy);
    float depth = -centreView.z - radius * nv;
    if (cover <= 0.0 || depth > depthOfWindow(texelFetch(sceneDepth, here, 0).r)) discard;
#if defined(OVER_WATER)
    if (depth > texelFetch(waterDepth, here, 0).r) discard;
#endif

    vec3 outwards = d > 1.0e-4 ? (wayView.xyz * off.x + across * off.y) / d : vec3(0.0);
    vec3 n = outwards * min(d, 1.0) + toEye * nv;
    // A sphere refracts a ray twice by the same angle, towards its centre.
    float turn = 2.0 * (asin(min(d, 1.0)) - asin(min(d, 1.0) / refractiveIndex));
    vec3 bent = -toEye * cos(turn) - outwards * sin(turn);
    vec3 p = centreView.xyz;
    float behind = depthOfWindow(texelFetch(sceneDepth, here, 0).r);
    vec3 met = p + bent * clamp(behind - depth, 0.0, 0.4);
    vec2 uv = pixelOf(met) * frame.viewport.zw;
    vec2 inside = smoothstep(vec2(0.5), vec2(0.45), abs(uv - 0.5));
    float seen = met.z < -frame.planes.x ? inside.x * inside.y : 0.0;
    uv = clamp(uv, frame.viewport.zw, 1.0 - frame.viewport.zw);
    // Objects in front of the drop are not visible in it.
    if (depthOfWindow(textureLod(sceneDepth, uv, 0.0).r) < depth) seen = 0.0;
    vec3 through = mix(environment(directionToWorld(bent), 0.15), textureLod(sceneColour, uv, 0.0).rgb, seen);

    float base = (refractiveIndex - 1.0) / (refractiveIndex + 1.0);
    float mirror = mix(base * base, 1.0, pow(1.0 - nv, 5.0));  // Schlick 1994
    vec3 mirrored = environment(directionToWorld(reflect(-toEye, n)), 0.05);
    vec3 half_ = normalize(toEye + transpose(mat3(frame.inverseView)) * frame.lightDir.xyz);
    float glint = smoothstep(0.975, 0.995, dot(n, half_));
    colour = vec4(mix(through, mirrored, mirror) + frame.lightColour.rgb * (0.6 * glint), cover * share);
}
