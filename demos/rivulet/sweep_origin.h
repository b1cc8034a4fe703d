// What the tasks in the folder of a sweep are made from, so that results of other scenes or of another version are not mixed with them.
#pragma once

#include <map>
#include <string>

#include "engine/core/result.h"

namespace rivulet {

struct SweepOrigin {
    std::string folder;                     // of SWEEP.json: the working directory of the commands
    std::string version = RIVULET_VERSION;  // of the program
    // The files that `run` reads (scenes, their files, recordings, states), and their hashes; paths below `folder` are relative.
    std::map<std::string, std::string> scenes;
};

// The name of a file in SweepOrigin::scenes.
std::string originName(const std::string& file, const std::string& folder);

// The hash of each file. Error: one cannot be read.
Status hashScenes(SweepOrigin& origin);

Result<SweepOrigin> readOrigin(const std::string& file);
Status writeOrigin(const SweepOrigin& origin, const std::string& file);

// Error (badInput), which names what differs from the origin of the tasks in `tasks`: the program's version, a file. Files are
// read from `folder`, which may be another than that of the origin: a sweep that was moved with its scenes.
Status checkOrigin(const SweepOrigin& origin, const std::string& folder, const std::string& tasks);

}  // namespace rivulet
