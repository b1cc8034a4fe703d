// Runs a case of the fuzzer in a process of its own, and judges it: a crash or a hang is a failure of that case alone.
#pragma once

#include <string>

#include "tests/fuzz/fuzz_case.h"

namespace rivulet::fuzz {

struct Outcome {
    enum class Verdict { passed, refused, failed };
    Verdict verdict = Verdict::passed;
    std::string sentence;  // why not, or of what was refused
    int refusedDrags = 0;  // those that made no sense: a sentence is shown, and the scene stays
    int slowed = 0;        // the frame from which on there was but one step a frame, for the time it took; 0: none
    int limited = 0;       // plain notices of what the program limited
    int slept = 0;         // frames in which water slept
    double seconds = 0;    // on the processor
};

// Of each frame:
//  - nothing is NaN or infinite, in particles, bodies or stats; nothing is lost; all lies in the box (sinks take, they do not lose);
//  - particles = emitted - drained, in the arrays, the stats and the ledger;
//  - no speed is above what the step limits: a spacing a step. Where solids or bodies move, three: a wall that itself goes no further than
//  that
//    in a step throws back with twice its speed besides;
//  - sleeping particles stand still, and there are as many as the stats say;
//  - time + pending + dropped is the requested time.
// Refused with one plain sentence at the start is an outcome of its own, as the window does it: nothing was simulated.
Outcome run(const Case& c);

// The scene, what is dragged, and how to repeat it.
std::string report(const Case& c, const Outcome& outcome);

}  // namespace rivulet::fuzz
