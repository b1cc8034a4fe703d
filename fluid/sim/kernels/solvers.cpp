#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

#define PAIR_KERNEL "shaders/fluid/methods/pbf_lambda.kernel"
#define PAIR_UNIT lambda
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/methods/pbf_shift.kernel"
#define PAIR_UNIT shift
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/methods/dfsph_density.kernel"
#define PAIR_UNIT density
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/methods/dfsph_rate.kernel"
#define PAIR_UNIT rate
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/methods/dfsph_push.kernel"
#define PAIR_UNIT push
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
namespace predict {
#include "shaders/fluid/methods/pbf_predict.kernel"
}
namespace finish {
#include "shaders/fluid/methods/pbf_finish.kernel"
}
#define OPEN 1
#undef RIVULET_GRID_H  // each form has its own StepParams
namespace predict_open {
#include "shaders/fluid/methods/pbf_predict.kernel"
}
namespace finish_open {
#include "shaders/fluid/methods/pbf_finish.kernel"
}
#undef OPEN
namespace begin {
#include "shaders/fluid/methods/dfsph_begin.kernel"
}
namespace end {
#include "shaders/fluid/methods/dfsph_end.kernel"
}
namespace residual_unit {
#include "shaders/fluid/methods/residual.kernel"
}
#define DENSITY 1
namespace residual_density {
#include "shaders/fluid/methods/residual.kernel"
}
#undef DENSITY
namespace set_ratio_unit {
#include "shaders/fluid/world/set_ratio.kernel"
}
namespace kick_unit {
#include "shaders/fluid/methods/kick.kernel"
}
namespace weigh_unit {
#include "shaders/fluid/forces/weigh.kernel"
}

}  // namespace

std::span<const CpuKernelRow> solverRows() {
    static const CpuKernelRow rows[] = {
        PAIR_ROWS(lambda, methods, pbf_lambda, ""),
        OPEN_ROWS(lambda, methods, pbf_lambda, ""),
        PAIR_ROWS(shift, methods, pbf_shift, ""),
        OPEN_ROWS(shift, methods, pbf_shift, ""),
        PAIR_ROWS(density, methods, dfsph_density, ""),
        OPEN_ROWS(density, methods, dfsph_density, ""),
        PAIR_ROWS(rate, methods, dfsph_rate, ""),
        OPEN_ROWS(rate, methods, dfsph_rate, ""),
        PAIR_ROWS(push, methods, dfsph_push, ""),
        OPEN_ROWS(push, methods, dfsph_push, ""),
        {"fluid/methods/pbf_predict", "", RIVULET_UNIT_ISA, predict::pbf_predict, 1024},
        {"fluid/methods/pbf_finish", "", RIVULET_UNIT_ISA, finish::pbf_finish, 1024},
        {"fluid/methods/pbf_predict", "OPEN=1", RIVULET_UNIT_ISA, predict_open::pbf_predict, 1024},
        {"fluid/methods/pbf_finish", "OPEN=1", RIVULET_UNIT_ISA, finish_open::pbf_finish, 1024},
        {"fluid/methods/dfsph_begin", "", RIVULET_UNIT_ISA, begin::dfsph_begin, 1024},
        {"fluid/methods/dfsph_end", "", RIVULET_UNIT_ISA, end::dfsph_end, 1024},
        {"fluid/methods/residual", "", RIVULET_UNIT_ISA, residual_unit::residual, 128},
        {"fluid/methods/residual", "DENSITY=1", RIVULET_UNIT_ISA, residual_density::residual, 128},
        {"fluid/world/set_ratio", "", RIVULET_UNIT_ISA, set_ratio_unit::set_ratio, 1024},
        {"fluid/methods/kick", "", RIVULET_UNIT_ISA, kick_unit::kick, 1024},
        {"fluid/forces/weigh", "", RIVULET_UNIT_ISA, weigh_unit::weigh, 1024},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
