// A particle that has left the body of the water, as the droplets that it stands for: a point or quad over them and their paths during the
// exposure.
#include "shaders/render/frame.glsl"
#include "shaders/render/lights.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/screen_space/particle.glsl"
ROWS(1, velocities)        // xyz m/s
#if defined(INK)
ROWS(3, absorptions)       // see FluidView
flat out vec4 ink;         // 1/m; w: scattering
#endif
uniform vec4 ownAbsorption;  // 1/m; w: scattering
uniform float spacing;     // m
uniform float split;       // 0: one drop; 1: droplets and mist
uniform float shutter;     // s, exposure time; 0: there are no velocities
uniform float longest;     // pixels, half the longest path that is drawn
uniform bool named;        // there are ids
const int kDroplets = 7;
const float kSeen = 0.9;   // of the mist's reach: beyond, its opacity is less than 0.0025
flat out vec4 droplet[kDroplets];  // m: along the path, across, half the path, radius as drawn; 0: not there
flat out float share[kDroplets];   // opacity
flat out vec3 centreView;          // m
flat out vec3 alongView;           // unit, perpendicular to the line of sight
flat out float haze;               // opacity of what is finer, at the centre
flat out vec2 reach;               // m, of that
flat out float lit;                // share of the key light that meshes and the host's scene let pass

// PCG (Jarzynski and Olano 2020): three numbers, 0 to 1, that stay with the droplet.
vec3 chosen(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v += v.yzx * v.zxy;
    v ^= v >> 16u;
    v += v.yzx * v.zxy;
    return vec3(v >> 8u) / 16777216.0;
}

void main() {
    float gone = leaving(particle);
    gl_Position = kNowhere;
    gl_PointSize = 1.0;
#if defined(INK)
    ink = vec4(0.0);
#endif
    centreView = alongView = vec3(0.0);
    haze = lit = 0.0;
    reach = vec2(0.0);
    for (int k = 0; k < kDroplets; ++k) {
        droplet[k] = vec4(0.0);
        share[k] = 0.0;
    }
    if (lost(particle) || gone <= 0.0) return;
    vec3 c = (frame.view * vec4(particle.xyz, 1.0)).xyz, v = vec3(0.0);
    if (shutter > 0.0) v = mat3(frame.view) * texelFetch(velocities, row()).xyz;
    float depth = -c.z, pixel = pixelSize(depth).x;
    vec3 toEye = towardsEye(c), seen = v - toEye * dot(v, toEye);
    float speed = length(seen), path = min(0.5 * speed * shutter, longest * pixel);  // m, half of it
    vec3 along = speed > 1.0e-6 ? seen / speed : normalize(cross(toEye, vec3(0.31, 0.95, 0.0))), across = cross(toEye, along);
    float far_ = 0.0, wide = 0.0;
    uint id = named ? texelFetch(ids, row()).r : uint(row());
    for (int k = 0; k < kDroplets; ++k) {
        vec3 h = chosen(uvec3(id, uint(k), 77u)), g = chosen(uvec3(id, uint(k), 1234u));
        float turn = 6.2831853 * h.x, up = 2.0 * h.y - 1.0;
        vec3 way = mat3(frame.view) * vec3(sqrt(1.0 - up * up) * vec2(cos(turn), sin(turn)), up).xzy * (pow(h.z, 0.3333) * spacing * split * mix(0.2, 1.1, gone));
        // Few are large, most are small.
        float radius = spacing * (k == 0 ? mix(0.62, 0.30, split) : split * mix(0.09, 0.22, g.x * g.x)) * smoothstep(0.0, 0.5, gone);
        float half_ = path * mix(0.8, 1.2, g.y), drawn = max(radius, 0.6 * pixel);
        droplet[k] = vec4(dot(way, along), dot(way, across), half_, drawn);
        // The share of the exposure that it spends at a point; one smaller than a pixel covers a part of it.
        share[k] = (radius / drawn) * (radius / drawn) * drawn / (drawn + 0.6 * half_);
        far_ = max(far_, abs(droplet[k].x) + half_ + drawn);
        wide = max(wide, abs(droplet[k].y) + drawn);
    }
#if defined(INK)
    vec4 absorption = texelFetch(absorptions, row());
    ink = absorption.w < 0.0 ? vec4(absorption.xyz, -1.0 - absorption.w) : absorption + ownAbsorption;
#endif
    reach = spacing * vec2(1.5) + vec2(path, 0.0);
    haze = 0.06 * gone * split;
    vec2 margin = max(vec2(far_, wide), kSeen * reach) + 0.6 * pixel;
    centreView = c;
    alongView = along;
    lit = meshShadow(particle.xyz, frame.lightDir.xyz) * lightShare(0, particle.xyz);
    if (depth - reach.y <= frame.planes.x) return;
    if (asPoint()) {  // the corners of the same quad
        vec2 low = vec2(1.0e9), high = -low;
        for (int k = 0; k < 4; ++k) {
            vec3 at = c + along * (float(k & 1) * 2.0 - 1.0) * margin.x + across * (float(k >> 1) * 2.0 - 1.0) * margin.y;
            vec2 slope = at.xy / spreadAt(max(-at.z, frame.planes.x));
            low = min(low, slope);
            high = max(high, slope);
        }
        gl_Position = pointOver(low, high, depth);
    } else {
        vec2 at = (corner() * 2.0 - 1.0) * margin;
        gl_Position = frame.projection * vec4(c + along * at.x + across * at.y, 1.0);
    }
}
