// The depth of the floor, an infinite plane.
#include "shaders/render/frame.glsl"
void main() {
    vec3 dir = directionToWorld(sightWay(gl_FragCoord.xy));
    float t = (frame.floorColour.w - frame.cameraPos.y) / dir.y;
    gl_FragDepth = frame.floorFade.w != 0.0 && t > frame.planes.x && t < frame.planes.y ? windowOfDepth(t) : 1.0;
}
