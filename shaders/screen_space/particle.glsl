// A particle as a quad that just covers the image of its sphere, or with ELLIPSOIDS of its ellipsoid. Needs frame.glsl.
#include "shaders/screen_space/quads.glsl"
ROWS(0, particles) // xyz m, world
#if defined(ELLIPSOIDS)
ROWS(4, centres)    // xyz m: see fluid/surface/ellipsoids.kernel
ROWS(5, spreads)    // xx, yy, zz of the squared half axes, a round particle's 1
ROWS(6, slants)     // yz, zx, xy
#endif
vec4 particle = texelFetch(particles, row());
layout(binding = 26) uniform usamplerBuffer ids;
uniform float radius;                   // m
uniform float detail;                   // pixels: see representedBy(); 0: every particle is drawn
uniform float holds;                    // 0..1: 1: the liquid is too viscous to break up into spray

const float kOverlap = 1.35;  // radii: drawn so large, they cover the water without gaps. Spheres make it 0.3 radii too thick by that
// The mean of a particle's neighbours lies inward of the surface: a displacement of up to this, in radii, is not noise but the shrinking
// described by Yu and Turk 2013, and is reversed. Then a level surface, after filtering, is half a spacing above its topmost
// particles, where their volume ends: within 0.1 radii, seen from any angle, for radii of 0.6 spacings.
const float kShrunk = 0.77;
// Spray is finer than the particles that represent it: those with few neighbours are drawn smaller, and as they leave the body of the water
// they become droplets (spray.vert). `leaving`: how far they have, 0 to 1; at 1 nothing of them is in the body.
// The density of one without neighbours is 0.27 to 0.39: of what does not break up, only those are drops.
float spray(vec4 p) { return 1.0 - smoothstep(mix(0.42, 0.3, holds), mix(0.72, 0.42, holds), p.w); }
float leaving(vec4 p) { return smoothstep(0.1, 0.5, spray(p)); }
float ownRadius(vec4 p) { return radius * mix(kOverlap, 0.5, spray(p)); }

// Level of detail by size on the screen: of particles whose radius is less than `detail` pixels, a share is drawn, with so large a radius
// that the sum of their areas stays what it was. The share is the square of their radius over `detail`: as many splats for a pixel at any
// distance. Which ones, their ids decide: multiples of the golden ratio, of which any share is spread evenly. Those next to be left out
// shrink first, so that none pops as the camera moves (stochastic simplification, Cook et al. 2007).
// Returns the number of particles that this one represents: 1 where all are drawn, 0 where others represent it.
const float kFades = 0.25, kFewest = 1.0 / 64.0;
float representedBy(vec4 p, uint id) {
    float depth = max(-(frame.view * vec4(p.xyz, 1.0)).z, frame.planes.x), pixels = ownRadius(p) / pixelSize(depth).y;
    if (!(pixels < detail)) return 1.0;
    float share = max(pixels * pixels / (detail * detail), kFewest);
    float at = float((id * 2654435769u) >> 8) / 16777216.0 * (1.0 - kFades) / share;
    float end = min(share / (1.0 - kFades), 1.0), past = end - share;
    // The mean over all ids of the weight below.
    float mean = share + past * (1.0 - (end + share) * 0.5 * (1.0 - kFades) / share) / kFades;
    return clamp((1.0 - at) / kFades, 0.0, 1.0) / mean;
}
#if defined(ALL_DRAWN)
const float represents = 1.0;
#else
float represents = detail > 0.0 ? representedBy(particle, texelFetch(ids, row()).r) : 1.0;
#endif
float drawnRadius(vec4 p) { return ownRadius(p) * sqrt(represents); }
// Also for NaN (by its bits: see lang.h), for a free slot and for a body sample.
bool lost(vec4 p) { return beyond() || p.w < 0.0 || represents <= 0.0 || floatBitsToUint(dot(p.xyz, p.xyz)) >= floatBitsToUint(1.0e12); }

// What is drawn, in view space: the points p with (p - centre)^T squares^-1 (p - centre) < 1.
struct Splat {
    vec3 centre;   // m
    mat3 squares;  // m^2
};
Splat splatOf(vec4 p) {
    float r = drawnRadius(p);
    Splat s = Splat((frame.view * vec4(p.xyz, 1.0)).xyz, mat3(r * r));
#if defined(ELLIPSOIDS)
    vec3 toCentre = texelFetch(centres, row()).xyz, spread = texelFetch(spreads, row()).xyz, slant = texelFetch(slants, row()).xyz;
    // A particle spawned after the ellipsoids were computed has none yet.
    float sum = spread.x + spread.y + spread.z;
    if (sum > 0.05 && sum < 50.0 && dot(toCentre, toCentre) < 9.0 * radius * radius) {
        float wide = radius * kOverlap * sqrt(represents);
        mat3 view = mat3(frame.view);
        // In a thin sheet there is no shrinking to reverse; the rest is noise.
        float way = length(toCentre) / radius;
        s.centre += view * (toCentre * (1.0 - kShrunk * smoothstep(0.15, 0.45, way) / max(way, 1.0e-6)));
        s.squares = view * (wide * wide * mat3(spread.x, slant.z, slant.y, slant.z, spread.y, slant.x, slant.y, slant.x, spread.z)) * transpose(view);
    }
#endif
    return s;
}

// Slopes (x / depth) between which it is seen along one axis: its two tangents through the origin. Orthographic: x, m.
vec2 tangents(float c, float depth, float cc, float cz, float zz) {
    if (parallel() > 0.0) return c + vec2(-1.0, 1.0) * sqrt(cc);
    float a = depth * depth - zz, b = -c * depth - cz, t = sqrt(max(b * b - a * (c * c - cc), 0.0));
    return vec2(-b - t, -b + t) / a;
}

// Clip position of a point that covers the rectangle of the slopes (orthographic: m) `low` to `high` at `depth`, m. It covers what of it is
// within the picture: a point whose centre lies outside is not drawn.
vec4 pointOver(vec2 low, vec2 high, float depth) {
    vec4 a = frame.projection * vec4(low * spreadAt(depth), -depth, 1.0), b = frame.projection * vec4(high * spreadAt(depth), -depth, 1.0);
    vec2 from = max(min(a.xy, b.xy) / a.w, vec2(-1.0)), to = min(max(a.xy, b.xy) / a.w, vec2(1.0));
    if (from.x >= to.x || from.y >= to.y) return kNowhere;
    vec2 pixels = (to - from) * 0.5 * pointTarget;
    gl_PointSize = max(pixels.x, pixels.y) + 1.0;  // rounded up, however the GPU rounds
    return vec4((from + to) * 0.5 * a.w, a.zw);
}

// Clip position of this vertex of a quad around it, in the plane through its nearest point; of one that the near plane cuts, in that plane.
// Or that of a point.
vec4 splatQuad(Splat s) {
    float depth = -s.centre.z, ahead = sqrt(s.squares[2][2]), near = frame.planes.x * 1.001;
    if (!(depth + ahead > near)) return kNowhere;
    vec2 low, high;
    float front = depth - ahead;
    if (front > near) {
        vec2 x = tangents(s.centre.x, depth, s.squares[0][0], s.squares[2][0], s.squares[2][2]);
        vec2 y = tangents(s.centre.y, depth, s.squares[1][1], s.squares[2][1], s.squares[2][2]);
        low = vec2(x.x, y.x);
        high = vec2(x.y, y.y);
    } else {  // a box about it, from the near plane on
        vec2 wide = sqrt(vec2(s.squares[0][0], s.squares[1][1])), a = s.centre.xy - wide, b = s.centre.xy + wide;
        low = min(a / spreadAt(near), a / spreadAt(depth + ahead));
        high = max(b / spreadAt(near), b / spreadAt(depth + ahead));
        front = near;
    }
    if (asPoint()) return pointOver(low, high, front);
    return frame.projection * vec4(mix(low, high, corner()) * spreadAt(front), -front, 1.0);
}
