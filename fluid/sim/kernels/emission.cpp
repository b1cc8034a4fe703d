#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

// grid.h and around.h are included once a unit: here once a form, with the form's own StepParams.
#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
namespace emit_plain {
#include "shaders/fluid/sources/emit.kernel"
}
#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
#define MATTER 1
namespace emit_matter {
#include "shaders/fluid/sources/emit.kernel"
}
#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
#define ABSORPTION 1
namespace emit_matter_absorption {
#include "shaders/fluid/sources/emit.kernel"
}
#undef MATTER
#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
namespace emit_absorption {
#include "shaders/fluid/sources/emit.kernel"
}
#undef ABSORPTION
#undef RIVULET_IN_VOLUME_H
namespace drain_unit {
#include "shaders/fluid/sources/drain.kernel"
}
namespace forget_unit {
#include "shaders/fluid/sources/forget.kernel"
}
#undef RIVULET_GRID_H
namespace cell_of_unit {
#include "shaders/fluid/grid/cell_of.kernel"
}
namespace within_unit {
#include "shaders/fluid/sources/within.kernel"
}
namespace take_unit {
#include "shaders/fluid/sources/take.kernel"
}
namespace gather_unit {
#include "shaders/fluid/world/gather_absorption.kernel"
}

}  // namespace

std::span<const CpuKernelRow> emissionRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/sources/emit", "", RIVULET_UNIT_ISA, emit_plain::emit, 64},
        {"fluid/sources/emit", "MATTER=1", RIVULET_UNIT_ISA, emit_matter::emit, 64},
        {"fluid/sources/emit", "ABSORPTION=1", RIVULET_UNIT_ISA, emit_absorption::emit, 64},
        {"fluid/sources/emit", "ABSORPTION=1;MATTER=1", RIVULET_UNIT_ISA, emit_matter_absorption::emit, 64},
        {"fluid/sources/drain", "", RIVULET_UNIT_ISA, drain_unit::drain, 1024},
        {"fluid/sources/forget", "", RIVULET_UNIT_ISA, forget_unit::forget, 1024},
        {"fluid/grid/cell_of", "", RIVULET_UNIT_ISA, cell_of_unit::cell_of, 1024},
        {"fluid/sources/within", "", RIVULET_UNIT_ISA, within_unit::within, 1024},
        {"fluid/sources/take", "", RIVULET_UNIT_ISA, take_unit::take, 1024},
        {"fluid/world/gather_absorption", "", RIVULET_UNIT_ISA, gather_unit::gather_absorption, 1024},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
