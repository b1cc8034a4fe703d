// The box and the planes: a particle's centre keeps the distance `contact` from them; the velocity into a wall gets the response of
// respond.h. In a world without walls (OPEN) there is no response. Include after BUFFERS and fluid/solids/respond.h; the buffer is
// `planes`, two vec4 per plane: unit normal, w m; friction, restitution.
STRUCT(Walled) {
    vec3 position;  // m
    vec3 velocity;  // m/s
};
#undef WITHIN_WALLS
#if defined(OPEN)
#define WITHIN_WALLS(x, v) asTheyAre_(x, v)
FN Walled asTheyAre_(vec3 x, vec3 v) {
#else
#define WITHIN_WALLS(x, v) withinWalls_(PASS(planes) PARAMS, x, v)
FN Walled withinWalls_(GLOBAL(vec4, planes) StepParams p, vec3 x, vec3 v) {
    vec3 lo = p.boxMin.xyz + vec3(p.contact, p.contact, p.contact);
    vec3 hi = p.boxMax.xyz - vec3(p.contact, p.contact, p.contact);
    float e = p.restitution;
    float mu = p.friction;
    // A comparison with NaN is false: NaN is kept, so that the next grid build counts it, and is not replaced by a wall's coordinate.
    if (x.x < lo.x) {
        x.x = lo.x;
        v = respond(v, vec3(1.0f, 0.0f, 0.0f), mu, e);
    }
    if (x.y < lo.y) {
        x.y = lo.y;
        v = respond(v, vec3(0.0f, 1.0f, 0.0f), mu, e);
    }
    if (x.z < lo.z) {
        x.z = lo.z;
        v = respond(v, vec3(0.0f, 0.0f, 1.0f), mu, e);
    }
    if (x.x > hi.x) {
        x.x = hi.x;
        v = respond(v, vec3(-1.0f, 0.0f, 0.0f), mu, e);
    }
    if (x.y > hi.y) {
        x.y = hi.y;
        v = respond(v, vec3(0.0f, -1.0f, 0.0f), mu, e);
    }
    if (x.z > hi.z) {
        x.z = hi.z;
        v = respond(v, vec3(0.0f, 0.0f, -1.0f), mu, e);
    }
    for (uint k = 0u; k < p.planeCount; ++k) {
        vec4 plane = planes[2u * k];
        vec4 surface = planes[2u * k + 1u];
        float d = dot(plane.xyz, x) + plane.w - p.contact;
        if (d < 0.0f) {
            x = x - plane.xyz * d;
            v = respond(v, plane.xyz, surface.x, surface.y);
        }
    }
#endif
    Walled w;
    w.position = x;
    w.velocity = v;
    return w;
}
