// Moves a particle for one step: limits its speed, and keeps it inside the box and the planes. Include after fluid/solids/walls.h; the
// buffers are `density` (over the rest density), positionNext and velocityNext. xyz v, w 1 if the speed was limited.
FN vec4 slowedTo(vec3 v, float most) {
    float speed2 = dot(v, v);
    if (speed2 > most * most) return vec4(v * (most / sqrt(speed2)), 1.0f);
    return vec4(v, 0.0f);
}
// From x, with the new velocity v, both at the begin of the step.
#undef ADVANCE
#define ADVANCE(i, x, v)                                                           \
    {                                                                              \
        vec4 slowed_ = slowedTo(v, PARAMS.maxSpeed);                               \
        Walled walled_ = WITHIN_WALLS((x) + slowed_.xyz * PARAMS.dt, slowed_.xyz); \
        positionNext[i] = vec4(walled_.position, density[i]);                      \
        velocityNext[i] = vec4(walled_.velocity, slowed_.w);                       \
    }
