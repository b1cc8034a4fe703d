// Hands the tasks of a sweep to other programs: Slurm, GNU parallel.
#pragma once

#include "demos/rivulet/sweep_folder.h"

namespace rivulet {

// Writes DIR/slurm.sh, an array job of the tasks that have not ended, and submits it by sbatch unless `dryRun`. Returns an ExitCode.
int sweepWithSlurm(const Sweep& sweep, const SweepFolder& folder, int threads, bool dryRun);

// Runs the tasks that have not ended by GNU parallel, `jobs` at a time. Returns an ExitCode: kFailed if some have not ended then.
int sweepWithParallel(const Sweep& sweep, const SweepFolder& folder, int jobs, int threads);

}  // namespace rivulet
