// A case of the fuzzer: a scene as it is loaded, and what is dragged to what in which frame. A name says all of it, so that a name repeats
// it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "tests/fuzz/sliders.h"

namespace rivulet::fuzz {

// Scenes of 1 to 2 thousand particles that between them have an item in every list of a scene.
struct BaseRow {
    const char* name;
    SceneFile (*make)();
};
std::span<const BaseRow> bases();
Result<SceneFile> baseScene(const std::string& base, const std::string& method);

struct Drag {
    int frame = 0;  // before it
    std::string path, value;
};

struct Case {
    std::string name;
    SceneFile scene;
    std::vector<std::string> set;  // "path=value", what differs from the base
    std::vector<Drag> drags;
    int frames = 60;
    uint64_t frameSeed = 0;  // 0: all frames are a sixtieth of a second; else some are far longer or shorter
};

// The kinds, as names have them; a value has no spaces. Dragged: there from the start, dragged back to the base in the middle, and there
// again.
//   METHOD single BASE PATH=VALUE          60 frames, dragged
//   METHOD start BASE PATH=VALUE           a few frames, not dragged
//   METHOD sweep BASE PATH                 a live Param through all its values in a few frames
//   METHOD pair BASE PATH=VALUE PATH=VALUE 60 frames, dragged
//   METHOD corners BASE PATH PATH          two through their four corners in a few frames, what is fixed at one of its ends
//   METHOD random N                        60 frames: 2 to 16 Params anywhere in their range, drags anywhere, frames of any length
// Error: a name that is none, or what readers of scenes say of it.
Result<Case> caseOf(const std::string& name);

// The names of the cases of each tier. A Param is tried in the first base scene that has it; a Param of a list's item in each base scene
// except the last, in which water sleeps. Pairs are of Params that the simulation reads: those below fluid and in the lists.
std::vector<std::string> singles(const std::string& method, bool sample);
std::vector<std::string> pairs(const std::string& method, bool sample);
// The same as singles, of a pool that sleeps and of what the simulation reads. None for a method without sleep.
std::vector<std::string> sleeping(const std::string& method, bool sample);

std::string sceneText(SceneFile scene);  // as a file, without what is as in the smallest scene

}  // namespace rivulet::fuzz
