// Whether a point is inside a volume that stays dry. After dry_volume.h.
#if !defined(RIVULET_IN_DRY_H)
#define RIVULET_IN_DRY_H
FN bool inDry(vec3 x, DryVolume v) {
    vec3 d = x - v.centre.xyz;
    vec3 q = v.turn.xyz;
    vec3 own = d + 2.0f * cross(q, cross(q, d) - v.turn.w * d);  // turned back
    float a = own.x / v.reach.x;
    float b = own.y / v.reach.y;
    float c = own.z / v.reach.z;
    float squares = a * a + b * b + c * c;
    float longest = max(max(a * a, b * b), c * c);
    return (v.centre.w == 0.0f ? longest : squares) <= 1.0f;
}
#endif
