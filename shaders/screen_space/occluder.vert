// A square inside the sphere, facing the camera: whatever lies behind it is behind the sphere's near side too. Drawn first, depth only and
// without a fragment shader's work, it spares the spheres deep in the water theirs. Spray hides nothing: the water's surface goes on behind it. What the near plane cuts hides nothing either: it
// is drawn just behind that plane itself.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
void main() {
    Splat s = splatOf(particle);
    vec3 c = s.centre;
#if defined(ELLIPSOIDS)
    mat3 shape = inverse(s.squares);
    float inner = inversesqrt(shape[0][0] + shape[1][1] + shape[2][2]);  // no more than its shortest half axis
#else
    float inner = drawnRadius(particle);
#endif
    c.xy += (corner() - 0.5) * 1.40 * inner;  // half the side: 0.70 radii < 1 / sqrt(2)
    gl_Position = lost(particle) || spray(particle) > 0.5 || -c.z < frame.planes.x * 1.01 ? kNowhere : frame.projection * vec4(c, 1.0);
}
