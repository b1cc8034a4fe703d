// The end of a header that kernels and the host share: takes the macros of lang.h from the host again.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#undef FN
#undef STRUCT
#undef CONSTANT
#undef GLOBAL
#undef PASS
#undef EXACT
#undef TO_INT
#undef TO_UINT
#undef TO_DOUBLE
#endif
