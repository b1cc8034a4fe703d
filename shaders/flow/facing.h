// How flow/facing tells of the nearest place in one uint: 0 to FACING_FAR, then the place.
#if !defined(RIVULET_FACING_H)
#define RIVULET_FACING_H
#define FACING_PLACES 4194304u  /* a skin of more is not looked at */
#define FACING_FAR 1000.0f
#endif
