// SparseCells: which items touch which cubic cell of space; only cells that something touches take memory.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

class SparseCells {
  public:
    static constexpr int kReach = (1 << 20) - 2;  // cells either way of the origin

    // `touched(i, add)` calls add(cell) for each cell that item i of `count` touches, the same ones each time it is asked. Within a cell
    // items keep their order. Cells are at most kReach away along each axis.
    template <class Touched>
    void build(uint32_t count, double edge, const Touched& touched);

    double edge() const { return edge_; }  // m
    // For any values, also NaN: places beyond kReach give a cell that is always empty.
    ivec3 cellOf(const dvec3& p) const { return {glm::min(dvec3(kReach + 1), glm::max(dvec3(-kReach - 1), glm::floor(p / edge_)))}; }
    bool occupied(const ivec3& cell) const { return find(keyOf(cell)) != kNone; }
    std::span<const uint32_t> items(const ivec3& cell) const {
        const uint32_t slot = find(keyOf(cell));
        if (slot == kNone) return {};
        return {items_.data() + starts_[slot], starts_[slot + 1] - starts_[slot]};
    }
    const std::vector<ivec3>& cells() const { return cells_; }  // the occupied ones, in the order they were first touched

  private:
    static constexpr uint32_t kNone = ~0U;
    static constexpr uint64_t kEmpty = ~0ULL;

    static uint64_t keyOf(const ivec3& c) {
        const auto part = [](int v) { return static_cast<uint64_t>(v + (1 << 20)) & 0x1FFFFFU; };
        return part(c.x) | part(c.y) << 21U | part(c.z) << 42U;
    }
    size_t homeOf(uint64_t key) const { return (key * 0x9E3779B97F4A7C15ULL) >> shift_; }
    uint32_t find(uint64_t key) const {
        if (keys_.empty()) return kNone;
        for (size_t at = homeOf(key);; at = (at + 1) & (keys_.size() - 1)) {
            if (keys_[at] == key) return slots_[at];
            if (keys_[at] == kEmpty) return kNone;
        }
    }
    void grow();
    uint32_t slotOf(const ivec3& cell);  // a new one if there is none

    double edge_ = 1;
    unsigned shift_ = 64;
    std::vector<uint64_t> keys_;  // open addressing, a power of two, at most half full
    std::vector<uint32_t> slots_;
    std::vector<ivec3> cells_;
    std::vector<size_t> starts_;  // of each slot, in items_
    std::vector<uint32_t> items_;
};

inline void SparseCells::grow() {
    const size_t size = keys_.empty() ? 1024 : 2 * keys_.size();
    shift_ = 64;
    for (size_t s = size; s > 1; s /= 2) --shift_;
    keys_.assign(size, kEmpty);
    slots_.assign(size, 0);
    for (size_t slot = 0; slot < cells_.size(); ++slot) {
        size_t at = homeOf(keyOf(cells_[slot]));
        while (keys_[at] != kEmpty) at = (at + 1) & (size - 1);
        keys_[at] = keyOf(cells_[slot]);
        slots_[at] = static_cast<uint32_t>(slot);
    }
}

inline uint32_t SparseCells::slotOf(const ivec3& cell) {
    const uint64_t key = keyOf(cell);
    if (const uint32_t found = find(key); found != kNone) return found;
    if (2 * (cells_.size() + 1) > keys_.size()) grow();
    size_t at = homeOf(key);
    while (keys_[at] != kEmpty) at = (at + 1) & (keys_.size() - 1);
    keys_[at] = key;
    slots_[at] = static_cast<uint32_t>(cells_.size());
    cells_.push_back(cell);
    return slots_[at];
}

template <class Touched>
void SparseCells::build(uint32_t count, double edge, const Touched& touched) {
    *this = SparseCells();
    edge_ = edge;
    std::vector<size_t> sizes;
    for (uint32_t i = 0; i < count; ++i)
        touched(i, [&](const ivec3& cell) {
            const uint32_t slot = slotOf(cell);
            if (slot == sizes.size()) sizes.push_back(0);
            ++sizes[slot];
        });
    starts_.assign(sizes.size() + 1, 0);
    for (size_t slot = 0; slot < sizes.size(); ++slot) starts_[slot + 1] = starts_[slot] + sizes[slot];
    items_.resize(starts_.back());
    std::vector<size_t> next(starts_.begin(), starts_.end() - 1);
    for (uint32_t i = 0; i < count; ++i) touched(i, [&](const ivec3& cell) { items_[next[find(keyOf(cell))]++] = i; });
}

}  // namespace rivulet
