// Shared by the scan kernels: the exclusive prefix sum of one value per thread over a work group of 256, with two barriers.
#if LOCAL_SIZE != 256
#error "the scan kernels run in work groups of 256: hand the define LOCAL_SIZE=256"
#endif
// `part`: work-group memory of 272 elements: 16 rows of 16, each followed by a gap against bank conflicts; `rows`: 16 elements, the rows'
// sums. Sets `before` to the sum of `own` over the threads before `t`, `total` to the sum over all.
#define SCAN_GROUP(part, rows, t, own, before, total)       \
    part[t + (t >> 4)] = own;                               \
    BARRIER;                                                \
    if (t < 16u) {                                          \
        uint sum_ = 0u;                                     \
        for (uint k_ = t * 17u; k_ < t * 17u + 16u; ++k_) { \
            uint v_ = part[k_];                             \
            part[k_] = sum_;                                \
            sum_ += v_;                                     \
        }                                                   \
        rows[t] = sum_;                                     \
    }                                                       \
    BARRIER;                                                \
    before = part[t + (t >> 4)];                            \
    total = 0u;                                             \
    for (uint k_ = 0u; k_ < 16u; ++k_) {                    \
        before += k_ == (t >> 4) ? total : 0u;              \
        total += rows[k_];                                  \
    }
