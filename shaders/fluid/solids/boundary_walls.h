// Walls by signed distance (after Bender et al. 2019, volume maps): the share of the kernel's integral that lies behind a plane wall at
// distance d, exact for Wendland C2: f(d) = s^6 (7/2 - 9/2 s + 3/2 s^2), s = 1 - d / h. Several walls count as independent shares,
// f = 1 - prod(1 - f_k): exact where walls do not overlap, and the overlap behind an edge is counted once.
STRUCT(WallShare) {
    vec4 open;  // w = prod(1 - f_k); xyz = sum of n_k f'_k / (1 - f_k), so that the share's gradient is xyz * w (1/m)
};
FN WallShare noWall() {
    WallShare s;
    s.open = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    return s;
}
// `n`: unit normal into the fluid; `d` m; beyond h the share is 0, behind the wall it stays 1/2.
FN WallShare addWall(WallShare sum, vec3 n, float d, float invH) {
    float s = min(1.0f - d * invH, 1.0f);
    if (!(s > 0.0f)) return sum;
    float s2 = s * s;
    float s5 = s2 * s2 * s;
    float f = s5 * s * (3.5f - 4.5f * s + 1.5f * s2);
    float slope = -21.0f * s5 * (1.0f - 1.5f * s + 0.571428571f * s2) * invH;  // df/dd
    vec3 v = sum.open.xyz + n * (slope / (1.0f - f));
    sum.open = vec4(v, sum.open.w * (1.0f - f));
    return sum;
}
