#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

#define PAIR_KERNEL "shaders/fluid/forces/viscosity.kernel"
#define PAIR_UNIT explicit_viscosity
#include "fluid/sim/kernels/pair_forms.h"
#define SAMPLES 1
#define MATTER 1
namespace viscosity_samples {
#include "shaders/fluid/forces/viscosity.kernel"
}
#define PERIODIC 1
namespace viscosity_samples_periodic {
#include "shaders/fluid/forces/viscosity.kernel"
}
#undef PERIODIC
#undef MATTER
#undef SAMPLES
#define PAIR_KERNEL "shaders/fluid/forces/viscous_sweep.kernel"
#define PAIR_UNIT viscous_apply
#include "fluid/sim/kernels/pair_forms.h"
#define START 1
#define PAIR_KERNEL "shaders/fluid/forces/viscous_sweep.kernel"
#define PAIR_UNIT viscous_start
#include "fluid/sim/kernels/pair_forms.h"
#undef START
namespace friction_walls {
#include "shaders/fluid/forces/wall_friction.kernel"
}
#define FIELD 1
namespace friction_field {
#include "shaders/fluid/forces/wall_friction.kernel"
}
#undef FIELD
namespace friction_moving {
#include "shaders/fluid/forces/wall_friction_moving.kernel"
}
namespace drag_unit {
#include "shaders/fluid/forces/wall_drag.kernel"
}
namespace guess_unit {
#include "shaders/fluid/forces/viscous_guess.kernel"
}
#define MATTER 1
namespace drag_matter {
#include "shaders/fluid/forces/wall_drag.kernel"
}
namespace guess_matter {
#include "shaders/fluid/forces/viscous_guess.kernel"
}
#undef MATTER
namespace sum_unit {
#include "shaders/fluid/forces/viscous_sum.kernel"
}
namespace scalars_unit {
#include "shaders/fluid/forces/viscous_scalars.kernel"
}
namespace update_unit {
#include "shaders/fluid/forces/viscous_update.kernel"
}
namespace finish_unit {
#include "shaders/fluid/forces/viscous_finish.kernel"
}
#define PAIR_KERNEL "shaders/fluid/forces/normals.kernel"
#define PAIR_UNIT normals_gradient
#include "fluid/sim/kernels/pair_forms.h"
#define WALLED 1
#define PAIR_KERNEL "shaders/fluid/forces/normals.kernel"
#define PAIR_UNIT normals_walled
#include "fluid/sim/kernels/pair_forms.h"
#undef WALLED
#define COULOMB 1
#define PAIR_KERNEL "shaders/fluid/forces/normals.kernel"
#define PAIR_UNIT normals_coulomb
#include "fluid/sim/kernels/pair_forms.h"
#undef COULOMB
#define PAIR_KERNEL "shaders/fluid/surface/ellipsoids.kernel"
#define PAIR_UNIT ellipsoids_unit
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/forces/tension_thesis.kernel"
#define PAIR_UNIT tension
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/forces/cohesion.kernel"
#define PAIR_UNIT cohesion_unit
#include "fluid/sim/kernels/pair_forms.h"
#define SAMPLES 1
#define MATTER 1
namespace cohesion_samples {
#include "shaders/fluid/forces/cohesion.kernel"
}
#define PERIODIC 1
namespace cohesion_samples_periodic {
#include "shaders/fluid/forces/cohesion.kernel"
}
#undef PERIODIC
#undef MATTER
#undef SAMPLES
namespace adhesion_walls {
#include "shaders/fluid/forces/wall_adhesion.kernel"
}
#define FIELD 1
namespace adhesion_field {
#include "shaders/fluid/forces/wall_adhesion.kernel"
}
#undef FIELD
#define PAIR_KERNEL "shaders/fluid/forces/vorticity.kernel"
#define PAIR_UNIT vorticity_unit
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/forces/confinement.kernel"
#define PAIR_UNIT confinement_unit
#include "fluid/sim/kernels/pair_forms.h"
namespace air_unit {
#include "shaders/fluid/forces/air.kernel"
}
#define MATTER 1
namespace air_matter {
#include "shaders/fluid/forces/air.kernel"
}
#undef MATTER

}  // namespace

std::span<const CpuKernelRow> forceRows() {
    static const CpuKernelRow rows[] = {
        PAIR_ROWS(explicit_viscosity, forces, viscosity, ""),
        {"fluid/forces/viscosity", "MATTER=1;SAMPLES=1", RIVULET_UNIT_ISA, viscosity_samples::viscosity, 64},
        {"fluid/forces/viscosity", "MATTER=1;PERIODIC=1;SAMPLES=1", RIVULET_UNIT_ISA, viscosity_samples_periodic::viscosity, 64},
        PAIR_ROWS(viscous_apply, forces, viscous_sweep, ""),
        PAIR_ROWS(viscous_start, forces, viscous_sweep, "START=1"),
        PAIR_ROWS(normals_gradient, forces, normals, ""),
        PAIR_ROWS(normals_walled, forces, normals, "WALLED=1"),
        PAIR_ROWS(normals_coulomb, forces, normals, "COULOMB=1"),
        PAIR_ROWS(ellipsoids_unit, surface, ellipsoids, ""),
        PAIR_ROWS(tension, forces, tension_thesis, ""),
        PAIR_ROWS(cohesion_unit, forces, cohesion, ""),
        {"fluid/forces/cohesion", "MATTER=1;SAMPLES=1", RIVULET_UNIT_ISA, cohesion_samples::cohesion, 64},
        {"fluid/forces/cohesion", "MATTER=1;PERIODIC=1;SAMPLES=1", RIVULET_UNIT_ISA, cohesion_samples_periodic::cohesion, 64},
        PAIR_ROWS(vorticity_unit, forces, vorticity, ""),
        PAIR_ROWS(confinement_unit, forces, confinement, ""),
        {"fluid/forces/wall_adhesion", "", RIVULET_UNIT_ISA, adhesion_walls::wall_adhesion, 1024},
        {"fluid/forces/wall_adhesion", "FIELD=1", RIVULET_UNIT_ISA, adhesion_field::wall_adhesion, 1024},
        {"fluid/forces/air", "", RIVULET_UNIT_ISA, air_unit::air, 1024},
        {"fluid/forces/air", "MATTER=1", RIVULET_UNIT_ISA, air_matter::air, 1024},
        {"fluid/forces/wall_friction", "", RIVULET_UNIT_ISA, friction_walls::wall_friction, 1024},
        {"fluid/forces/wall_friction", "FIELD=1", RIVULET_UNIT_ISA, friction_field::wall_friction, 1024},
        {"fluid/forces/wall_friction_moving", "", RIVULET_UNIT_ISA, friction_moving::wall_friction_moving, 1024},
        {"fluid/forces/wall_drag", "", RIVULET_UNIT_ISA, drag_unit::wall_drag, 1024},
        {"fluid/forces/wall_drag", "MATTER=1", RIVULET_UNIT_ISA, drag_matter::wall_drag, 1024},
        {"fluid/forces/viscous_guess", "", RIVULET_UNIT_ISA, guess_unit::viscous_guess, 1024},
        {"fluid/forces/viscous_guess", "MATTER=1", RIVULET_UNIT_ISA, guess_matter::viscous_guess, 1024},
        {"fluid/forces/viscous_sum", "", RIVULET_UNIT_ISA, sum_unit::viscous_sum, 128},
        {"fluid/forces/viscous_scalars", "", RIVULET_UNIT_ISA, scalars_unit::viscous_scalars, 1},
        {"fluid/forces/viscous_update", "", RIVULET_UNIT_ISA, update_unit::viscous_update, 1024},
        {"fluid/forces/viscous_finish", "", RIVULET_UNIT_ISA, finish_unit::viscous_finish, 1024},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
