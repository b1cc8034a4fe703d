// What a frame's graph was, as plain data, for those who show it. FrameGraph::describe() fills it; nobody else pays for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rivulet::gpu {

enum class Usage;
const char* usageName(Usage usage);  // "sampled"

struct FrameGraphDescription {
    struct Resource {
        std::string name;
        std::string format;  // "rgba16f"; "" of a buffer
        bool isTexture = false, imported = false, output = false;
        int width = 0, height = 0, layers = 0;  // texels; of a texture
        size_t bytes = 0;                       // on the GPU
        size_t memory = SIZE_MAX;               // which of the pool's pieces it was lent, from 0 on; SIZE_MAX: none, somebody else's
        size_t first = SIZE_MAX, last = 0;      // of the passes that ran; SIZE_MAX: nobody used it
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
    std::vector<Resource> resources;      // in the order they were made
    std::vector<Pass> passes;             // in the order they were added, which is that they ran in
    size_t memories = 0;                  // pieces of the pool that were lent
    size_t lentBytes = 0, heldBytes = 0;  // of those pieces; of all that the pool holds
};

}  // namespace rivulet::gpu
