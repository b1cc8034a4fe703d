// The neighbours of a particle on a GPU: the nine rows of cells around its own, each row's three cells contiguous in memory.
// (On the CPU lang_cpp.h defines the same macros over a list for each group of 8.) Needs PARAMS of StepParams and a buffer
// RO(1, Neighbors, NEIGHBOR_TYPE, neighbors), which on a GPU is cellStart. j includes the particle itself.
#if !defined(FOR_NEIGHBORS)
#define SELF(i) uint i = THREAD_ID; if (i >= neighbors[PARAMS.cellCount]) return
#define FOR_NEIGHBORS(i, xi, j)                                                                                      \
    { vec3 g_ = (xi - PARAMS.gridOrigin.xyz) * PARAMS.gridOrigin.w;                                                  \
      int cx_ = TO_INT(g_.x); int cy_ = TO_INT(g_.y); int cz_ = TO_INT(g_.z);                                        \
      for (int row_ = 0; row_ < 9; ++row_) {                                                                         \
          int cell_ = ((cz_ + row_ / 3 - 1) * PARAMS.cellsY + cy_ + row_ % 3 - 1) * PARAMS.cellsX + cx_;             \
          uint end_ = neighbors[cell_ + 2];                                                                          \
          for (uint j = neighbors[cell_ - 1]; j < end_; ++j) {
#define END_NEIGHBORS }}}
#endif
