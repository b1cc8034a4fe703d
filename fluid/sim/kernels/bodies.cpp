#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

namespace place {
#include "shaders/fluid/solids/place_samples.kernel"
}
namespace index_unit {
#include "shaders/fluid/solids/index_samples.kernel"
}
namespace loads {
#include "shaders/fluid/solids/sum_loads.kernel"
}
namespace wet_plain {
#include "shaders/fluid/solids/wet_samples.kernel"
}
namespace push_plain {
#include "shaders/fluid/solids/push_samples.kernel"
}
#define FRICTION 1
namespace push_friction {
#include "shaders/fluid/solids/push_samples.kernel"
}
#define CUBIC 1
namespace wet_cubic {
#include "shaders/fluid/solids/wet_samples.kernel"
}
namespace push_cubic {
#include "shaders/fluid/solids/push_samples.kernel"
}
#define PERIODIC 1
namespace wet_cubic_periodic {
#include "shaders/fluid/solids/wet_samples.kernel"
}
namespace push_cubic_periodic {
#include "shaders/fluid/solids/push_samples.kernel"
}
#undef CUBIC
namespace wet_periodic {
#include "shaders/fluid/solids/wet_samples.kernel"
}
namespace push_friction_periodic {
#include "shaders/fluid/solids/push_samples.kernel"
}
#undef FRICTION
namespace push_periodic {
#include "shaders/fluid/solids/push_samples.kernel"
}
#undef PERIODIC

}  // namespace

std::span<const CpuKernelRow> bodyRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/solids/place_samples", "", RIVULET_UNIT_ISA, place::place_samples, 1024},
        {"fluid/solids/index_samples", "", RIVULET_UNIT_ISA, index_unit::index_samples, 1024},
        {"fluid/solids/sum_loads", "", RIVULET_UNIT_ISA, loads::sum_loads, 64},
        {"fluid/solids/wet_samples", "", RIVULET_UNIT_ISA, wet_plain::wet_samples, 64},
        {"fluid/solids/wet_samples", "PERIODIC=1", RIVULET_UNIT_ISA, wet_periodic::wet_samples, 64},
        {"fluid/solids/wet_samples", "CUBIC=1", RIVULET_UNIT_ISA, wet_cubic::wet_samples, 64},
        {"fluid/solids/wet_samples", "CUBIC=1;PERIODIC=1", RIVULET_UNIT_ISA, wet_cubic_periodic::wet_samples, 64},
        {"fluid/solids/push_samples", "", RIVULET_UNIT_ISA, push_plain::push_samples, 64},
        {"fluid/solids/push_samples", "PERIODIC=1", RIVULET_UNIT_ISA, push_periodic::push_samples, 64},
        {"fluid/solids/push_samples", "FRICTION=1", RIVULET_UNIT_ISA, push_friction::push_samples, 64},
        {"fluid/solids/push_samples", "FRICTION=1;PERIODIC=1", RIVULET_UNIT_ISA, push_friction_periodic::push_samples, 64},
        {"fluid/solids/push_samples", "CUBIC=1;FRICTION=1", RIVULET_UNIT_ISA, push_cubic::push_samples, 64},
        {"fluid/solids/push_samples", "CUBIC=1;FRICTION=1;PERIODIC=1", RIVULET_UNIT_ISA, push_cubic_periodic::push_samples, 64},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
