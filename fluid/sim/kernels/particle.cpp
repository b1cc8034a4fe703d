#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

namespace boundary_walls {
#include "shaders/fluid/boundary.kernel"
}
#define FIELD 1
namespace boundary_field {
#include "shaders/fluid/boundary.kernel"
}
#undef FIELD
namespace integrate_unit {
#include "shaders/fluid/integrate.kernel"
}
namespace collide_unit {
#include "shaders/fluid/collide.kernel"
}
namespace stats_unit {
#include "shaders/fluid/stats.kernel"
}

}  // namespace

std::span<const CpuKernelRow> particleRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/boundary", "", RIVULET_UNIT_ISA, boundary_walls::boundary, 1024},
        {"fluid/boundary", "FIELD=1", RIVULET_UNIT_ISA, boundary_field::boundary, 1024},
        {"fluid/integrate", "", RIVULET_UNIT_ISA, integrate_unit::integrate, 1024},
        {"fluid/collide", "", RIVULET_UNIT_ISA, collide_unit::collide, 1024},
        {"fluid/stats", "", RIVULET_UNIT_ISA, stats_unit::stats, 128},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
