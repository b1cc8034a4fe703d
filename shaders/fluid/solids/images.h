// Mirror images of the neighbours behind the walls near a particle (Libersky et al. 1993): a wall is a plane of symmetry. The loop
// FOR_IMAGES .. END_IMAGES around a loop over the neighbours runs it once for the neighbours themselves (image 0), and once for their
// reflections in each wall, edge and corner of the particle's near walls. SEEN(d) is the vector to the particle from the neighbour's image, for
// d from the neighbour itself; SEEN_VELOCITY(v) is the image's velocity. A particle is among its own images. The loop over the neighbours begins
// with `if (NO_IMAGE(j)) continue;`.
// An image is never nearer than its neighbour, so the loop over the neighbours finds all. Between plane walls the images of i for j are those
// of j for i: forces from densities conserve energy, and momentum along the wall; what is left is the load on the wall.
// Include after BUFFERS, with the buffer `nearWalls`. In a world without walls (OPEN) all of this is nothing.
#undef FOR_IMAGES
#undef END_IMAGES
#undef SEEN
#undef SEEN_VELOCITY
#undef IMAGE
#undef NO_IMAGE
#if defined(OPEN) || defined(WITHOUT_IMAGES)
#define FOR_IMAGES(i) {
#define END_IMAGES }
#define SEEN(d) (d)
#define SEEN_VELOCITY(v) (v)
#define IMAGE 0
#define NO_IMAGE(j) false
#else
STRUCT(Reflections) {
    real4 first;  // as in WallList
    real4 second;
    real4 third;
    real3 speed;
};
// The walls that a particle rests on: those at the rest distance `contact`, m, or nearer.
STRUCT(Resting) {
    real3 normal;  // unit: of one wall, or of the sum of several
    real speed;    // m/s, of the walls along the normal
    real any;      // 1 if there are any, else 0
    real3 on;      // 1 for the first, second, third wall if it is one of them, else 0
    real scale;    // of the sum of the walls' normals to `normal`
};
FN Resting restingOn(Reflections m, float contact) {
    real a = SELECT(m.first.w < 1.02f * contact, 1.0f, 0.0f);
    real b = SELECT(m.second.w < 1.02f * contact, 1.0f, 0.0f);
    real c = SELECT(m.third.w < 1.02f * contact, 1.0f, 0.0f);
    real3 sum = m.first.xyz * a + m.second.xyz * b + m.third.xyz * c;
    real scale = 1.0f / max(sqrt(dot(sum, sum)), 1.0e-4f);
    Resting r;
    r.normal = sum * scale;
    r.speed = (m.speed.x * a + m.speed.y * b + m.speed.z * c) * scale;
    r.any = min(a + b + c, 1.0f);
    r.on = real3(a, b, c);
    r.scale = scale;
    return r;
}
// What is farther than this is beyond the support wherever it is mirrored: 0 for walls at right angles, whose images behind the common edge
// are needed; for walls that meet at other angles they are not (their images cover the edge already, or nearly).
FN int within_(real4 wall, float h) { return ANY_LANE(wall.w < h) ? 1 : 0; }
FN real beyondEdge_(real4 a, real4 b, float h) {
    real c = dot(a.xyz, b.xyz);
    return SELECT(max(c, -c) < 0.5f, 0.0f, 2.0f * h);
}
FN real beyond_(Reflections m, int image, float h) {
    real far_ = 0.0f;
    if ((image & 3) == 3) far_ = max(far_, beyondEdge_(m.first, m.second, h));
    if ((image & 5) == 5) far_ = max(far_, beyondEdge_(m.first, m.third, h));
    if ((image & 6) == 6) far_ = max(far_, beyondEdge_(m.second, m.third, h));
    return far_;
}
// A neighbour behind the wall has no image in front of it.
FN real3 reflected_(real4 wall, real3 d, float h) {
    real from = wall.w - dot(wall.xyz, d);
    return d + wall.xyz * (SELECT(from > 0.0f, from, h) * 2.0f);
}
// An image behind a nearer wall is in that wall's images already: it is moved out of reach.
FN real3 inFrontOf_(real4 wall, real4 mirror, real3 d, float h) {
    return d + mirror.xyz * SELECT(wall.w - dot(wall.xyz, d) > -0.01f * h, 0.0f, 2.0f * h);
}
FN real3 seenInSeveral_(Reflections m, int image, real far_, real3 apart, float h) {
    real3 d = apart;
    if ((image & 1) != 0) d = reflected_(m.first, d, h);
    if ((image & 2) != 0) d = reflected_(m.second, d, h);
    if ((image & 4) != 0) d = reflected_(m.third, d, h);
    if ((image & 1) != 0) return d + m.first.xyz * far_;
    return d + m.second.xyz * far_;
}
FN real3 seenInOne_(Reflections m, int image, real4 mirror, real3 apart, float h) {
    real3 d = reflected_(mirror, apart, h);
    if (image > 1) d = inFrontOf_(m.first, mirror, d, h);
    if (image > 2) d = inFrontOf_(m.second, mirror, d, h);
    return d;
}
FN real speedOf_(Reflections m, int image) { return image == 2 ? m.speed.y : image == 4 ? m.speed.z : m.speed.x; }
FN real3 velocityInOne_(real4 mirror, real speed, real3 v) { return v - mirror.xyz * ((dot(mirror.xyz, v) - speed) * 2.0f); }
FN real3 velocityInSeveral_(Reflections m, int image, real3 velocity) {
    real3 v = velocity;
    if ((image & 1) != 0) v = velocityInOne_(m.first, m.speed.x, v);
    if ((image & 2) != 0) v = velocityInOne_(m.second, m.speed.y, v);
    if ((image & 4) != 0) v = velocityInOne_(m.third, m.speed.z, v);
    return v;
}
// The near walls of particle i, as a variable `m`.
#define LOAD_REFLECTIONS(m, i)                              \
    Reflections m;                                          \
    m.first = LOAD4_AT(nearWalls, i, 0u);                   \
    m.second = LOAD4_AT(nearWalls, i, PARAMS.count);        \
    m.third = LOAD4_AT(nearWalls, i, 2u * PARAMS.count);    \
    m.speed = LOAD4_AT(nearWalls, i, 3u * PARAMS.count).xyz;
#define FOR_IMAGES(i)                                                                                                                  \
    {                                                                                                                                  \
        LOAD_REFLECTIONS(mirrors_, i)                                                                                                  \
        int near_ = within_(mirrors_.first, PARAMS.h) + 2 * within_(mirrors_.second, PARAMS.h) + 4 * within_(mirrors_.third, PARAMS.h); \
        for (int image_ = 0; image_ < 8; ++image_) {                                                                                   \
            if ((image_ & near_) != image_) continue;                                                                                  \
            bool one_ = image_ == 1 || image_ == 2 || image_ == 4;                                                                     \
            real4 mirror_ = image_ == 2 ? mirrors_.second : image_ == 4 ? mirrors_.third : mirrors_.first;                             \
            real far_ = beyond_(mirrors_, image_, PARAMS.h);
#define END_IMAGES \
    }              \
    }
#define SEEN(d)                                                                      \
    (image_ == 0 ? (d)                                                               \
     : one_      ? seenInOne_(mirrors_, image_, mirror_, d, PARAMS.h)                \
                 : seenInSeveral_(mirrors_, image_, far_, d, PARAMS.h))
#define SEEN_VELOCITY(v)                                                             \
    (image_ == 0 ? real3(v)                                                          \
     : one_      ? velocityInOne_(mirror_, speedOf_(mirrors_, image_), real3(v))                         \
                 : velocityInSeveral_(mirrors_, image_, real3(v)))
#define IMAGE image_
// True if neighbour j is too far from all walls for an image within the support radius.
#define NO_IMAGE(j) (image_ > 0 && LOADW(nearWalls, j) >= PARAMS.h)
#endif
