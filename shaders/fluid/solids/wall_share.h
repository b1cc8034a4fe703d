// The walls' contribution at particle i, from the buffer `boundary`; in a world without walls (OPEN) it is 0 and nothing is read.
#undef WALL_SHARE
#undef WALL_SLOPE
#if defined(OPEN)
#define WALL_SHARE(i) 0.0f
#define WALL_SLOPE(i) real3(0.0f, 0.0f, 0.0f)
#else
#define WALL_SHARE(i) LOADW(boundary, i)
#define WALL_SLOPE(i) LOAD3(boundary, i)
#endif
