#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

#define PAIR_KERNEL "shaders/fluid/surface/foam_air.kernel"
#define PAIR_UNIT foam_air_unit
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/surface/foam_crest.kernel"
#define PAIR_UNIT foam_crest_unit
#include "fluid/sim/kernels/pair_forms.h"
#undef RIVULET_GRID_H
#undef RIVULET_AROUND_H
namespace foam_move_unit {
#include "shaders/fluid/surface/foam_move.kernel"
}
namespace foam_wanted_unit {
#include "shaders/fluid/surface/foam_wanted.kernel"
}
#undef RIVULET_FOAM_RANDOM_H
namespace foam_born_unit {
#include "shaders/fluid/surface/foam_born.kernel"
}
namespace foam_drawn_unit {
#include "shaders/fluid/surface/foam_drawn.kernel"
}

}  // namespace

std::span<const CpuKernelRow> foamRows() {
    static const CpuKernelRow rows[] = {
        PAIR_ROWS(foam_air_unit, surface, foam_air, ""),
        PAIR_ROWS(foam_crest_unit, surface, foam_crest, ""),
        {"fluid/surface/foam_move", "", RIVULET_UNIT_ISA, foam_move_unit::foam_move, 64},
        {"fluid/surface/foam_wanted", "", RIVULET_UNIT_ISA, foam_wanted_unit::foam_wanted, 4096},
        {"fluid/surface/foam_born", "", RIVULET_UNIT_ISA, foam_born_unit::foam_born, 1024},
        {"fluid/surface/foam_drawn", "", RIVULET_UNIT_ISA, foam_drawn_unit::foam_drawn, 4096},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
