#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
#undef RIVULET_WATER_H
namespace sample_unit {
#include "shaders/fluid/query/sample_water.kernel"
}
#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
#undef RIVULET_WATER_H
namespace cast_unit {
#include "shaders/fluid/query/cast_rays.kernel"
}
#undef RIVULET_GRID_H
#undef RIVULET_IN_VOLUME_H
namespace count_unit {
#include "shaders/fluid/query/count_volumes.kernel"
}

}  // namespace

std::span<const CpuKernelRow> queryRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/query/sample_water", "", RIVULET_UNIT_ISA, sample_unit::sample_water, 64},
        {"fluid/query/cast_rays", "", RIVULET_UNIT_ISA, cast_unit::cast_rays, 4},
        {"fluid/query/count_volumes", "", RIVULET_UNIT_ISA, count_unit::count_volumes, 4096},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
