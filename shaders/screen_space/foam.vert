// A particle of spray, foam or bubbles as a quad: spray is drawn out along its path during the exposure, foam lies on the water.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/lights.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/screen_space/quads.glsl"
ROWS(0, flecks)        // xyz m, world; w s, remaining lifetime
ROWS(1, velocities)    // xyz m/s; w size 0.5..1, + 1 spray, 2 foam, 3 bubble
uniform float radius;   // m, of a particle of size 1
uniform float shutter;  // s, exposure time
flat out vec4 white;    // rgb radiance, a opacity at its centre
flat out float depth;   // m
flat out float stretch; // radii: half of its path
flat out vec3 cells;    // place of its bubbles; z: how clearly they are seen, 0..1
out vec2 place;         // radii; x along the path
void main() {
    vec4 fleck = texelFetch(flecks, row()), velocity = texelFetch(velocities, row());
    float kind = floor(velocity.w);
    bool foam = kind == 2.0;
    float r = radius * fract(velocity.w) * (kind == 1.0 ? 0.6 : foam ? 2.6 : 0.8);
    vec3 c = (frame.view * vec4(fleck.xyz, 1.0)).xyz, toEye = towardsEye(c);
    depth = -c.z;
    float pixel = pixelSize(depth).x;
    // A particle smaller than a pixel has a lower opacity.
    float drawn = max(r, 0.7 * pixel), share = (r / drawn) * (r / drawn);
    vec3 seen = mat3(frame.view) * velocity.xyz;
    seen -= toEye * dot(seen, toEye);
    float speed = length(seen);
    stretch = kind == 1.0 ? 0.5 * speed * shutter / drawn : 0.0;
    vec3 up = mat3(frame.view)[1], level = cross(up, toEye);
    bool along = stretch > 0.01, seenFromAbove = dot(level, level) < 1.0e-4;
    vec3 right = along ? seen / speed : seenFromAbove ? vec3(1.0, 0.0, 0.0) : normalize(level), over = cross(toEye, right);
    if (foam && !seenFromAbove) over = normalize(mix(over, cross(right, up) * sign(dot(cross(right, up), over)), 0.85));
    place = (corner() * 2.0 - 1.0) * vec2(1.0 + stretch, 1.0);
    cells = vec3(fract(float(row()) * vec2(0.7548777, 0.5698403)) * 64.0, foam ? smoothstep(3.0, 9.0, drawn / pixel) : 0.0);
    vec3 light = ambient(vec3(0.0, 1.0, 0.0));
    for (int k = 0; k < lightCount(); ++k) {
        float share = (k == 0 ? meshShadow(fleck.xyz, frame.lightDir.xyz) : 1.0) * lightShare(k, fleck.xyz);
        light += lightColour(k) * (0.3183099 * share * (0.4 + 0.6 * max(lightTowards(k).y, 0.0)));
    }
    white = vec4(0.92 * light, share * (foam ? 0.3 * smoothstep(0.0, 0.8, fleck.w) : kind == 1.0 ? 0.45 / (1.0 + 0.6 * stretch) : 0.35));
    bool there = !beyond() && fleck.w > 0.0 && dot(fleck.xyz, fleck.xyz) < 1.0e12 && depth - drawn * (1.0 + stretch) > frame.planes.x;
    gl_Position = there ? frame.projection * vec4(c + drawn * (right * place.x + over * place.y), 1.0) : kNowhere;
}
