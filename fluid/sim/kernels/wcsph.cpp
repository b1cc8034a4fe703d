#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

#define PAIR_KERNEL "shaders/fluid/methods/wcsph_density.kernel"
#define PAIR_UNIT density
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/methods/wcsph_forces.kernel"
#define PAIR_UNIT forces
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define CUBIC 1
#define PAIR_KERNEL "shaders/fluid/methods/wcsph_density.kernel"
#define PAIR_UNIT cubic_density
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#define PAIR_KERNEL "shaders/fluid/methods/wcsph_forces.kernel"
#define PAIR_UNIT cubic_forces
#define PAIR_WALLED
#include "fluid/sim/kernels/pair_forms.h"
#undef CUBIC
#define THESIS 1
namespace thesis_density {
#include "shaders/fluid/methods/wcsph_density.kernel"
}
namespace thesis_forces {
#include "shaders/fluid/methods/wcsph_forces.kernel"
}
#undef THESIS

}  // namespace

std::span<const CpuKernelRow> wcsphRows() {
    static const CpuKernelRow rows[] = {
        PAIR_ROWS(density, methods, wcsph_density, ""),
        OPEN_ROWS(density, methods, wcsph_density, ""),
        PAIR_ROWS(forces, methods, wcsph_forces, ""),
        OPEN_ROWS(forces, methods, wcsph_forces, ""),
        PAIR_ROWS(cubic_density, methods, wcsph_density, "CUBIC=1"),
        OPEN_ROWS(cubic_density, methods, wcsph_density, "CUBIC=1"),
        PAIR_ROWS(cubic_forces, methods, wcsph_forces, "CUBIC=1"),
        OPEN_ROWS(cubic_forces, methods, wcsph_forces, "CUBIC=1"),
        {"fluid/methods/wcsph_density", "THESIS=1", RIVULET_UNIT_ISA, thesis_density::wcsph_density, 64},
        {"fluid/methods/wcsph_forces", "THESIS=1", RIVULET_UNIT_ISA, thesis_forces::wcsph_forces, 64},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
