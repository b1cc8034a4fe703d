// A particle of spray, foam or bubbles as a quad.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/screen_space/quads.glsl"
ROWS(0, flecks)        // xyz m, world; w s, remaining lifetime
ROWS(1, velocities)    // xyz m/s; w size 0.5..1, + 1 spray, 2 foam, 3 bubble
uniform float radius;  // m, of a particle of size 1
flat out vec4 white;  // rgb radiance, a opacity at its centre
flat out float depth; // m
out vec2 place;
void main() {
    vec4 fleck = texelFetch(flecks, row()), velocity = texelFetch(velocities, row());
    float kind = floor(velocity.w);
    float r = radius * fract(velocity.w) * (kind == 1.0 ? 0.6 : kind == 3.0 ? 0.8 : 1.0);
    vec3 c = (frame.view * vec4(fleck.xyz, 1.0)).xyz;
    depth = -c.z;
    // A particle smaller than a pixel has a lower opacity.
    float least = 0.7 * depth * frame.ray.x, drawn = max(r, least);
    float share = (r / drawn) * (r / drawn);
    place = corner() * 2.0 - 1.0;
    vec3 light = ambient(vec3(0.0, 1.0, 0.0)) + frame.lightColour.rgb * (0.3183099 * meshShadow(fleck.xyz, frame.lightDir.xyz) * (0.4 + 0.6 * max(frame.lightDir.y, 0.0)));
    white = vec4(0.92 * light, share * (kind == 2.0 ? 0.55 * smoothstep(0.0, 0.5, fleck.w) : kind == 1.0 ? 0.45 : 0.35));
    bool there = !beyond() && fleck.w > 0.0 && dot(fleck.xyz, fleck.xyz) < 1.0e12 && depth - drawn > frame.planes.x;
    gl_Position = there ? frame.projection * vec4(c + vec3(place * drawn, 0.0), 1.0) : kNowhere;
}
