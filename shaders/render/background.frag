// Floor and sky. The floor fades into the horizon, so that it has no edge.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/material/surface.glsl"
uniform sampler2D occlusion;
layout(location = 0) out vec4 colour;
void main() {
    vec3 ray = directionToWorld(viewRay(gl_FragCoord.xy));
    vec3 dir = normalize(ray);
    vec3 sky = skyGradient(dir);
    colour = vec4(sky, 1.0);
    float t = (frame.floorColour.w - frame.cameraPos.y) / ray.y;
    if (frame.floorFade.w == 0.0 || t <= frame.planes.x || t >= frame.planes.y) return;
    vec3 posWorld = frame.cameraPos.xyz + t * ray;
    float away = length(posWorld.xz - frame.floorFade.xy) / frame.floorFade.z;
    float near = exp(-0.22 * max(away - 0.9, 0.0) * max(away - 0.9, 0.0));
    if (near < 0.002) return;
    float open = texture(occlusion, gl_FragCoord.xy * frame.viewport.zw).r;
    vec3 light = frame.lightColour.rgb;
    if (away < 4.0) light *= meshShadow(posWorld, vec3(0.0, 1.0, 0.0)) * waterShadow(posWorld);
    Surface s = Surface(frame.floorColour.rgb, 0.55, 0.0, vec3(0.0, 1.0, 0.0), open);
    vec3 surface = shadeSurface(s, -dir, light, skyGradient(vec3(dir.x, -dir.y, dir.z)));
    colour.rgb = mix(sky, surface, near);
}
