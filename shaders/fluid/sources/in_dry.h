// Whether a point is inside a volume that stays dry. After dry_volume.h.
#if !defined(RIVULET_IN_DRY_H)
#define RIVULET_IN_DRY_H
FN vec3 turnedBack(vec4 turn, vec3 d) {
    vec3 q = turn.xyz;
    return d + 2.0f * cross(q, cross(q, d) - turn.w * d);
}
// `x`: m, in the frame in which the volume is.
FN bool inDry(vec3 x, DryVolume v) {
    vec3 own = turnedBack(v.turn, x - v.centre.xyz);
    float a = own.x / v.reach.x;
    float b = own.y / v.reach.y;
    float c = own.z / v.reach.z;
    float squares = a * a + b * b + c * c;
    float longest = max(max(a * a, b * b), c * c);
    return (v.centre.w == 0.0f ? longest : squares) <= 1.0f;
}
#endif
