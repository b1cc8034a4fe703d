#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

namespace deform_unit {
#include "shaders/material/deform.kernel"
}
namespace normals_unit {
#include "shaders/material/normals.kernel"
}

}  // namespace

std::span<const CpuKernelRow> deformRows() {
    static const CpuKernelRow rows[] = {
        {"material/deform", "", RIVULET_UNIT_ISA, deform_unit::deform, 1024},
        {"material/normals", "", RIVULET_UNIT_ISA, normals_unit::normals, 512},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
