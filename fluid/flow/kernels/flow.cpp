#include "fluid/sim/kernels/kernel_rows.h"
#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

namespace take_unit {
#include "shaders/flow/take.kernel"
}
namespace rest_unit {
#include "shaders/flow/rest.kernel"
}
namespace basis_unit {
#include "shaders/flow/basis.kernel"
}
namespace stand_unit {
#include "shaders/flow/stand.kernel"
}
namespace drive_unit {
#include "shaders/flow/drive.kernel"
}
namespace born_unit {
#include "shaders/flow/born.kernel"
}
// Headers of functions over a kernel's own buffers: each unit has them anew.
#undef RIVULET_UNDER_H
#undef RIVULET_FETCH_H
namespace place_unit {
#include "shaders/flow/place.kernel"
}
namespace brim_unit {
#include "shaders/flow/brim.kernel"
}
namespace name_unit {
#include "shaders/flow/name.kernel"
}
namespace spread_unit {
#include "shaders/flow/spread.kernel"
}
namespace meet_unit {
#include "shaders/flow/meet.kernel"
}
namespace gather_unit {
#include "shaders/flow/gather.kernel"
}
namespace press_unit {
#include "shaders/flow/press.kernel"
}
namespace mark_unit {
#include "shaders/flow/mark.kernel"
}
#undef RIVULET_CELLS_H
#undef RIVULET_FACING_H
namespace facing_unit {
#include "shaders/flow/facing.kernel"
}
#undef RIVULET_FACING_H
namespace go_over_unit {
#include "shaders/flow/go_over.kernel"
}
namespace merge_unit {
#include "shaders/flow/merge.kernel"
}
#undef RIVULET_UNDER_H
#undef RIVULET_FETCH_H
namespace law_unit {
#include "shaders/flow/law.kernel"
}
#undef RIVULET_WALK_H
#undef RIVULET_FETCH_H
namespace steer_unit {
#include "shaders/flow/steer.kernel"
}
#undef RIVULET_WALK_H
#undef RIVULET_FETCH_H
namespace walk_unit {
#include "shaders/flow/walk.kernel"
}
#undef RIVULET_WALK_H
#undef RIVULET_FETCH_H
namespace paint_unit {
#include "shaders/flow/paint.kernel"
}
namespace dry_unit {
#include "shaders/flow/dry.kernel"
}
namespace leave_unit {
#include "shaders/flow/leave.kernel"
}
namespace thesis_frame_unit {
#include "shaders/flow/thesis_frame.kernel"
}
namespace thesis_field_unit {
#include "shaders/flow/thesis_field.kernel"
}
namespace thesis_place_unit {
#include "shaders/flow/thesis_place.kernel"
}
namespace thesis_density_unit {
#include "shaders/flow/thesis_density.kernel"
}
namespace thesis_press_unit {
#include "shaders/flow/thesis_press.kernel"
}
namespace thesis_law_unit {
#include "shaders/flow/thesis_law.kernel"
}
namespace thesis_leave_unit {
#include "shaders/flow/thesis_leave.kernel"
}

}  // namespace

std::span<const CpuKernelRow> flowRows() {
    static const CpuKernelRow rows[] = {
        {"flow/take", "", RIVULET_UNIT_ISA, take_unit::take, 1024},
        {"flow/rest", "", RIVULET_UNIT_ISA, rest_unit::rest, 1024},
        {"flow/basis", "", RIVULET_UNIT_ISA, basis_unit::basis, 1024},
        {"flow/stand", "", RIVULET_UNIT_ISA, stand_unit::stand, 1024},
        {"flow/drive", "", RIVULET_UNIT_ISA, drive_unit::drive, 512},
        {"flow/born", "", RIVULET_UNIT_ISA, born_unit::born, 256},
        {"flow/brim", "", RIVULET_UNIT_ISA, brim_unit::brim, 1},
        {"flow/place", "", RIVULET_UNIT_ISA, place_unit::place, 256},
        {"flow/name", "", RIVULET_UNIT_ISA, name_unit::name, 1024},
        {"flow/spread", "", RIVULET_UNIT_ISA, spread_unit::spread, 16},
        {"flow/meet", "", RIVULET_UNIT_ISA, meet_unit::meet, 16},
        {"flow/gather", "", RIVULET_UNIT_ISA, gather_unit::gather, 16},
        {"flow/press", "", RIVULET_UNIT_ISA, press_unit::press, 16},
        {"flow/mark", "", RIVULET_UNIT_ISA, mark_unit::mark, 256},
        {"flow/facing", "", RIVULET_UNIT_ISA, facing_unit::facing, 1024},
        {"flow/go_over", "", RIVULET_UNIT_ISA, go_over_unit::go_over, 256},
        {"flow/merge", "", RIVULET_UNIT_ISA, merge_unit::merge, 256},
        {"flow/law", "", RIVULET_UNIT_ISA, law_unit::law, 64},
        {"flow/steer", "", RIVULET_UNIT_ISA, steer_unit::steer, 64},
        {"flow/walk", "", RIVULET_UNIT_ISA, walk_unit::walk, 64},
        {"flow/paint", "", RIVULET_UNIT_ISA, paint_unit::paint, 32},
        {"flow/dry", "", RIVULET_UNIT_ISA, dry_unit::dry, 256},
        {"flow/leave", "", RIVULET_UNIT_ISA, leave_unit::leave, 256},
        {"flow/thesis_frame", "", RIVULET_UNIT_ISA, thesis_frame_unit::thesis_frame, 1024},
        {"flow/thesis_field", "", RIVULET_UNIT_ISA, thesis_field_unit::thesis_field, 1024},
        {"flow/thesis_place", "", RIVULET_UNIT_ISA, thesis_place_unit::thesis_place, 256},
        {"flow/thesis_density", "", RIVULET_UNIT_ISA, thesis_density_unit::thesis_density, 16},
        {"flow/thesis_press", "", RIVULET_UNIT_ISA, thesis_press_unit::thesis_press, 16},
        {"flow/thesis_law", "", RIVULET_UNIT_ISA, thesis_law_unit::thesis_law, 64},
        {"flow/thesis_leave", "", RIVULET_UNIT_ISA, thesis_leave_unit::thesis_leave, 256},
    };
    return rows;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
