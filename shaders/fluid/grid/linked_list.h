// fluid.grid linked_list: one list of particles per cell (thesis 4.2), in the buffer that otherwise holds cellStart: the first particle of
// each cell, then the number of slots, then for each slot the next particle in its list. Nothing is sorted; slots in no list are marked.
#if !defined(RIVULET_LINKED_LIST_H)
#define RIVULET_LINKED_LIST_H
#define LIST_END 0xffffffffu
#define LIST_NONE 0xfffffffeu  // instead of the next particle: the slot is in no list, because it is lost or free
#define NEXT_OF(cells, i) ((cells) + 1u + (i))
// Whether slot i is not simulated (lost or free). `start`: cellStart or the lists; `cells`: StepParams.cellCount.
#if defined(LINKED_LIST)
#define STANDS_BY(start, cells, i) (i >= start[cells] || start[NEXT_OF(cells, i)] == LIST_NONE)
#else
#define STANDS_BY(start, cells, i) (i >= start[cells]) /* those are sorted to the end */
#endif
#endif
