// Sequential impulses (Catto 2005, "Iterative Dynamics with Temporal Coherence"): a contact at a time, an impulse changes the velocities of
// its two bodies so that its points separate, or approach no faster than their distance allows within the substep. The sum of its impulses,
// not each one, must push and stay within the friction cone. The sums of one substep start the next. Overlaps are undone by moving the
// bodies, and not by velocities (nonlinear Gauss-Seidel, as in Box2D 2): these would add energy, and piles would
// rock.
CONSTANT(float, PUSH_RATE, 15.0f);    // 1/s: how fast an overlap is undone; at 100/s, with few iterations, piles rock
CONSTANT(float, PUSH_SHARE, 0.5f);    // of an overlap: not more of it in a substep
CONSTANT(float, PUSH_MOST, 1.0f);     // m/s: no overlap is undone faster
CONSTANT(float, BOUNCE_FROM, 0.2f);   // m/s: slower contacts do not bounce, as in Bullet
CONSTANT(float, MEETS, 0.01f);        // of the way in a substep: surfaces that come so near meet
CONSTANT(float, MOST_PUSH, 1.0e36f);  // of a sum of squares: an impulse beyond it, or NaN, is none

// Velocities of the bodies of a pair.
STRUCT(PairSpeeds) {
    vec4 a;      // m/s; w: 1/kg, 0: contacts do not move it
    vec4 spinA;  // rad/s
    vec4 b;
    vec4 spinB;
};

// m/s, of the point of a against that of b. Arms: m, from the centres of mass.
FN vec3 slipOf(PairSpeeds m, vec3 armA, vec3 armB) {
    return m.a.xyz + cross(m.spinA.xyz, armA) - m.b.xyz - cross(m.spinB.xyz, armB);
}

// The velocities after the impulse `push` (N s) on a, and its opposite on b; `turnA`, `turnB`: rad/s, the spins that it causes.
FN PairSpeeds pushed(PairSpeeds m, vec3 push, vec3 turnA, vec3 turnB) {
    if (!SQUARE_BELOW(dot(push, push), MOST_PUSH)) return m;
    m.a = vec4(m.a.xyz + push * m.a.w, m.a.w);
    m.b = vec4(m.b.xyz - push * m.b.w, m.b.w);
    m.spinA = vec4(m.spinA.xyz + turnA, 0.0f);
    m.spinB = vec4(m.spinB.xyz - turnB, 0.0f);
    return m;
}

// A unit vector at right angles to n.
FN vec3 tangentOf(vec3 n) {
    vec3 t = abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0.0f) : vec3(0.0f, n.z, -n.y);
    return t * (1.0f / sqrt(dot(t, t)));
}

// kg: what an impulse along a direction must overcome; `turnA`, `turnB`: the spins that it causes at 1 N s.
FN float massAlong(vec3 direction, vec3 armA, vec3 armB, vec3 turnA, vec3 turnB, float inverse) {
    float k = inverse + dot(direction, cross(turnA, armA) + cross(turnB, armB));
    return k > 0.0f ? 1.0f / k : 0.0f;
}

// m/s: the speed at which two points meet that approach at `speed` before the substep and are `separation` apart. `pull`: m/s^2, of
// gravity, of one against the other. As the energy that symplectic Euler keeps has it, so that heights are right at any step.
FN float meetingSpeed(float speed, float separation, float pull, float seconds) {
    if (!(speed > 0.0f)) return 0.0f;
    float square = speed * (speed + pull * seconds) + 2.0f * pull * separation;
    return square > 0.0f ? sqrt(square) : 0.0f;
}

// m/s: at which they part again, by the same energy.
FN float partingSpeed(float meeting, float restitution, float pull, float seconds) {
    float rise = 0.5f * pull * seconds, speed = restitution * meeting;
    return rise + sqrt(rise * rise + speed * speed);
}

// N s: the impulse along the normal in the next iteration. `slip`: m/s, of the points, along it; `least`: m/s, at which they are to part,
// negative where they may approach.
FN float nextPush(float impulse, float mass, float slip, float least) {
    float next = max(impulse - mass * (slip - least), 0.0f);
    return SQUARE_BELOW(next * next, MOST_PUSH) ? next : 0.0f;
}

// N s: the friction along the two tangents (y, z) in the next iteration, by Coulomb's law both together. impulse.x: along the normal;
// `slip`: m/s, along the tangents; `mass`: kg, along them.
FN vec3 nextFriction(vec3 impulse, vec2 mass, vec2 slip, float friction) {
    vec3 next = vec3(impulse.x, impulse.y - mass.x * slip.x, impulse.z - mass.y * slip.y);
    float size = sqrt(next.y * next.y + next.z * next.z);
    if (size > friction * next.x) {
        float kept = friction * next.x / size;
        next.y = next.y * kept;
        next.z = next.z * kept;
    }
    if (!SQUARE_BELOW(dot(next, next), MOST_PUSH)) next = vec3(0.0f, 0.0f, 0.0f);
    return next;
}
