#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

namespace map_caps_unit {
#include "shaders/flow/map_caps.kernel"
}
namespace map_thick_unit {
#include "shaders/flow/map_thick.kernel"
}
namespace map_bounds_unit {
#include "shaders/flow/map_bounds.kernel"
}
#undef RIVULET_CELLS_H
namespace map_touch_unit {
#include "shaders/flow/map_touch.kernel"
}
namespace map_taps_unit {
#include "shaders/flow/map_taps.kernel"
}
#undef RIVULET_WALK_H  // each of the two has its own
#define WHOLE 1
namespace map_rows_unit {
#include "shaders/flow/map_rows.kernel"
}
#undef WHOLE
namespace map_mips_unit {
#include "shaders/flow/map_mips.kernel"
}

}  // namespace

std::span<const CpuKernelRow> flowMapRows() {
    static const CpuKernelRow rows[] = {
        {"flow/map_caps", "", RIVULET_UNIT_ISA, map_caps_unit::map_caps, 256},
        {"flow/map_thick", "", RIVULET_UNIT_ISA, map_thick_unit::map_thick, 1024},
        {"flow/map_bounds", "", RIVULET_UNIT_ISA, map_bounds_unit::map_bounds, 256},
        {"flow/map_touch", "", RIVULET_UNIT_ISA, map_touch_unit::map_touch, 128},
        {"flow/map_taps", "", RIVULET_UNIT_ISA, map_taps_unit::map_taps, 1024},
        {"flow/map_rows", "WHOLE=1", RIVULET_UNIT_ISA, map_rows_unit::map_rows, 64},
        {"flow/map_mips", "", RIVULET_UNIT_ISA, map_mips_unit::map_mips, 512},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
