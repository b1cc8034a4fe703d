// A square inside the sphere, facing the camera: objects behind it are behind the near side of the sphere too. It is drawn first, depth
// only and without fragment shading, and saves shading spheres deep in the water. What has become droplets has none.
// For a sphere that the near plane cuts, the square is drawn just behind that plane.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
void main() {
    gl_PointSize = 1.0;
    Splat s = splatOf(particle);
    vec3 c = s.centre;
#if defined(ELLIPSOIDS)
    // No more than its shortest half axis: the product of the other two squares is no more than a quarter of the trace's.
    float inner = 2.0 * sqrt(determinant(s.squares)) / (s.squares[0][0] + s.squares[1][1] + s.squares[2][2]);
#else
    float inner = drawnRadius(particle);
#endif
    inner *= 1.0 - leaving(particle);
    float side = 1.40 * inner;  // half of it: 0.70 radii < 1 / sqrt(2)
    if (asPoint()) {
        float pixels = side * min(abs(frame.projection[0][0]) * pointTarget.x, abs(frame.projection[1][1]) * pointTarget.y) * 0.5 / spreadAt(-c.z);
        gl_PointSize = max(pixels - 1.0, 1.0);  // rounded down, however the GPU rounds
        if (pixels < 2.0) inner = 0.0;
    } else {
        c.xy += (corner() - 0.5) * side;
    }
    gl_Position = lost(particle) || inner <= 0.0 || -c.z < frame.planes.x * 1.01 ? kNowhere : frame.projection * vec4(c, 1.0);
}
