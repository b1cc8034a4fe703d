// Where a GPU keeps which neighbours are within reach (neighbors.h): behind the entries of cellStart KEPT_WORDS words of 32 bits for each
// of the KEPT_ROWS rows of cells around a particle; of one word those of all slots are contiguous.
#if !defined(RIVULET_KEPT_PAIRS_H)
#define RIVULET_KEPT_PAIRS_H
#define KEPT_ROWS 9
#define KEPT_WORDS 2u
// The first of them, by StepParams.
#define KEPT_FROM(s) ((s).totalCells + 4u + (s).asleepSets * (s).cellCount)
#endif
