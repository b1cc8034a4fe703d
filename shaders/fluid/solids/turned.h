// A vector turned by a rotation. Included once, after lang.h.
// `q`: unit quaternion, w last.
FN vec3 turnedBy(vec4 q, vec3 a) { return a + 2.0f * cross(q.xyz, cross(q.xyz, a) + q.w * a); }
