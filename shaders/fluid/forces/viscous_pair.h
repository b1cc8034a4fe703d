// The pair term of laminar viscosity, shared by the explicit and the implicit pass. Include after fluid/world/matter.h and
// fluid/methods/shape.h. VISCOUS_OWN goes before the loop and loads the values of i. The acceleration is viscousFactor_ * sum d
// VOLUME(VISCOUS_PAIR(v_ij . d) slope).
#undef VISCOUS_OWN
#undef VISCOUS_PAIR
#undef KINEMATIC
#define VISCOUS_K \
    (PARAMS.mass * PARAMS.gradientK / PARAMS.restDensity * 10.0f * VISCOUS_WEIGHT * PARAMS.invH * PARAMS.invH) /* 2 (dimension + 2) */
#if defined(MATTER)
#if defined(SAMPLES)
#define VISCOUS_OWN              \
    real mu_ = LOADZ(matter, i); \
    real viscousFactor_ = LOADX(matter, i) * (VISCOUS_K / PARAMS.restDensity); /* the whole of it: a force */
#define VISCOUS_PAIR(approach) ((approach) * (mu_ * (other_.w < 0.0f ? 0.0f : other_.z)))
#else
#define VISCOUS_OWN              \
    real mu_ = LOADZ(matter, i); \
    real viscousFactor_ = LIGHTNESS * (VISCOUS_K / PARAMS.restDensity);
#define VISCOUS_PAIR(approach) ((approach)*PAIR_VISCOSITY(mu_))
#endif
#define KINEMATIC (LOADZ(matter, i) * LOADY(matter, i) * (1.0f / PARAMS.restDensity)) /* m^2/s, of particle i */
#else
#define VISCOUS_OWN float viscousFactor_ = VISCOUS_K * PARAMS.viscosity;
#define VISCOUS_PAIR(approach) (approach)
#define KINEMATIC PARAMS.viscosity
#endif
