// Whether a particle is inside the fluid, by the divergence of the positions, -sum V d . grad W: it is 3 there, and less where neighbours
// are missing (Lee et al. 2008). It counts images behind walls and samples of bodies. Tension begins only well inside, because spray and
// thin films break; it ends where a surface has formed. With one limit between the two either siphons break or impacts on walls are too
// weak.
#undef TENSION_FROM_DIVERGENCE
#undef TENSION_TO_DIVERGENCE
#define TENSION_FROM_DIVERGENCE 2.7f
#define TENSION_TO_DIVERGENCE 2.2f
// The share, 0..1, of tension that is more than the noise of pressures in disorder. `effect`: of the pressure in a step, -p dt^2 / (rho
// spacing^2).
FN real sustained(real effect) { return min(max0((effect - 5.0e-4f) * 1000.0f), 1.0f); }
