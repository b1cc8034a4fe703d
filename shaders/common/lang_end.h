// Included last by each header that kernels and the host share: undefines the macros of lang.h for the host.
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
