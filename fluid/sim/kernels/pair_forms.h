// A kernel with FOR_NEIGHBORS in its four forms: MATTER where particles differ, PERIODIC where the box wraps round. Included once a kernel,
// after
//     #define PAIR_KERNEL "shaders/fluid/NAME.kernel"
//     #define PAIR_UNIT a name of its own
// PAIR_ROWS lists them in a table of CpuKernelRow.
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
#undef MATTER
namespace RIVULET_PASTE(PAIR_UNIT, _periodic) {
#include PAIR_KERNEL
}
#undef PERIODIC
#undef PAIR_KERNEL
#undef PAIR_UNIT

#if !defined(PAIR_ROWS)
// `extra`: other defines, as "CUBIC=1".
#define PAIR_ROWS(unit, name, extra)                                                                          \
    {"fluid/" #name, extra, RIVULET_UNIT_ISA, unit##_plain::name, 64},                                        \
        {"fluid/" #name, "MATTER=1;" extra, RIVULET_UNIT_ISA, unit##_matter::name, 64},                       \
        {"fluid/" #name, "MATTER=1;PERIODIC=1;" extra, RIVULET_UNIT_ISA, unit##_matter_periodic::name, 64}, { \
        "fluid/" #name, "PERIODIC=1;" extra, RIVULET_UNIT_ISA, unit##_periodic::name, 64                      \
    }
#endif
