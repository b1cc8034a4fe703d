// The walls near a particle, at most three with different directions, each as the plane through its nearest point. Buffer `nearWalls`: four
// vec4 a particle, entry k of particle i at i + k * PARAMS.count, as in WallList.
STRUCT(WallList) {
    vec4 first;  // xyz unit normal into the fluid, w distance of the particle, m; from h on it has no images; 4 h: there is none
    vec4 second;
    vec4 third;
    vec4 speed;  // m/s, xyz: of the first, second and third wall along its normal
};
FN WallList noNearWalls(float h) {
    WallList w;
    w.first = vec4(0.0f, 1.0f, 0.0f, 4.0f * h);
    w.second = w.first;
    w.third = w.first;
    w.speed = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    return w;
}
// Walls that matter are nearer than this (m): behind others, no image is within the support radius h, because particles keep a distance to
// walls.
FN float wallReach(float h, float contact) { return h - 0.8f * contact; }
FN bool isWall(vec4 entry, float h) { return entry.w < 3.0f * h; }
FN bool sameDirection_(vec4 wall, vec3 n, float h) { return isWall(wall, h) && dot(wall.xyz, n) > 0.9f; }
// Keeps the nearest wall of each direction, and the nearest three directions. n: unit normal into the fluid; d, h and reach: m; speed: m/s,
// along n.
FN WallList addNearWall(WallList list, vec3 n, float d, float speed, float h, float reach) {
    if (!(d < reach)) return list;
    WallList w = list;
    vec4 wall = vec4(n, d);
    if (sameDirection_(w.first, n, h)) {
        if (d < w.first.w) {
            w.first = wall;
            w.speed.x = speed;
        }
    } else if (sameDirection_(w.second, n, h)) {
        if (d < w.second.w) {
            w.second = wall;
            w.speed.y = speed;
        }
    } else if (sameDirection_(w.third, n, h)) {
        if (d < w.third.w) {
            w.third = wall;
            w.speed.z = speed;
        }
    } else if (d < w.first.w) {
        w.third = w.second;
        w.second = w.first;
        w.first = wall;
        w.speed = vec4(speed, list.speed.x, list.speed.y, 0.0f);
    } else if (d < w.second.w) {
        w.third = w.second;
        w.second = wall;
        w.speed = vec4(list.speed.x, speed, list.speed.y, 0.0f);
    } else if (d < w.third.w) {
        w.third = wall;
        w.speed.z = speed;
    }
    return w;
}
