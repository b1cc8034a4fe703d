// Which step of opening a scene comes next, and the share of all steps that is done.
#pragma once

#include <functional>
#include <string>

#include "engine/core/result.h"

namespace rivulet {

// Receives the next step ("voxels of rocks.obj") and the share of all steps that is done, 0..1. false: opening is cancelled.
using OpeningSteps = std::function<bool(const std::string& next, double share)>;

struct OpeningProgress {
    const OpeningSteps& steps;
    std::string scene;  // its name
    int total = 1, done = 0;

    // Error (failed): `steps` cancelled it.
    Status next(const std::string& what) {
        if (!steps || steps(what, static_cast<double>(done++) / total)) return ok();
        return failed("opening " + scene + " was cancelled");
    }

    // A share of the current step is done, 0..1; it counts as `parts` of the total. false: cancelled.
    bool within(const std::string& what, double share, int parts) const {
        return !steps || steps(what, (done - 1 + share * parts) / total);
    }
};

}  // namespace rivulet
