// Tension without clumping (after Monaghan 2000): what the slope of the smoothing kernel is multiplied by in a pair whose pressure is negative.
// With the kernel's own slope such pairs attract the more the nearer they are, and particles clump while densities stay right (Swegle, Hicks
// and Attaway 1995). As in the artificial stress of Monaghan 2000, neighbours nearer than usual must repel under tension. Here the weight is
// linear: negative below 0.9 spacings, and scaled so that a uniform pressure in a lattice pulls by its full value (pullScale). Pair forces
// stay equal, opposite and central.
#undef PULL
#define PULL(r) ((r) * (PARAMS.pullScale / PARAMS.spacing) - 0.9f * PARAMS.pullScale)
