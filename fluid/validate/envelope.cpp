#include "fluid/validate/envelope.h"

namespace rivulet {

namespace {

constexpr EnvelopeRow kRows[] = {
    {"sound", "weakly compressible water becomes unstable if a step is longer than its pressure needs to respond",
     "dt = 0.4 hs / (c0 + v) (Monaghan 1992)",
     "The factor is a margin: symplectic Euler is stable up to w dt = 2, and water with a free surface is less stiff than the formula "
     "assumes. The thesis's pressure adds energy at any step if it is stiffer than this (k = 100).",
     envelopeOfSound},
    {"viscosity", "explicit viscosity reverses velocity differences between neighbours instead of damping them",
     "dt = 0.125 hs^2 / nu (Morris, Fox and Zhu 1997)", "Implicit viscosity (fluid.forces.viscosity) has no such limit.",
     envelopeOfViscosity},
    {"tension", "the oscillation of a surface grows if a step does not resolve its shortest waves",
     "dt = 0.25 sqrt(rho hs^3 / (2 pi sigma)) (Brackbill, Kothe and Zemach 1992)", "", envelopeOfTension},
    {"large_steps", "a particle that passes a neighbour within one step never interacts with it", "v dt = 1 particle diameter", "",
     envelopeOfLargeSteps},
    {"frame_spike", "during one long frame, water falls through itself", "dt = sqrt(2 diameters / g)",
     "With the limits on the frame is 250 ms long: time beyond fluid.longestFrame is dropped, and the rest is divided into stable steps. "
     "PBF fails slightly early because its corrections allow only shorter steps, see pbf.",
     envelopeOfSpikes},
    {"pbf", "the stiffness of position based fluids depends on the iterations and the step",
     "mean compression of a column H high after k iterations: a g H dt^2 / (2 k h^2)",
     "The predicted step is the one at which water at the floor of the column is a tenth too dense. A single full correction (relaxation "
     "1) overshoots, as Jacobi's iteration does, and fails earlier; with relaxation 0.5 it holds.",
     envelopeOfPbf},
    {"dfsph", "a warm start of the pressure may add energy", "warm start > 0 where it is not gated (Bender and Koschier 2017)",
     "The implementation has no gate and needs none: a warm start with the whole last pressure costs no stability.", envelopeOfDfsph},
    {"pairing", "with too many neighbours, particles with a cubic spline kernel form pairs",
     "55 neighbours, Wendland C2 none up to 700 (Dehnen and Aly 2012)",
     "The step has no influence: a setting that fails also fails with the limits on.", envelopeOfPairing},
    {"clumping", "negative pressure pulls neighbours together, more strongly the nearer they are",
     "density below the rest density (Swegle, Hicks and Attaway 1995)",
     "The thesis's pressure is negative at every free surface, so its particles clump in any block. All runs of this section had the "
     "limits on. In the other methods it is never negative, except with fluid.dfsph.negativePressure, which moves particles apart.",
     envelopeOfClumping},
    {"far_origin", "far from zero, a float coordinate is too coarse for a small step", "ulp(x) / 2 = v dt",
     "With the limits on this position is the world's origin, a double, and coordinates are relative to it. The program warns of a box "
     "that itself lies so far away.",
     envelopeOfDistance},
    {"tunnelling", "a particle that moves more than the thickness of a wall in one step may never be inside it",
     "v dt = the wall's thickness",
     "No particle passes the exact walk at any step, because it checks every voxel on the path. Failures beyond ten walls per step are "
     "slides along the sheet that end outside the box, where the particle is lost.",
     envelopeOfTunnelling},
    {"spawning", "particles spawned inside each other, inside a solid, alone, or not at all", "density 2 where two are in one place", "",
     envelopeOfSpawning},
    {"coupling", "a body lighter than the water that it displaces oscillates with growing amplitude, because it responds one step late",
     "density ratio 0.5: a ball's added mass (Causin, Gerbeau and Nobile 2005)",
     "The load acts through a fictitious mass, and the remainder is applied later (see fluid/sim/solids/README.md): the added-mass "
     "instability "
     "does not occur.",
     envelopeOfCoupling},
};

}  // namespace

Table<EnvelopeRow> envelope() { return {kRows}; }

}  // namespace rivulet
