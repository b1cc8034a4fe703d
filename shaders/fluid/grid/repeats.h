// Cells that repeat in space: `count` of them along an axis, from number `first` on. Any cell number becomes one of these.
#if !defined(RIVULET_REPEATS_H)
#define RIVULET_REPEATS_H
#define FARTHEST_CELL 1.0e9f /* positions beyond it, in cells, are not sorted: NaN or infinite */
FN int repeatedCell(int cell, int first, int count) {
    // Not all languages define % for negative numbers.
    return cell >= first ? first + (cell - first) % count : first + count - 1 - (first - 1 - cell) % count;
}
#endif
