// A square inside the sphere, facing the camera: whatever lies behind it is behind the sphere's near side too. Drawn first, depth only and
// without a fragment shader's work, it spares the spheres deep in the water theirs. Spray hides nothing: the water's surface goes on behind it.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
void main() {
    vec3 c = (frame.view * vec4(particle.xyz, 1.0)).xyz;
    c.xy += (corner() - 0.5) * 1.40 * drawnRadius(particle);  // half the side: 0.70 radii < 1 / sqrt(2)
    gl_Position = lost(particle) || spray(particle) > 0.5 || -c.z < frame.planes.x ? kNowhere : frame.projection * vec4(c, 1.0);
}
