// The response (26) of the thesis with friction and restitution: the part of `u` into the wall is reversed times `bounce`,
// the tangential part is reduced by Coulomb friction of that impulse and is never reversed.
FN vec3 respond(vec3 u, vec3 n, float friction, float bounce) {
    float into = -dot(u, n);
    if (!(into > 0.0f)) return u;
    vec3 along = u + n * into;
    float speed = length(along);
    float kept = speed > 0.0f ? max(1.0f - friction * (1.0f + bounce) * into / speed, 0.0f) : 0.0f;
    return along * kept + n * (bounce * into);
}
