// What the scan kernels share: the exclusive prefix sum of one value a thread over a work group of 256.
#if LOCAL_SIZE != 256
#error "the scan kernels run in work groups of 256: hand the define LOCAL_SIZE=256"
#endif
// `part`: work-group memory of 256 + 16 (a row of 16 has a gap behind it, against bank conflicts); `rows`: of 17.
// Sets `before` to the sum of `own` over the threads before `t`, `total` to the sum over all.
#define SCAN_GROUP(part, rows, t, own, before, total)                                                   \
    BARRIER; /* an earlier round's readers are done */                                                  \
    part[t + (t >> 4)] = own;                                                                           \
    BARRIER;                                                                                            \
    if (t < 16u) {                                                                                      \
        uint sum_ = 0u;                                                                                 \
        for (uint k_ = t * 17u; k_ < t * 17u + 16u; ++k_) { uint v_ = part[k_]; part[k_] = sum_; sum_ += v_; } \
        rows[t] = sum_;                                                                                 \
    }                                                                                                   \
    BARRIER;                                                                                            \
    if (t == 0u) {                                                                                      \
        uint sum_ = 0u;                                                                                 \
        for (uint k_ = 0u; k_ < 16u; ++k_) { uint v_ = rows[k_]; rows[k_] = sum_; sum_ += v_; }         \
        rows[16] = sum_;                                                                                \
    }                                                                                                   \
    BARRIER;                                                                                            \
    before = part[t + (t >> 4)] + rows[t >> 4];                                                         \
    total = rows[16];
