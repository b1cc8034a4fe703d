// Starts a walk at a point in space on triangle t, or at its nearest point on t. After walk.h.
FN SkinWalk walkFrom(GLOBAL(vec4, basis) uint t, vec3 x) {
    vec3 d = x - basis[5u * t].xyz;
    SkinWalk w;
    w.triangle = t;
    w.b1 = min(max(dot(basis[5u * t + 3u].xyz, d), 0.0f), 1.0f);
    w.b2 = min(max(dot(basis[5u * t + 4u].xyz, d), 0.0f), 1.0f - w.b1);
    w.v = vec3(0.0f, 0.0f, 0.0f);
    w.gone = 0u;
    return w;
}
