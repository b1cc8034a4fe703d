// How a rigid body moves in a substep: the fluid's load on it, filtered, and the rotation that its angular momentum gives. Included after
// BUFFERS, since loadOf reads the rows of sum_loads, and after body_pull.h.
CONSTANT(float, MOST, 1.0e6f);       // kMostDistance, kMostSpeed
CONSTANT(float, MOST_LOAD, 1.0e36f);  // of a sum of squares: beyond it a load is not finite

#include "shaders/fluid/solids/turned.h"

FN vec4 conjugateOf(vec4 q) { return vec4(-q.x, -q.y, -q.z, q.w); }

// a times b; b turns first.
FN vec4 productOf(vec4 a, vec4 b) {
    return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

// The rotation by a vector's length about its direction, rad. The series of an eighth of it (GPUs need not have an exact sine), whose angle
// is doubled three times: correct to rounding up to 2.5 turns.
FN vec4 turnOf(vec3 angles) {
    vec3 part = (0.5f / 8.0f) * angles;
    float s = dot(part, part);
    float sine = 1.0f - s * (1.0f / 6.0f) * (1.0f - s * (1.0f / 20.0f) * (1.0f - s * (1.0f / 42.0f)));  // over the angle
    float cosine = 1.0f - s * 0.5f * (1.0f - s * (1.0f / 12.0f) * (1.0f - s * (1.0f / 30.0f)));
    vec4 q = vec4(sine * part, cosine);
    q = productOf(q, q);
    q = productOf(q, q);
    return productOf(q, q);
}

// Angular momentum of a spin and spin of an angular momentum, of a body turned by q. inertia: about its own axes.
FN vec3 momentumOf(vec4 q, vec3 inertia, vec3 spin) { return turnedBy(q, inertia * turnedBy(conjugateOf(q), spin)); }
FN vec3 spinOf(vec4 q, vec3 inertia, vec3 momentum) { return turnedBy(q, turnedBy(conjugateOf(q), momentum) / inertia); }

// q after `seconds` of the spin.
FN vec4 turnedOn(vec4 q, vec3 spin, float seconds) {
    q = productOf(turnOf(spin * seconds), q);
    return q * (1.0f / sqrt(dot(q.xyz, q.xyz) + q.w * q.w));
}

// What the hand that holds a body does to it in a substep.
STRUCT(PullNow) {
    vec4 speed;    // m/s, that it adds
    vec4 angular;  // N m s; w: what it leaves of the spin
};
FN PullNow noPull() {
    PullNow p;
    p.speed = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    p.angular = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    return p;
}
// `arm`: m, from the centre of mass to the point; `place`, `velocity`: of the point. `grip`, `hand`: of BodyMotion.
FN PullNow pullOn(vec4 inertia, vec3 arm, vec3 place, vec3 velocity, vec4 grip, vec4 hand, vec3 gravity, float seconds) {
    PullNow p;
    float least = min(min(inertia.x, inertia.y), inertia.z);
    float light = 1.0f + inertia.w * dot(arm, arm) / least;
    vec3 spring = springOf(place, velocity, hand.xyz, grip.w, hand.w, seconds, light);
    p.speed = vec4((spring - gravity) * seconds, 0.0f);
    p.angular = vec4(cross(arm, spring) * (inertia.w * seconds), calmOf(seconds));
    return p;
}

// Whether a body may be in this state: finite, and within MOST.
FN bool isSoundState(vec3 x, vec4 q, vec3 v, vec3 spin) {
    float size = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    bool sound = SQUARE_BELOW(dot(x, x), MOST * MOST) && SQUARE_BELOW(dot(v, v), MOST * MOST) && SQUARE_BELOW(dot(spin, spin), MOST * MOST);
    return sound && SQUARE_BELOW(size, 1.5f) && size > 0.5f;
}

// The sum of the fluid's loads on a body; force.w: wet share of its surface.
FN LoadRow sumOf(GLOBAL(LoadRow, rows) uint b, float samples) {
    LoadRow sum;
    sum.force = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    sum.torque = sum.force;
    if (!(samples > 0.0f)) return sum;
    for (uint t = b * LOAD_THREADS; t < (b + 1u) * LOAD_THREADS; ++t) {
        sum.force = sum.force + rows[t].force;
        sum.torque = sum.torque + vec4(rows[t].torque.xyz, 0.0f);
    }
    float size = dot(sum.force.xyz, sum.force.xyz) + dot(sum.torque.xyz, sum.torque.xyz) + sum.force.w * sum.force.w;
    // What is not finite moves nothing.
    if (!SQUARE_BELOW(size, MOST_LOAD)) {
        sum.force = vec4(0.0f, 0.0f, 0.0f, 0.0f);
        sum.torque = sum.force;
    }
    sum.force = vec4(sum.force.xyz, sum.force.w / samples);
    return sum;
}

// The load on a body in a substep, as BodyLoads::transfer has it: impulses that act now, and those that are pending then.
STRUCT(LoadNow) {
    vec4 impulse;         // N s
    vec4 angular;         // N m s
    vec4 pending;         // N s
    vec4 pendingAngular;  // N m s
};
// `sum`: of sumOf. `pending`, `pendingAngular`: of the substep before.
FN LoadNow loadOf(LoadRow sum, float added, float seconds, vec3 pending, vec3 pendingAngular) {
    float share = 1.0f / (1.0f + added * sum.force.w);
    vec3 impulse = sum.force.xyz * seconds + pending;
    vec3 angular = sum.torque.xyz * seconds + pendingAngular;
    LoadNow l;
    l.impulse = vec4(impulse * share, 0.0f);
    l.angular = vec4(angular * share, 0.0f);
    l.pending = vec4(impulse * (1.0f - share), 0.0f);
    l.pendingAngular = vec4(angular * (1.0f - share), 0.0f);
    return l;
}

// Notes this load of a body field by field: a copy of the whole body takes 44 registers, which spill on Intel's GPUs. `first`: in a frame's
// first substep.
#define NOTE_LOAD(body, l, seconds, first)                                         \
    {                                                                              \
        body.force = l.impulse * (1.0f / (seconds));                               \
        body.torque = l.angular * (1.0f / (seconds));                              \
        body.pendingImpulse = l.pending;                                           \
        body.pendingAngularImpulse = l.pendingAngular;                             \
        body.pushed = (first) ? l.impulse : body.pushed + l.impulse;               \
        body.pushedAngular = (first) ? l.angular : body.pushedAngular + l.angular; \
    }
