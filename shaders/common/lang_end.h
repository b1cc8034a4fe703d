// Included last by each header that kernels and the host share: what lang.h defined for the host is undefined, or what it was before.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma pop_macro("FN")
#pragma pop_macro("STRUCT")
#pragma pop_macro("CONSTANT")
#pragma pop_macro("GLOBAL")
#pragma pop_macro("PASS")
#pragma pop_macro("EXACT")
#pragma pop_macro("TO_INT")
#pragma pop_macro("TO_UINT")
#pragma pop_macro("TO_DOUBLE")
#endif
