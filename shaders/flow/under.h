// The skin under a drop: its velocity and how strongly it retains the drop.
#if !defined(RIVULET_UNDER_H)
#define RIVULET_UNDER_H
// m/s: the velocity of the skin at these barycentric coordinates and x (m), by deformation and by the motion of its frame.
FN vec3 skinSpeed(GLOBAL(uint, skin) GLOBAL(vec4, drive) uint triangle, float b1, float b2, vec3 x, vec4 d0, vec4 d1, vec4 d2) {
    uint corner = SKIN_UINTS * triangle;
    vec3 bends = drive[2u * skin[corner] + 1u].xyz * (1.0f - b1 - b2) + drive[2u * skin[corner + 1u] + 1u].xyz * b1 +
                 drive[2u * skin[corner + 2u] + 1u].xyz * b2;
    return bends + vec3(dot(d0.xyz, x) + d0.w, dot(d1.xyz, x) + d1.w, dot(d2.xyz, x) + d2.w);
}
FN vec3 onTriangle(GLOBAL(vec4, basis) uint t, float b1, float b2) {
    return basis[5u * t].xyz + basis[5u * t + 1u].xyz * b1 + basis[5u * t + 2u].xyz * b2;
}
#endif
