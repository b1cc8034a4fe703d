#include "fluid/validate/envelope.h"

namespace rivulet {

namespace {

constexpr EnvelopeRow kRows[] = {
    {"sound", "weakly compressible water rings apart where a step is longer than its pressure takes to answer",
     "dt = 0.4 hs / (c0 + v) (Monaghan 1992)",
     "The factor is a margin: symplectic Euler holds up to w dt = 2, and water with a free surface is nowhere as stiff as the formula "
     "takes it to be. The thesis's pressure makes energy of its own where it is stiffer than this (k = 100), whatever the step.",
     envelopeOfSound},
    {"viscosity", "explicit viscosity turns neighbours' differences round instead of evening them out",
     "dt = 0.125 hs^2 / nu (Morris, Fox and Zhu 1997)", "Solved for implicitly (fluid.forces.viscosity) there is no such step.",
     envelopeOfViscosity},
    {"tension", "a surface swings further than it came from where a step misses its shortest waves",
     "dt = 0.25 sqrt(rho hs^3 / (2 pi sigma)) (Brackbill, Kothe and Zemach 1992)", "", envelopeOfTension},
    {"large_steps", "who flies past a neighbour in one step has not met him", "v dt = 1 particle diameter", "", envelopeOfLargeSteps},
    {"frame_spike", "one frame hangs, and water falls through itself", "dt = sqrt(2 diameters / g)",
     "With the limits on the frame is of 250 ms: what is beyond fluid.longestFrame is dropped, and the rest stepped as the water asks. PBF "
     "fails a little early: its corrections bear shorter steps than that, see pbf.",
     envelopeOfSpikes},
    {"pbf", "position based water is as stiff as its iterations and its step let it be",
     "mean compression of a column H high after k iterations: a g H dt^2 / (2 k h^2)",
     "The step is that at which the floor of the column would be a tenth too dense. A single correction that goes the whole way "
     "(relaxation 1) overshoots, as Jacobi's iteration does, and fails before that; with half the way it holds.",
     envelopeOfPbf},
    {"dfsph", "pressure that begins as it ended may push twice", "warm start > 0 where it is not gated (Bender and Koschier 2017)",
     "There is no gate here, and none is missed: all of the last pressure as a start costs no stability.", envelopeOfDfsph},
    {"pairing", "with too many neighbours particles of a cubic spline sit together in pairs",
     "55 neighbours, Wendland C2 none up to 700 (Dehnen and Aly 2012)",
     "Steps play no part in this: what fails fails with the limits on, too.", envelopeOfPairing},
    {"clumping", "pressure below nothing pulls neighbours together, the nearer the harder",
     "density below the rest density (Swegle, Hicks and Attaway 1995)",
     "The thesis's pressure is below nothing at every free surface, so it clumps in any block: with the limits on, as all of this row was "
     "run. The other methods' pressure "
     "never pulls.",
     envelopeOfClumping},
    {"far_origin", "a float far from zero does not feel a small step", "ulp(x) / 2 = v dt",
     "With the limits on the place is the world's origin, a double, and coordinates are relative to it. A box that is itself so far away "
     "is warned of.",
     envelopeOfDistance},
    {"tunnelling", "who moves more than a wall's thickness in a step may never be in it", "v dt = the wall's thickness",
     "Nobody passes the exact walk at any step: every voxel on the way is asked. What fails beyond ten walls a step is that a slide along "
     "the sheet ends outside the box, where it is lost.",
     envelopeOfTunnelling},
    {"spawning", "particles born in each other, in a solid, alone, or not at all", "density 2 where two are in one place", "",
     envelopeOfSpawning},
    {"coupling", "a body lighter than the water it moves along is thrown farther each step, answered a step late",
     "density ratio 0.5: a ball's added mass (Causin, Gerbeau and Nobile 2005)",
     "The load acts through a fictitious mass, and the rest is owed (see fluid/sim/README.md): the instability of the added mass does not "
     "show.",
     envelopeOfCoupling},
};

}  // namespace

Table<EnvelopeRow> envelope() { return {kRows}; }

}  // namespace rivulet
