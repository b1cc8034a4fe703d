// LateView: what a window shows of a session whose data reach OpenGL through the host's memory (backend cl without shared memory): the
// newest state that has arrived, one to three frames old, so that no frame waits. Particles, spray, drops and solids are of one time, also
// bodies that the GPU moves and meshes that deform. Headless runs and recordings show the state of the frame itself: viewOf().
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "engine/scene/scene.h"
#include "fluid/render/fluid_snapshot.h"
#include "fluid/render/fluid_upload.h"
#include "shaders/fluid/sources/dry_volume.h"

namespace rivulet {

class Session;

class LateView {
  public:
    static bool suits(const Session& session);
    // Asks for the session's present state, and shows the newest that is there; waits if that is the first, or if three are on their way.
    // Valid until the next call. Error: as FluidUpload::view.
    struct Shown {
        FluidView fluid;
        const Scene* solids = nullptr;
        double time = 0;  // s, simulated
    };
    Result<Shown> show(FluidUpload& upload, const Session& session);

  private:
    struct Frame {
        FluidSnapshot snapshot;
        Scene solids;
        double time = 0;
        bool moved = false;               // the device has moved the bodies of this frame: `solids` has them where they were expected
        std::vector<DryVolume> dry = {};  // as FluidWorld::ownDry
    };
    void dropOlder();
    void moveBodies(Frame& frame, const FluidWorld& world);
    void readMeshes(Scene& solids);

    std::deque<Frame> frames_;  // in the order of time
    Frame spare_;               // a frame that was shown: its memory is reused
    // The vertices that were read last of each deformer of the last frame. Neither they nor frames keep a deformer, since a device may be
    // gone before this is.
    std::vector<std::shared_ptr<const DeformedVertices>> meshes_;
    const Device* device_ = nullptr;
};

}  // namespace rivulet
