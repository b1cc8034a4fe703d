// Sky, and with FLOOR the floor, which fades into the horizon, so that its edge is not visible.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#if defined(FLOOR)
#include "shaders/render/shadow.glsl"
#include "shaders/render/water_light.glsl"
#include "shaders/material/surface.glsl"
#include "shaders/render/tiles.glsl"
uniform sampler2D occlusion;
#endif
layout(location = 0) out vec4 colour;
void main() {
    vec3 ray = directionToWorld(sightWay(gl_FragCoord.xy)), dir = normalize(ray);
    colour = vec4(skyGradient(dir), 1.0);
#if defined(FLOOR)
    vec3 posWorld = frame.cameraPos.xyz + (frame.floorColour.w - frame.cameraPos.y) / ray.y * ray;
    float away = length(posWorld.xz - frame.floorFade.xy) / frame.floorFade.z;
    float near = exp(-0.22 * max(away - 0.9, 0.0) * max(away - 0.9, 0.0));
    float open = textureLod(occlusion, gl_FragCoord.xy * frame.viewport.zw, 0.0).r;
    vec3 up = vec3(0.0, 1.0, 0.0);
    vec3 light = frame.lightColour.rgb * meshShadow(posWorld, up) * waterShadow(posWorld);
    Surface s = Surface(frame.floorColour.rgb, 0.55, 0.0, up, open);
    if (frame.horizon.w > 0.0) {
        vec2 at = posWorld.xz / frame.horizon.w;
        float shade, joint = tileJoint(at, fwidth(at), shade);
        s.baseColour *= mix(1.0 + shade, 0.5, joint);
        s.roughness = mix(0.3, 0.8, joint);
    }
    colour.rgb = mix(colour.rgb, shadeSurface(s, -dir, light, skyGradient(vec3(dir.x, -dir.y, dir.z))), near);
#endif
}
