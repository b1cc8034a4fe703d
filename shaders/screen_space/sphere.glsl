// Intersection of the ray through a pixel with a sphere or ellipsoid, exact. Needs frame.glsl.
// False: no hit. `front`: depth of the near point; `through`: length of the ray inside it (m). Parts in front of the near plane are cut
// away.
bool cutAtNear(float middle, float h, float slant, out float front, out float through) {
    front = max(middle - h, frame.planes.x);
    through = (middle + h - front) * slant;
    return through > 0.0;
}
bool hitSphere(vec2 pixel, vec3 centre, float r, out float front, out float through) {
    vec3 v = sightWay(pixel);
    centre -= sightFrom(pixel);
    float a = dot(v, v), b = dot(v, centre) / a;
    vec3 miss = centre - b * v;  // not |centre|^2 - r^2: that cancels
    float h2 = (r * r - dot(miss, miss)) / a;
    if (h2 <= 0.0) return false;
    return cutAtNear(b, sqrt(h2), sqrt(a), front, through);
}
// `shape`: 1/m^2, (p - centre)^T shape (p - centre) is 1 on the surface.
bool hitEllipsoid(vec2 pixel, vec3 centre, mat3 shape, out float front, out float through) {
    vec3 v = sightWay(pixel), w = shape * v;
    centre -= sightFrom(pixel);
    float a = dot(v, w), b = dot(centre, w) / a;
    vec3 miss = centre - b * v;
    float h2 = (1.0 - dot(miss, shape * miss)) / a;
    if (h2 <= 0.0) return false;
    return cutAtNear(b, sqrt(h2), length(v), front, through);
}
