// A kernel with FOR_NEIGHBORS in its four forms: MATTER where particles differ, PERIODIC where the box wraps round. Included once a kernel,
// after
//     #define PAIR_KERNEL "shaders/fluid/NAME.kernel"
//     #define PAIR_UNIT a name of its own
// and, of one that asks for walls, `#define PAIR_WALLED`: it has two forms more, OPEN, for a box that wraps round along all axes and has no
// colliders. PAIR_ROWS and OPEN_ROWS list them in a table of CpuKernelRow.
namespace RIVULET_PASTE(PAIR_UNIT, _plain) {
#include PAIR_KERNEL
}
#define MATTER 1
namespace RIVULET_PASTE(PAIR_UNIT, _matter) {
#include PAIR_KERNEL
}
#define PERIODIC 1
namespace RIVULET_PASTE(PAIR_UNIT, _matter_periodic) {
#include PAIR_KERNEL
}
#if defined(PAIR_WALLED)
#define OPEN 1
namespace RIVULET_PASTE(PAIR_UNIT, _matter_open) {
#include PAIR_KERNEL
}
#undef OPEN
#endif
#undef MATTER
namespace RIVULET_PASTE(PAIR_UNIT, _periodic) {
#include PAIR_KERNEL
}
#if defined(PAIR_WALLED)
#define OPEN 1
namespace RIVULET_PASTE(PAIR_UNIT, _open) {
#include PAIR_KERNEL
}
#undef OPEN
#endif
#undef PERIODIC
#undef PAIR_KERNEL
#undef PAIR_UNIT
#undef PAIR_WALLED

#if !defined(PAIR_ROWS)
// `room`: the kernel's folder under shaders/fluid; `extra`: other defines, as "CUBIC=1".
#define PAIR_ROWS(unit, room, name, extra)                                                                              \
    {"fluid/" #room "/" #name, extra, RIVULET_UNIT_ISA, unit##_plain::name, 64},                                        \
        {"fluid/" #room "/" #name, "MATTER=1;" extra, RIVULET_UNIT_ISA, unit##_matter::name, 64},                       \
        {"fluid/" #room "/" #name, "MATTER=1;PERIODIC=1;" extra, RIVULET_UNIT_ISA, unit##_matter_periodic::name, 64}, { \
        "fluid/" #room "/" #name, "PERIODIC=1;" extra, RIVULET_UNIT_ISA, unit##_periodic::name, 64                      \
    }
#define OPEN_ROWS(unit, room, name, extra)                                                                             \
    {"fluid/" #room "/" #name, "MATTER=1;OPEN=1;PERIODIC=1;" extra, RIVULET_UNIT_ISA, unit##_matter_open::name, 64}, { \
        "fluid/" #room "/" #name, "OPEN=1;PERIODIC=1;" extra, RIVULET_UNIT_ISA, unit##_open::name, 64                  \
    }
#endif
