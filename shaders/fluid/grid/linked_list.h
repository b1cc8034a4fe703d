// fluid.grid linked_list: a list of particles a cell (thesis 4.2) in the buffer that holds cellStart elsewhere: the first particle of each
// cell, then the count of slots, then, a slot each, the next particle in its list. Nothing is sorted: who is in no list says so itself.
#if !defined(RIVULET_LINKED_LIST_H)
#define RIVULET_LINKED_LIST_H
#define LIST_END 0xffffffffu
#define LIST_NONE 0xfffffffeu  // in place of the next: in no list, as it is lost or a free slot
#define NEXT_OF(cells, i) ((cells) + 1u + (i))
// Whether slot i takes no part in a step. `start`: cellStart or the lists; `cells`: StepParams.cellCount.
#if defined(LINKED_LIST)
#define STANDS_BY(start, cells, i) (i >= start[cells] || start[NEXT_OF(cells, i)] == LIST_NONE)
#else
#define STANDS_BY(start, cells, i) (i >= start[cells]) /* those are sorted to the end */
#endif
#endif
