#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

namespace boundary_walls {
#include "shaders/fluid/solids/boundary.kernel"
}
#define FIELD 1
namespace boundary_field {
#include "shaders/fluid/solids/boundary.kernel"
}
#undef FIELD
namespace integrate_unit {
#include "shaders/fluid/methods/integrate.kernel"
}
#define COAST 1
namespace integrate_coast {
#include "shaders/fluid/methods/integrate.kernel"
}
#define OPEN 1
namespace integrate_coast_open {
#include "shaders/fluid/methods/integrate.kernel"
}
#undef COAST
namespace integrate_open {
#include "shaders/fluid/methods/integrate.kernel"
}
#undef OPEN
namespace gather_matter_unit {
#include "shaders/fluid/world/gather_matter.kernel"
}
namespace wrap_unit {
#include "shaders/fluid/world/wrap.kernel"
}
#define FROM_POSITIONS 1
namespace wrap_from_positions {
#include "shaders/fluid/world/wrap.kernel"
}
#undef FROM_POSITIONS
namespace walls_unit {
#include "shaders/fluid/solids/walls.kernel"
}
namespace boundary_moving_unit {
#include "shaders/fluid/solids/boundary_moving.kernel"
}
namespace collide_still {
#include "shaders/fluid/solids/collide.kernel"
}
#define MOVING 1
namespace collide_moving {
#include "shaders/fluid/solids/collide.kernel"
}
#define DEFORMING 1
namespace collide_deforming {
#include "shaders/fluid/solids/collide.kernel"
}
#undef DEFORMING
#undef MOVING
#define THESIS 1
namespace collide_thesis {
#include "shaders/fluid/solids/collide.kernel"
}
#define MOVING 1
namespace collide_moving_thesis {
#include "shaders/fluid/solids/collide.kernel"
}
#define DEFORMING 1
namespace collide_deforming_thesis {
#include "shaders/fluid/solids/collide.kernel"
}
#undef DEFORMING
#undef MOVING
#undef THESIS
namespace remember_unit {
#include "shaders/fluid/world/remember.kernel"
}
namespace blend_unit {
#include "shaders/fluid/world/blend.kernel"
}
namespace stats_unit {
#include "shaders/fluid/world/stats.kernel"
}
#define MATTER 1
namespace stats_matter {
#include "shaders/fluid/world/stats.kernel"
}
#undef MATTER

}  // namespace

std::span<const CpuKernelRow> particleRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/solids/boundary", "", RIVULET_UNIT_ISA, boundary_walls::boundary, 1024},
        {"fluid/solids/boundary", "FIELD=1", RIVULET_UNIT_ISA, boundary_field::boundary, 1024},
        {"fluid/methods/integrate", "", RIVULET_UNIT_ISA, integrate_unit::integrate, 1024},
        {"fluid/methods/integrate", "COAST=1", RIVULET_UNIT_ISA, integrate_coast::integrate, 1024},
        {"fluid/methods/integrate", "OPEN=1", RIVULET_UNIT_ISA, integrate_open::integrate, 1024},
        {"fluid/methods/integrate", "COAST=1;OPEN=1", RIVULET_UNIT_ISA, integrate_coast_open::integrate, 1024},
        {"fluid/world/gather_matter", "", RIVULET_UNIT_ISA, gather_matter_unit::gather_matter, 1024},
        {"fluid/world/wrap", "", RIVULET_UNIT_ISA, wrap_unit::wrap, 1024},
        {"fluid/world/wrap", "FROM_POSITIONS=1", RIVULET_UNIT_ISA, wrap_from_positions::wrap, 1024},
        {"fluid/solids/walls", "", RIVULET_UNIT_ISA, walls_unit::walls, 1024},
        {"fluid/solids/boundary_moving", "", RIVULET_UNIT_ISA, boundary_moving_unit::boundary_moving, 1024},
        {"fluid/solids/collide", "", RIVULET_UNIT_ISA, collide_still::collide, 1024},
        {"fluid/solids/collide", "MOVING=1", RIVULET_UNIT_ISA, collide_moving::collide, 1024},
        {"fluid/solids/collide", "DEFORMING=1;MOVING=1", RIVULET_UNIT_ISA, collide_deforming::collide, 1024},
        {"fluid/solids/collide", "THESIS=1", RIVULET_UNIT_ISA, collide_thesis::collide, 1024},
        {"fluid/solids/collide", "MOVING=1;THESIS=1", RIVULET_UNIT_ISA, collide_moving_thesis::collide, 1024},
        {"fluid/solids/collide", "DEFORMING=1;MOVING=1;THESIS=1", RIVULET_UNIT_ISA, collide_deforming_thesis::collide, 1024},
        {"fluid/world/remember", "", RIVULET_UNIT_ISA, remember_unit::remember, 1024},
        {"fluid/world/blend", "", RIVULET_UNIT_ISA, blend_unit::blend, 1024},
        {"fluid/world/stats", "", RIVULET_UNIT_ISA, stats_unit::stats, 128},
        {"fluid/world/stats", "MATTER=1", RIVULET_UNIT_ISA, stats_matter::stats, 128},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
