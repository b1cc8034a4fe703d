// FluidUpload: a world's particles as GL buffers, whichever Device simulates them.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/staging_ring.h"
#include "fluid/bridge/scene_file.h"
#include "fluid/render/fluid_view.h"
#include "fluid/sim/fluid_world.h"

namespace rivulet {

// How particles come to be drawn.
struct TransferFacts {
    const char* way = "";  // "same memory": the Device's own buffers (gl); "ring": through mapped memory
    double ms = 0;         // on the wall, the last time, a wait for the simulation included
    size_t bytes = 0;      // that went through the host
    uint64_t waits = 0;    // so far: frames in which the ring was full
};

class FluidUpload {
  public:
    // Valid until the next view() and until the world's next step. Error (failed): out of GPU memory.
    // `drops`: those in the air, as FluidView::drops has them.
    Result<FluidView> view(const FluidWorld& world, const FluidLookParams& look, std::span<const vec4> drops = {});
    const TransferFacts& facts() const { return facts_; }  // of the last view()

  private:
    struct Array {
        const Buffer* from;
        gpu::Buffer* to;
        unsigned* name;
        bool ofParticles;  // sorted where the picture is hurried
    };
    Status bringOver(Device& device, std::span<const Array> arrays, const Buffer& ids, bool hurried, FluidView& out);

    gpu::StagingRing ring_;
    gpu::Buffer position_, velocity_, id_, absorption_, drops_;
    std::array<gpu::Buffer, 2> foam_;
    std::array<gpu::Buffer, 3> ellipsoids_;
    std::vector<vec4> vectors_;
    std::vector<uint32_t> ids_, order_;
    TransferFacts facts_;
};

}  // namespace rivulet
