// Neighbours in worlds with different particles (MATTER): several liquids (number density: Solenthaler and Pajarola 2008), or body samples
// (Akinci et al. 2012), which have their own volume, and pressure 0 in their entry. Without MATTER every particle is
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
// The factor of a particle's own pressure in a pair: at a sample it counts for the sample too.
#define MIRRORED(own) ((own) * (other_.w < 0.0f ? 2.0f : 1.0f))
// The additional pressure at a sample, extrapolated hydrostatically (Adami et al. 2012): `rise` from the sample to the particle,
// limited by the pressure itself. push_samples does the same.
#define FOLLOWED(rise, own) SELECT(other_.w < 0.0f, max(min(-(rise), max0(own)), -max0(own)), 0.0f)
// 0 at a sample.
#define FLUID_ONLY(term) ((term) * (other_.w < 0.0f ? 0.0f : 1.0f))
// Multiplied by the reference rest density over that of the neighbour; 0 for samples.
#define INERT(term) ((term)*other_.y)
// Factor from a force over the mass of a particle of the reference liquid to the acceleration of this particle.
#define LIGHTNESS LOADY(matter, i)
// The viscosity of a pair: the harmonic mean of dynamic viscosities; at a no-slip sample the viscosity of the fluid.
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
