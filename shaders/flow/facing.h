// flow/facing encodes the nearest place in one uint: the distance, 0 to 3 FACING_FAR, then the index of the place.
#if !defined(RIVULET_FACING_H)
#define RIVULET_FACING_H
#define FACING_PLACES 4194304u /* a skin of more is not looked at */
#define FACING_FAR 300.0f
#if !defined(__cplusplus) || defined(RIVULET_KERNEL_UNIT)
// m: the height of a cap over a foot of that radius, 2 V / (pi R^2).
FN float capTop(float radius, float volume) { return volume * 0.63661977f / max(radius * radius, 1.0e-12f); }
#endif
#endif
