// FluidUpload: the particles of a world as OpenGL buffers, from any Device.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/gl_sharing.h"
#include "engine/gpu/staging_ring.h"
#include "fluid/io/recording.h"
#include "fluid/render/fluid_snapshot.h"
#include "fluid/render/fluid_view.h"
#include "fluid/render/look_params.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

// How the particles reached OpenGL.
struct TransferFacts {
    // "same memory": the Device's own buffers (gl); "shared with OpenCL": copied by the GPU (cl); "ring": through mapped memory.
    const char* way = "";
    std::string why;     // of the ring: why no memory is shared, half a sentence
    double ms = 0;       // on the wall, of the last view(), with the wait for the simulation
    size_t bytes = 0;    // copied through host memory: of what sleeps once
    uint64_t waits = 0;  // frames so far in which the ring was full
};
std::string sentenceOf(const TransferFacts& facts);  // "ring: 0.31 ms, 1.2 MB (the cpu simulates)"

class FluidUpload {
  public:
    // Valid until the next view() and until the world's next step. Error (failed): out of GPU memory.
    // `drops`: those in the air, `pendants`: those that hang, as FluidView has them.
    Result<FluidView> view(const FluidWorld& world, const FluidLookParams& look, std::span<const vec4> drops = {},
                           std::span<const vec4> pendants = {});
    // Valid until the next view() and until the snapshot takes another state. Error (badInput): the snapshot is empty; (failed): as above.
    Result<FluidView> view(const FluidSnapshot& snapshot, const FluidLookParams& look);
    // The same for a recorded frame.
    Result<FluidView> view(const RecordedFrame& frame, const FluidLookParams& look);
    size_t bytes() const;                                   // of OpenGL memory that it holds
    void limitMemory(size_t bytes) { mostBytes_ = bytes; }  // the limit of bytes(): view() fails beyond it
    const TransferFacts& facts() const { return facts_; }   // of the last view()

  private:
    // An OpenGL buffer, and OpenCL's view of it, which is released first.
    struct Target {
        gpu::Buffer memory;
        GlSharing::Wrapped seen;

        Target() = default;
        Target(Target&&) = default;
        Target& operator=(Target&&) = delete;
        Status makeRoom(size_t bytes);
        void drop() {
            seen.reset();
            memory = {};
        }
    };
    struct Array {
        const Buffer* from;  // null: `host`
        std::span<const std::byte> host;
        Target* to;
        unsigned* name;
        size_t bytes;
        bool ofParticles;  // sorted unless quality is fine
    };
    Status room(std::span<const Array> arrays, size_t others, bool ring) const;
    void follow(std::shared_ptr<const GlSharing> sharing);
    template <class Self>
    static auto targets(Self& of);  // pointers to all Targets
    void dropTargets();
    bool holds(const std::shared_ptr<const void>& revision, const FluidLookParams& look, bool normals) const;
    void hold(std::shared_ptr<const void> revision, const FluidLookParams& look, bool normals, const FluidView& view);
    FluidView kept(double start);
    Status bringDrops(std::span<const vec4> drops, std::span<const vec4> pendants, FluidView& out);
    Status holdWetCells(std::shared_ptr<const WetSurface> surface);
    Status share(std::span<const Array> arrays);
    bool holdsSleepers(std::span<const Array> arrays, bool hurried, const FluidView& of) const;
    Status bringOver(Device* device, std::span<const Array> arrays, bool hurried, FluidView& out);

    gpu::StagingRing ring_;
    gpu::Buffer drops_, pendants_;
    Target position_, velocity_, id_, absorption_;
    std::array<Target, kMostAttributes> attributes_;
    std::array<Target, 2> foam_;
    Target wetness_, bodies_;
    gpu::Buffer wetCells_;
    std::shared_ptr<const WetSurface> wetSurface_;  // the surface that wetCells_ was made from
    std::array<Target, 3> ellipsoids_;
    std::shared_ptr<const GlSharing> sharing_;  // that the Targets were last wrapped by
    std::string refused_;                       // why sharing_ is no longer used, half a sentence
    std::vector<vec4> vectors_;
    std::vector<uint32_t> ids_, order_;  // ids_: of the copied particles
    // What sleeps in the Targets `of`, in the order of `hurried`, is not copied again.
    struct Sleepers {
        std::shared_ptr<const void> sleepers;
        std::vector<const Target*> of;
        bool hurried = false;
        uint32_t half = 0;
    } held_;
    // The last view of a world or a snapshot: while its particles do not change, another view, of another eye say, needs no copy.
    struct Last {
        std::shared_ptr<const void> revision;
        float radiusSpacings = 0;
        bool normals = false, ellipsoids = false, hurried = false;
        FluidView view;
    } last_;
    TransferFacts facts_;
    size_t mostBytes_ = SIZE_MAX;
};

}  // namespace rivulet
