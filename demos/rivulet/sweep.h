// A sweep: command lines that run once for each combination of parameter values. Each combination is a task, independent of the others.
//
//     {"command": "run dam_break --no-render --backend cpu --seconds 2 --stats {task}/stats.json",
//      "parameters": {"fluid.method": ["pbf", "dfsph"],
//                     "fluid.viscosity": {"from": 1e-6, "to": 1e-3, "count": 7, "scale": "log"}}}
//
// docs/sweeps.md describes the file.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"

namespace rivulet {

inline constexpr size_t kMostTasks = 100'000;  // of one sweep

struct SweepParameter {
    std::string name;
    std::string place;                // "FILE:4:5", for messages
    std::vector<std::string> values;  // one for each task, as text
};

struct SweepCommand {
    std::vector<std::string>
        words;                     // the first is a verb of rivulet, or the path of another program; `run` and `export` with their outputs
    std::string place;             // as SweepParameter::place
    std::vector<size_t> set = {};  // of `run`: the parameters that follow as --set NAME=VALUE
};

struct Sweep {
    std::string file;    // the absolute path of SWEEP.json
    std::string folder;  // its folder, the working directory of the commands
    std::vector<SweepCommand> commands;
    std::vector<SweepParameter> parameters;  // in the order of the file
    size_t tasks = 0;                        // numbered from 0
};

// Reads a sweep from `text`, the content of `file`. Error (badInput), with file, line and column: invalid JSON, an unknown key, values that
// are no list and no range, an empty range, a logarithmic range through 0, more than kMostTasks tasks, a command that cannot be split into
// words, a name in braces that is neither `task` nor a parameter, a parameter that no command uses.
Result<Sweep> readSweep(std::string_view text, const std::string& file);

// The command's words for one task: {task} is `taskFolder`, {NAME} a parameter, {{ a brace. A command of the verb `run` is followed by
// --set NAME=VALUE of each parameter of a scene that it does not set itself, and of each that no command names in braces.
std::vector<std::string> wordsOf(const Sweep& sweep, const SweepCommand& command, size_t task, const std::string& taskFolder);

// Checks that the verb or program of each command exists, that no two tasks write the same file, and the arguments and the scene of each
// `run` as `rivulet run` does; changes the working directory to the sweep's folder. Returns the files that the runs read: of scenes, and
// recordings and states that no task writes. Error: with the place of the parameter that the message names, or of the command.
Result<std::set<std::string>> checkTasks(const Sweep& sweep);

}  // namespace rivulet
