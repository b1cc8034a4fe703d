// A particle as a quad that just covers the sphere's picture. Instanced: 4 vertices of a strip, one instance a particle.
// Needs frame.glsl.
layout(location = 0) in vec4 particle;  // xyz m, world
uniform float radius;                   // m

const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);
vec2 corner() { return vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)); }
// Spray is finer than the particles that stand for it: those with few neighbours are drawn smaller.
float spray(vec4 p) { return 1.0 - smoothstep(0.42, 0.72, p.w); }
float drawnRadius(vec4 p) { return radius * mix(1.35, 0.5, spray(p)); }
// NaN, too; and where there is no particle: a free slot, or a sample on a body.
bool lost(vec4 p) { return p.w < 0.0 || !(dot(p.xyz, p.xyz) < 1.0e12); }

// Slopes (x / depth) between which a circle around (x, depth) is seen: its two tangents through the origin.
vec2 tangents(float x, float depth, float r) {
    float t = sqrt(x * x + depth * depth - r * r);
    return vec2((x * t - r * depth) / (depth * t + x * r), (x * t + r * depth) / (depth * t - x * r));
}

// Clip position of this vertex of a quad around the sphere, in the plane through its nearest point. `centre` in view space.
vec4 sphereQuad(vec3 centre, float r) {
    float depth = -centre.z;
    if (depth - r < frame.planes.x) return kNowhere;  // the camera is in it, or it is behind
    vec2 x = tangents(centre.x, depth, r), y = tangents(centre.y, depth, r);
    vec2 at = mix(vec2(x.x, y.x), vec2(x.y, y.y), corner());
    float front = depth - r;
    return frame.projection * vec4(at * front, -front, 1.0);
}
