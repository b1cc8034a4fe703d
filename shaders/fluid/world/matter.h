// What neighbours are where particles differ (MATTER): of several liquids (number density: Solenthaler and Pajarola 2008), or samples on
// bodies (Akinci et al. 2012), which have a volume of their own and, in their entry of any pressure, 0. Without MATTER every particle is
// one of the reference liquid, and all of this is nothing. Include before ARGS; MATTER_ARG is its last row. Particle and neighbour are i
// and j; MATTER_OTHER begins the loop.
#undef MATTER_ARG
#undef MATTER_OTHER
#undef VOLUME
#undef MIRRORED
#undef FOLLOWED
#undef INERT
#undef FLUID_ONLY
#undef LIGHTNESS
#undef PAIR_VISCOSITY
#if defined(MATTER)
// x volume / spacing^3; y reference rest density / own, 0 of samples; z dynamic viscosity, Pa s (of a sample: 2 = sticks, 0 = slips; see
// BodyPasses::matter); w < 0: a sample
#define MATTER_ARG(b, RO) RO(b, Matter, vec4, matter)
#define MATTER_OTHER vec4 other_ = matter[j];
#define VOLUME(term) ((term)*other_.x)
// How often a pair counts a particle's own pressure: at a sample for the sample, too.
#define MIRRORED(own) ((own) * (other_.w < 0.0f ? 2.0f : 1.0f))
// What more there is at a sample, where the pressure goes on as gravity has it (Adami et al. 2012): `rise` from the sample to the particle,
// at most as much as there is. push_samples does the same.
#define FOLLOWED(rise, own) SELECT(other_.w < 0.0f, max(min(-(rise), max0(own)), -max0(own)), 0.0f)
// Nothing at a sample.
#define FLUID_ONLY(term) ((term) * (other_.w < 0.0f ? 0.0f : 1.0f))
// Times how readily the other one moves.
#define INERT(term) ((term)*other_.y)
// What a force over the mass of a particle of the reference liquid is multiplied with to be this one's acceleration.
#define LIGHTNESS LOADY(matter, i)
// Of a pair: the harmonic mean of dynamic viscosities; at a sample the fluid's own, where it sticks.
#define PAIR_VISCOSITY(own) ((own)*other_.z * (other_.w < 0.0f ? 1.0f : 2.0f) / SELECT(other_.w < 0.0f, 1.0f, (own) + other_.z + 1.0e-30f))
#else
#define MATTER_ARG(b, RO)
#define MATTER_OTHER
#define VOLUME(term) (term)
#define MIRRORED(own) (own)
#define INERT(term) (term)
#define FLUID_ONLY(term) (term)
#define LIGHTNESS 1.0f
#endif
