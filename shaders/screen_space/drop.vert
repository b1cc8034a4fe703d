// A drop in the air as a quad that covers it and its path during the exposure (motion blur).
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/quads.glsl"
ROWS(0, drops)             // two rows per drop: xyz m, world, w m, radius; xyz m/s
uniform float shutter;     // s, exposure time
flat out vec4 centreView;  // xyz m; w m, radius as drawn: at least most of a pixel
flat out vec4 wayView;     // xyz unit, perpendicular to the line of sight; w m, half the path
flat out float share;      // opacity
out vec2 place;            // m, along the path and across
void main() {
    vec4 drop = texelFetch(drops, 2 * row()), velocity = texelFetch(drops, 2 * row() + 1);
    vec3 c = (frame.view * vec4(drop.xyz, 1.0)).xyz, v = mat3(frame.view) * velocity.xyz;
    float depth = -c.z;
    vec3 toEye = towardsEye(c);
    vec3 seen = v - toEye * dot(v, toEye);  // velocity perpendicular to the line of sight
    float speed = length(seen), least = 0.6 * pixelSize(depth).x;
    vec3 along = speed > 1.0e-6 ? seen / speed : normalize(cross(toEye, vec3(0.31, 0.95, 0.0)));
    float radius = max(drop.w, least), way = 0.5 * speed * shutter;
    // The opacity is the share of the exposure time that the drop spends at a point.
    share = min(drop.w / radius, 1.0) * radius / (radius + 0.7 * way);
    float margin = radius + least;
    place = (corner() * 2.0 - 1.0) * vec2(way + margin, margin);
    centreView = vec4(c, radius);
    wayView = vec4(along, way);
    vec3 at = c + along * place.x + cross(toEye, along) * place.y;
    gl_Position = !beyond() && depth - radius > frame.planes.x ? frame.projection * vec4(at, 1.0) : kNowhere;
}
