// A frame graph as plain data, for the panel that shows it and for `rivulet bench draw`. FrameGraph::describe() fills it; frames that are
// not shown do not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/abi.h"

namespace rivulet::gpu {

enum class Usage;
const char* usageName(Usage usage);  // "sampled"

struct FrameGraphDescription {
    struct Resource {
        std::string name;
        std::string format;  // "rgba16f"; "" for a buffer
        bool isTexture = false, imported = false, output = false;
        int width = 0, height = 0, layers = 0;  // texels; textures only
        size_t bytes = 0;                       // on the GPU
        size_t memory = SIZE_MAX;               // index of the pool's allocation that it used, from 0; SIZE_MAX: an import
        size_t first = SIZE_MAX, last = 0;      // indices of the first and last pass that used it; SIZE_MAX: none
    };
    struct Use {
        size_t resource = 0;
        Usage usage{};
    };
    struct Pass {
        std::string name;
        bool culled = false;
        std::vector<Use> reads, writes;
    };
    std::vector<Resource> resources;      // in the order of creation
    std::vector<Pass> passes;             // in the order they were added and ran
    size_t memories = 0;                  // allocations of the pool that were used
    size_t lentBytes = 0, heldBytes = 0;  // bytes of those allocations; of the whole pool
};

// The memory traffic of the passes of one name, if each reads and writes the whole of its textures and buffers exactly once. A copy reads
// what it copies. Not known to the graph, and not counted: tiles that a pass leaves out, texels that a cache misses twice, and reads of a
// target by blending and depth tests.
struct PassTraffic {
    std::string name;
    size_t passes = 0;             // that ran
    size_t read = 0, written = 0;  // bytes
    size_t bytes() const { return read + written; }
};
// In the order of adding; passes that were culled are left out.
std::vector<PassTraffic> trafficOf(const FrameGraphDescription& graph);

}  // namespace rivulet::gpu
