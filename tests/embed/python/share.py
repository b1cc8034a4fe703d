"""share.py [STEPS]: Python's share of a step of 31,000 particles on the cpu. Run by name; needs a C compiler and the importable package.

A function in C stands between the package and rivulet_world_step and takes the time of the call itself. What a step takes in Python beyond it is
Python's: arguments, structs, errors, the interpreter's lock. Both are of the same step, so that the load of the machine is in both. Then steps
by a loop in C and by a loop in Python in turn, which shows what the first measurement would not see."""
import ctypes
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import rivulet
from rivulet import _library

SOURCE = """
#include <time.h>
typedef int (*step_function)(void* world, const void* inputs, double seconds, void* why);
step_function rivulet_step;
double rivulet_inside;
static double now(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec + 1e-9 * t.tv_nsec; }
int timed(void* world, const void* inputs, double seconds, void* why) {
    const double start = now();
    const int status = rivulet_step(world, inputs, seconds, why);
    rivulet_inside = now() - start;
    return status;
}
double loop(void* world, double seconds, int count) {
    const double start = now();
    for (int k = 0; k < count; ++k)
        if (rivulet_step(world, 0, seconds, 0) != 0) return -1;
    return now() - start;
}
"""
steps = int(sys.argv[1]) if len(sys.argv) > 1 else 300
with tempfile.TemporaryDirectory() as folder:
    pathlib.Path(folder, "timed.c").write_text(SOURCE)
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", "timed.c", "-o", "timed.so"], cwd=folder, check=True)
    timer = ctypes.CDLL(os.path.join(folder, "timed.so"))
original = _library.functions["world_step"]
timer.timed.argtypes = original.argtypes
timer.loop.argtypes, timer.loop.restype = [ctypes.c_void_p, ctypes.c_double, ctypes.c_int], ctypes.c_double
ctypes.c_void_p.in_dll(timer, "rivulet_step").value = ctypes.cast(original, ctypes.c_void_p).value
inside = ctypes.c_double.in_dll(timer, "rivulet_inside")

COLUMN = {"fluid": {"method": "wcsph", "spacing": 0.02, "box": {"max": [1.6, 1, 0.62]}, "blocks": [{"max": [0.62, 1, 0.4]}]}}
with rivulet.Context(backend="cpu") as context, context.world(COLUMN) as world:
    print(f"{world.stats().particles} particles, {context.device}")
    dt = 1e-4  # one substep
    for _ in range(20):
        world.step(dt)
    assert world.stats().substeps == 1
    own, whole = [], []
    _library.functions["world_step"] = timer.timed
    for _ in range(steps):
        start = time.perf_counter()
        world.step(dt)
        took = time.perf_counter() - start
        whole.append(took)
        own.append(took - inside.value)
    _library.functions["world_step"] = original
    step, extra = statistics.median(whole), statistics.median(own)
    print(f"a step: {1e3 * step:.2f} ms (least {1e3 * min(whole):.2f}); of it in Python: {1e6 * extra:.1f} us (least {1e6 * min(own):.1f})")
    print(f"Python's share: {100 * extra / step:.2f} % of the median step, {100 * extra / min(whole):.2f} % of the fastest")
    block, by_c, by_python = 10, [], []
    for _ in range(steps // (2 * block)):
        by_c.append(timer.loop(world._pointer, dt, block) / block)
        start = time.perf_counter()
        for _ in range(block):
            world.step(dt)
        by_python.append((time.perf_counter() - start) / block)
    assert min(by_c) > 0
    print(f"a loop of {block} steps in turn, ms a step: in C {1e3 * statistics.median(by_c):.3f} (least {1e3 * min(by_c):.3f}), "
          f"in Python {1e3 * statistics.median(by_python):.3f} (least {1e3 * min(by_python):.3f})")
