// What `rivulet run` was asked for, and the two loops that carry it out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "fluid/bridge/scene_file.h"

namespace rivulet {

struct RunOptions {
    SceneFile scene;
    std::string backend = "auto";  // auto | cpu | gl | cl
    bool render = true;
    std::optional<int> frames;       // how many; nothing: the loop's own default
    int width = 1280, height = 720;  // pixels
    std::string out = "out";         // folder of what is written
    std::string video;               // file; empty: out/NAME.mp4
    std::string stats;               // file; empty: out/stats.json, or none in the window
    Log log;
};

// Each returns an ExitCode.
int runHeadless(const RunOptions& options);
int runWindow(const RunOptions& options);

// The scene's name as a file's: letters, digits, '-' and '_' stay, all else becomes '_'.
std::string fileNameOf(const std::string& sceneName);

}  // namespace rivulet
