// LateView: what a window shows of a session whose data reach OpenGL through the host's memory (backend cl without shared memory): the
// newest state that has arrived, one to three frames old, so that no frame waits. Particles, spray, drops and the places of solids are of
// one time; floating bodies that the GPU moves are where they were expected at that time (FluidWorld::expectedBodies): within 0.5 s of a
// blow that waits for their states, here as on backend gl. Headless runs and recordings show the state of the frame itself: viewOf().
#pragma once

#include <deque>

#include "engine/scene/scene.h"
#include "fluid/render/fluid_snapshot.h"
#include "fluid/render/fluid_upload.h"

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
    };
    void dropOlder();

    std::deque<Frame> frames_;  // in the order of time
    Frame spare_;               // a frame that was shown: its memory is reused
    const Device* device_ = nullptr;
};

}  // namespace rivulet
