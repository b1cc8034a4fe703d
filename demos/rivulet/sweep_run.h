// Runs the tasks of a sweep: one in this process, or all that have not ended on the cores of this machine.
#pragma once

#include <optional>

#include "demos/rivulet/sweep_folder.h"

namespace rivulet {

// Runs one task: its commands, one after another, until one fails. If another process runs it, waits, and runs it if that one did not end
// it. Returns an ExitCode; kDone: the task has ended; kFailed: a command failed; its last line is on stderr.
int runSweepTask(const Sweep& sweep, const SweepFolder& folder, size_t task, int threads);

// Runs all tasks that have not ended, `jobs` at a time. Returns an ExitCode; kFailed: some tasks failed; 128 + the signal that
// interrupted.
int runSweepTasks(const Sweep& sweep, const SweepFolder& folder, int jobs, int threads);

// The processors that this process may use.
int allowedProcessors();

}  // namespace rivulet
