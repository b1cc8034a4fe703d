// Mirror images of the neighbours behind the walls near a particle (Libersky et al. 1993): a wall is a plane of symmetry. The loop
// FOR_IMAGES .. END_IMAGES around a loop over the neighbours runs it once for the neighbours themselves (image 0), and once for their
// reflections in each wall, edge and corner of the particle's near walls. SEEN(d) is the vector to the particle from the neighbour's image,
// for d from the neighbour itself; SEEN_VELOCITY(v) is the image's velocity. A particle is among its own images. The loop over the
// neighbours is FOR_SEEN, in a step's first sweep FOR_ALL_SEEN with KEEP and MAY_SEE.
// An image is never nearer than its neighbour, so the loop over the neighbours finds all. Between plane walls the images of i for j are
// those of j for i: forces from densities conserve energy, and momentum along the wall; what is left is the load on the wall.
// Include after BUFFERS, with the buffer `nearWalls`. In a world without walls (OPEN) all of this is nothing.
#undef FOR_IMAGES
#undef END_IMAGES
#undef SEEN
#undef SEEN_VELOCITY
#undef IMAGE
#undef MAY_SEE
#undef SKIP_IMAGE
#undef NEAR_IMAGES_
#undef IMAGE_WALLS_
#undef SEEN_IN_ANY_
#undef VELOCITY_IN_ANY_
#undef FORM_
#undef LOAD_REFLECTIONS
#if defined(OPEN) || defined(WITHOUT_IMAGES)
#define FOR_IMAGES(i) {
#define END_IMAGES }
#define SEEN(d) (d)
#define SEEN_VELOCITY(v) (v)
#define IMAGE 0
#define MAY_SEE(d, reach) false
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
FN int within_(real4 wall, float h) { return ANY_LANE(wall.w < h) ? 1 : 0; }
// An image behind an edge is this many times as far: 1 for walls at right angles. Between others such images are not needed (the images of
// the walls cover the edge already, or nearly), and more than 10 times as far is beyond the support.
FN real beyondEdge_(real4 a, real4 b) {
    real c = dot(a.xyz, b.xyz);
    return 1.0f + max0(max(c, -c) - 0.45f) * 20.0f;
}
FN real beyond_(Reflections m, int image) {
    real far_ = 1.0f;
    if ((image & 3) == 3) far_ = max(far_, beyondEdge_(m.first, m.second));
    if ((image & 5) == 5) far_ = max(far_, beyondEdge_(m.first, m.third));
    if ((image & 6) == 6) far_ = max(far_, beyondEdge_(m.second, m.third));
    return far_;
}
// A neighbour behind the plane of a curved wall has no image in front of it: its image moves away behind the wall instead, without a jump.
FN real3 reflected_(real4 wall, real3 d) {
    real before = wall.w - dot(wall.xyz, d);
    return d + wall.xyz * (max(before, before * -4.0f) * 2.0f);
}
// At most the distance from the particle to the nearest image of the neighbour at d.
FN real nearestImage_(Reflections m, real3 d) {
    real a = m.first.w * 2.0f - dot(m.first.xyz, d);
    real b = m.second.w * 2.0f - dot(m.second.xyz, d);
    real c = m.third.w * 2.0f - dot(m.third.xyz, d);
    return min(min(a, b), c);
}
FN real depthBehind_(real4 wall, real3 d) { return dot(wall.xyz, d) - wall.w; }
FN real3 seenInSeveral_(Reflections m, int image, real far_, real3 apart) {
    real3 d = apart;
    if ((image & 1) != 0) d = reflected_(m.first, d);
    if ((image & 2) != 0) d = reflected_(m.second, d);
    if ((image & 4) != 0) d = reflected_(m.third, d);
    return d * far_;
}
// Where walls meet at an obtuse angle, their images overlap. An image that is deeper behind another wall than behind its own is among the
// images of that wall already: it moves out of reach, the faster the deeper it is.
FN real3 seenInOne_(Reflections m, real4 mirror, real3 apart) {
    real3 d = reflected_(mirror, apart);
    real deepest = max(max(depthBehind_(m.first, d), depthBehind_(m.second, d)), depthBehind_(m.third, d));
    return d + mirror.xyz * ((deepest - depthBehind_(mirror, d)) * 8.0f);
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
// The near walls of particle i, as a variable `m`. Images lie behind the wall even of a particle that was pushed through it.
#define LOAD_REFLECTIONS(m, i)                                                  \
    Reflections m;                                                              \
    m.first = LOAD4_AT(nearWalls, i, 0u);                                       \
    m.second = LOAD4_AT(nearWalls, i, PARAMS.count);                            \
    m.third = LOAD4_AT(nearWalls, i, 2u * PARAMS.count);                        \
    m.first.w = max(m.first.w, 0.02f * PARAMS.h);                               \
    m.second.w = max(m.second.w, 0.02f * PARAMS.h);                             \
    m.third.w = max(m.third.w, 0.02f * PARAMS.h);                               \
    m.speed = LOAD4_AT(nearWalls, i, 3u * PARAMS.count).xyz;
#define NEAR_IMAGES_(m) (within_(m.first, PARAMS.h) + 2 * within_(m.second, PARAMS.h) + 4 * within_(m.third, PARAMS.h))
// The wall of an image in one wall, and how many times as far an image behind an edge is.
#define IMAGE_WALLS_                                                                                           \
    bool one_ = image_ == 1 || image_ == 2 || image_ == 4;                                                     \
    real4 mirror_ = image_ == 2 ? mirrors_.second : image_ == 4 ? mirrors_.third : mirrors_.first;             \
    real far_ = beyond_(mirrors_, image_);
#define SEEN_IN_ANY_(d) (one_ ? seenInOne_(mirrors_, mirror_, d) : seenInSeveral_(mirrors_, image_, far_, d))
#define VELOCITY_IN_ANY_(v) \
    (one_ ? velocityInOne_(mirror_, speedOf_(mirrors_, image_), real3(v)) : velocityInSeveral_(mirrors_, image_, real3(v)))
#if defined(__cplusplus)
// The sweeps over the neighbours themselves (form 0), over the images in a wall alone (1) and over others (2) are compiled apart: most
// groups of particles need no more than the first, most of the others no more than the second.
template <int N>
struct SweepForm {
    static constexpr int value = N;
};
#define FORM_ decltype(form_)::value
#define FOR_IMAGES(i)                                                                                          \
    {                                                                                                          \
        LOAD_REFLECTIONS(mirrors_, i)                                                                          \
        const int near_ = NEAR_IMAGES_(mirrors_);                                                              \
        const auto sweep_ = [&](auto form_, [[maybe_unused]] int image_) __attribute__((always_inline)) {
#define END_IMAGES                                                                                             \
        };                                                                                                     \
        sweep_(SweepForm<0>{}, 0);                                                                             \
        if (near_ == 1) sweep_(SweepForm<1>{}, 1);                                                             \
        if (near_ > 1)                                                                                         \
            for (int k_ = 1; k_ < 8; ++k_)                                                                     \
                if ((k_ & near_) == k_) sweep_(SweepForm<2>{}, k_);                                            \
    }
template <int N>
INLINE real3 seenIn_(const Reflections& mirrors_, int image_, const real3& d) {
    if constexpr (N == 0) return d;
    if constexpr (N == 1) return reflected_(mirrors_.first, d);
    IMAGE_WALLS_
    return SEEN_IN_ANY_(d);
}
template <int N>
INLINE real3 velocitySeenIn_(const Reflections& mirrors_, int image_, const real3& v) {
    if constexpr (N == 0) return v;
    if constexpr (N == 1) return velocityInOne_(mirrors_.first, mirrors_.speed.x, v);
    IMAGE_WALLS_
    (void)far_;
    return VELOCITY_IN_ANY_(v);
}
#define SEEN(d) seenIn_<FORM_>(mirrors_, image_, d)
#define SEEN_VELOCITY(v) velocitySeenIn_<FORM_>(mirrors_, image_, real3(v))
#define IMAGE (FORM_ == 0 ? 0 : image_)
#define SKIP_IMAGE return
#else
#define FOR_IMAGES(i)                                          \
    {                                                          \
        LOAD_REFLECTIONS(mirrors_, i)                          \
        int near_ = NEAR_IMAGES_(mirrors_);                    \
        for (int image_ = 0; image_ < 8; ++image_) {           \
            if ((image_ & near_) != image_) continue;          \
            IMAGE_WALLS_
#define END_IMAGES \
    }              \
    }
#define SEEN(d) (image_ == 0 ? (d) : SEEN_IN_ANY_(d))
#define SEEN_VELOCITY(v) (image_ == 0 ? real3(v) : VELOCITY_IN_ANY_(v))
#define IMAGE image_
#define SKIP_IMAGE continue
#endif
// True if an image of the neighbour at d from the particle may be within reach, m.
#define MAY_SEE(d, reach) (near_ != 0 && ANY_LANE(nearestImage_(mirrors_, d) < (reach)))
#endif
