#include "fluid/sim/forces/force.h"
#include "fluid/sim/forces/force_surface.h"
#include "fluid/sim/forces/force_viscosity.h"

namespace rivulet {

Table<ForceRow> forces() {
    static constexpr ForceRow rows[] = {
        {"normals", "normals of the surface, to look at", normalsOn, makeNormals},
        {"thesis_tension", "the thesis's surface tension (8) from its normals (7)", thesisTensionOn, makeThesisTension},
        {"tension", "surface tension as a stress along the surface, adhesion to walls and bodies (Akinci et al. 2013)", cohesionOn,
         makeCohesion},
        {"vorticity", "vorticity confinement (Macklin and Mueller 2013)", vorticityOn, makeVorticity},
        {"air", "drag of the air and push of the wind on what is open to them (Gissler et al. 2017, simplified)", airOn, makeAir},
        // Last: solved for implicitly it wants to know where all the others lead.
        {"viscosity", "friction inside the fluid, explicit or implicit, and at walls that do not slip", viscosityOn, makeViscosity},
    };
    return {rows};
}

}  // namespace rivulet
