// The ray through a pixel and a sphere: exact in perspective. Needs frame.glsl.
// False: no hit. `front`: depth of the near point; `through`: length of the ray in the sphere (m).
bool hitSphere(vec2 pixel, vec3 centre, float r, out float front, out float through) {
    vec3 v = viewRay(pixel);
    float a = dot(v, v), b = dot(v, centre) / a;
    vec3 miss = centre - b * v;  // not |centre|^2 - r^2: that cancels
    float h2 = (r * r - dot(miss, miss)) / a;
    if (h2 <= 0.0) return false;
    float h = sqrt(h2);
    front = b - h;
    through = 2.0 * h * sqrt(a);
    return true;
}
