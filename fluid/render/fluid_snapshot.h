// FluidSnapshot: what a draw needs of a world, copied, so that the world can be stepped while the copy is drawn.
//
// Threads: take() belongs to the thread that steps the world, FluidUpload::view() to the thread that draws; each FluidSnapshot is used by
// one of them at a time. On backends cpu and cl the two threads can run at the same time, take() calls no function of OpenGL, and two
// snapshots that are exchanged (one is filled, the other drawn) need no copy in between. On gl take() copies on the GPU and needs the
// OpenGL context of the world's device, and the snapshot must not outlive this device.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/io/recording.h"
#include "fluid/sim/solids/wet_surface.h"

namespace rivulet {

class FluidWorld;

class FluidSnapshot {
  public:
    // Copies the world as it is now, in place of what it held. `drops`, `pendants`: of skins, as FluidView has them. Error (failed): out of
    // memory; the snapshot is empty then.
    Status take(const FluidWorld& world, std::span<const vec4> drops = {}, std::span<const vec4> pendants = {});
    // Holds a recorded frame instead. viscosity: Pa s, of its liquid.
    void take(RecordedFrame frame, float viscosity);
    // As the first, without waiting: on cl the copy arrives some frames later, within Device::poll(), on the others at once. Until
    // arrived() has returned true, the snapshot is empty. Another take() ends it.
    Status takeLater(const FluidWorld& world, std::span<const vec4> drops = {}, std::span<const vec4> pendants = {});
    bool arrived();
    // Where dry volumes are in it, instead of where they were expected.
    void cutAt(std::vector<DryVolume> dry) { frame_.dry = std::move(dry); }
    bool empty() const { return !taken_; }
    double time() const { return frame_.time; }  // s, simulated

  private:
    friend class FluidUpload;
    void begin(const FluidWorld& world, std::span<const vec4> drops, std::span<const vec4> pendants);
    Status takeOnGpu(const FluidWorld& world);

    // What takeLater() has asked for.
    struct Coming {
        RecordedFrame frame;
        std::vector<float> wetness;
        bool complete = false;
    };
    std::shared_ptr<Coming> coming_;
    bool taken_ = false, onGpu_ = false;
    std::shared_ptr<const void> revision_;  // a new one with each take
    RecordedFrame frame_;                   // of cpu and cl: all; of gl: time, spacing, box, dry
    float viscosity_ = 0;
    std::shared_ptr<const WetSurface> wetSurface_;
    std::vector<float> wetness_;  // of cpu and cl
    std::vector<vec4> drops_, pendants_;
    // Of gl.
    struct Copy {
        Buffer memory;
        bool used = false;
        unsigned name() const { return used ? static_cast<unsigned>(memory.handle()) : 0; }
    };
    uint32_t count_ = 0, foamCount_ = 0;
    Copy position_, velocity_, normal_, id_, absorption_, wet_;
    std::array<Copy, kMostAttributes> attributes_;
    std::array<Copy, 3> ellipsoids_;
    std::array<Copy, 2> foam_;
};

}  // namespace rivulet
