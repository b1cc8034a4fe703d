#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace tait {
#include "shaders/fluid/wcsph_density.kernel"
}
namespace tait_forces {
#include "shaders/fluid/wcsph_forces.kernel"
}
#define THESIS 1
namespace thesis {
#include "shaders/fluid/wcsph_density.kernel"
}
namespace thesis_forces {
#include "shaders/fluid/wcsph_forces.kernel"
}
#undef THESIS

std::span<const CpuKernelRow> wcsphRows() {
    static const CpuKernelRow rows[] = {
        {"fluid/wcsph_density", "", RIVULET_UNIT_ISA, tait::wcsph_density, 64},
        {"fluid/wcsph_forces", "", RIVULET_UNIT_ISA, tait_forces::wcsph_forces, 64},
        {"fluid/wcsph_density", "THESIS=1", RIVULET_UNIT_ISA, thesis::wcsph_density, 64},
        {"fluid/wcsph_forces", "THESIS=1", RIVULET_UNIT_ISA, thesis_forces::wcsph_forces, 64},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
