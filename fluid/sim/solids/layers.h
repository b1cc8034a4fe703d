// Collision layers: which solids, bodies and water meet.
#pragma once

#include "engine/core/params.h"

namespace rivulet {

// Two things meet if each of them is on a layer that the other one meets. Bit k of a mask is layer k.
struct LayersParams {
    static constexpr int kAll = 65535;  // 16 layers
    int layers = 1;
    int meets = kAll;
    bool meet(const LayersParams& other) const { return (layers & other.meets) != 0 && (other.layers & meets) != 0; }
    bool operator==(const LayersParams&) const = default;
    // Keys "layers" and "meets", beside those of their owner.
    void visit(ParamVisitor& v);
};

}  // namespace rivulet
