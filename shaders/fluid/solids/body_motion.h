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
FN PullNow pullOn(BodyMotion m, vec3 x, vec4 q, vec3 v, vec3 spin, vec3 gravity, float seconds) {
    PullNow p;
    p.speed = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    p.angular = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    if (!(m.grip.w > 0.0f)) return p;
    vec3 arm = turnedBy(q, m.grip.xyz);
    float least = min(min(m.inertia.x, m.inertia.y), m.inertia.z);
    float light = 1.0f + m.inertia.w * dot(arm, arm) / least;
    vec3 spring = springOf(x + arm, v + cross(spin, arm), m.hand.xyz, m.grip.w, m.hand.w, seconds, light);
    p.speed = vec4((spring - gravity) * seconds, 0.0f);
    p.angular = vec4(cross(arm, spring) * (m.inertia.w * seconds), calmOf(seconds));
    return p;
}

// Whether a body may be in this state: finite, and within MOST.
FN bool isSoundState(vec3 x, vec4 q, vec3 v, vec3 spin) {
    float size = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    bool sound = SQUARE_BELOW(dot(x, x), MOST * MOST) && SQUARE_BELOW(dot(v, v), MOST * MOST) && SQUARE_BELOW(dot(spin, spin), MOST * MOST);
    return sound && SQUARE_BELOW(size, 1.5f) && size > 0.5f;
}

// The load on a body in a substep, as BodyLoads::transfer has it: impulses that act now, and those that are pending then.
STRUCT(LoadNow) {
    vec4 impulse;         // N s
    vec4 angular;         // N m s
    vec4 pending;         // N s
    vec4 pendingAngular;  // N m s
};
// `pending`, `pendingAngular`: of the substep before.
FN LoadNow loadOf(GLOBAL(LoadRow, rows) uint b, float samples, float added, float seconds, vec3 pending, vec3 pendingAngular) {
    vec3 force = vec3(0.0f, 0.0f, 0.0f);
    vec3 torque = vec3(0.0f, 0.0f, 0.0f);
    float wet = 0.0f;
    if (samples > 0.0f) {
        for (uint t = b * LOAD_THREADS; t < (b + 1u) * LOAD_THREADS; ++t) {
            force = force + rows[t].force.xyz;
            torque = torque + rows[t].torque.xyz;
            wet += rows[t].force.w;
        }
        // What is not finite moves nothing.
        if (!SQUARE_BELOW(dot(force, force) + dot(torque, torque) + wet * wet, MOST_LOAD)) {
            force = vec3(0.0f, 0.0f, 0.0f);
            torque = force;
            wet = 0.0f;
        }
        wet = wet / samples;
    }
    float share = 1.0f / (1.0f + added * wet);
    vec3 impulse = force * seconds + pending;
    vec3 angular = torque * seconds + pendingAngular;
    LoadNow l;
    l.impulse = vec4(impulse * share, 0.0f);
    l.angular = vec4(angular * share, 0.0f);
    l.pending = vec4(impulse * (1.0f - share), 0.0f);
    l.pendingAngular = vec4(angular * (1.0f - share), 0.0f);
    return l;
}

// The body with this load noted. `first`: in a frame's first substep.
FN DeviceBody loaded(DeviceBody body, LoadNow l, float seconds, bool first) {
    body.force = l.impulse * (1.0f / seconds);
    body.torque = l.angular * (1.0f / seconds);
    body.pendingImpulse = l.pending;
    body.pendingAngularImpulse = l.pendingAngular;
    body.pushed = first ? l.impulse : body.pushed + l.impulse;
    body.pushedAngular = first ? l.angular : body.pushedAngular + l.angular;
    body.faults = first ? 0u : body.faults;
    return body;
}
