// Programs that a sweep starts.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "engine/core/result.h"

namespace rivulet {

struct NewProcess {
    std::vector<std::string> words;  // the first with a '/': a program; else rivulet itself, with these arguments
    std::string folder = {};         // working directory; empty: this one
    int input = -1;                  // a descriptor for its stdin; -1: /dev/null
    int output = -1;                 // a descriptor for its stdout and stderr; -1: /dev/null
    int errors = -1;                 // for its stderr alone; -1: as `output`
    bool group = false;              // in a process group of its own, which a signal reaches with all that it starts
    int kept = -1;                   // a descriptor that stays open in it and in what it starts: a lock
};

// Starts a program, which the kernel kills (SIGKILL) when the calling thread ends: it does not outlive a sweep that was killed. Programs
// that it starts itself do. Error (failed): no process can be made. A program that cannot be started ends with status 127.
Result<pid_t> startProcess(const NewProcess& process);

// The exit status as a shell gives it: 128 + the signal that ended the process.
int exitStatusOf(int waited);

// The last line of a text that is not empty: the last message of a program that has ended. At most 300 bytes.
std::string lastLine(const std::string& text);

}  // namespace rivulet
