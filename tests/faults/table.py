#!/usr/bin/env python3
"""The table of faults: what fails, how that is brought about, and how many runs then crashed, hung or lost something. `bash tests/faults.sh`.

Exit status 1 unless all numbers are zero. Each run that is counted is shown on stderr, with the command that repeats it.
"""
import argparse
import concurrent.futures
import os
import re
import shutil
import struct
import sys
import tempfile
import threading
import time

import cases
import hosts
import inputs
import moments
import runs

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))


class Row:
    def __init__(self, fault, how):
        self.fault, self.how = fault, how
        self.inputs = self.crashed = self.hung = self.lost = 0
        self.statuses = set()  # exit statuses of its runs
        self.lock = threading.Lock()

    def count(self, what, repeat="", why=""):
        """`what`: "", "crashed", "hung" or "lost"."""
        with self.lock:
            self.inputs += 1
            if what:
                setattr(self, what, getattr(self, what) + 1)
                print(f"{self.fault}: {what}: {why}\n    {repeat}", file=sys.stderr, flush=True)

    def text(self):
        return f"{self.fault} | {self.how} | {self.inputs} | {self.crashed} | {self.hung} | {self.lost}"


class Faults:
    """What all rows share: the program, folders, workers."""
    def __init__(self, options):
        self.options = options
        self.program = options.program or os.path.join(options.build, "bin", "rivulet")
        self.library = os.path.join(options.build, "librivulet.so")
        self.interposer = os.path.join(options.build, "librivulet_faults.so")
        self.quick = options.quick
        self.work = tempfile.mkdtemp(prefix="rivulet-faults-")
        with open(os.path.join(HERE, "interposer.cpp"), encoding="utf-8") as file:
            names = re.search(r"kNames\[kKinds\] = \{(.*?)\};", file.read(), re.S).group(1)
        self.kinds = re.findall(r'"(\w+)"', names)
        kept = os.path.join(os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "rivulet_faults")
        self.environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.environment.update(RIVULET_ASSETS=os.path.join(ROOT, "assets"), MESA_SHADER_CACHE_DIR=os.path.join(kept, "mesa"),
                                POCL_CACHE_DIR=os.path.join(kept, "pocl"), LC_ALL="C")
        os.makedirs(os.path.join(kept, "mesa"), exist_ok=True)
        os.makedirs(os.path.join(kept, "pocl"), exist_ok=True)
        cores = sorted(os.sched_getaffinity(0))
        self.free_cores = cores[:options.jobs] if len(cores) >= options.jobs else cores
        self.local = threading.local()
        self.lock = threading.Lock()
        self.pool = concurrent.futures.ThreadPoolExecutor(len(self.free_cores))
        self.rows = []
        self.fixture = runs.fixture(self)

    def row(self, fault, how):
        self.rows.append(Row(fault, how))
        return self.rows[-1]

    def core(self):
        """The worker's own: the calls of a program on one core come in the same order each time."""
        if not hasattr(self.local, "core"):
            with self.lock:
                self.local.core = self.free_cores.pop()
        return self.local.core

    def room(self, case):
        path = os.path.join(self.work, f"{case.name.replace(' ', '_')}-{self.core()}")
        return cases.Room(path, self.fixture, case, self.environment)

    def all(self, tasks):
        """Each task is a function without arguments."""
        for done in concurrent.futures.as_completed([self.pool.submit(task) for task in tasks]):
            done.result()

    @staticmethod
    def say(text):
        print(text, file=sys.stderr, flush=True)

    def counts(self, path):
        with open(path, "rb") as file:
            data = file.read()
        return dict(zip(self.kinds + ["failed"], struct.unpack(f"<{len(data) // 8}q", data)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", help="the build folder")
    parser.add_argument("--quick", action="store_true", help="some minutes: few inputs of each row")
    parser.add_argument("--rows", default="", help="only rows whose names match this regular expression")
    parser.add_argument("--cases", default="", help="only cases whose names match this regular expression")
    parser.add_argument("--program", help="another program than that of the build folder")
    parser.add_argument("--keep", help="a folder for the files that crashed, hung or lost something")
    parser.add_argument("--seed", type=int, default=1, help="of the mutations and of the moments of signals")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    options = parser.parse_args()
    options.build = os.path.abspath(options.build)
    faults = Faults(options)
    start = time.monotonic()
    try:
        for name, measure in {**runs.ROWS, **hosts.ROWS, **moments.ROWS, **inputs.ROWS}.items():
            if re.search(options.rows, name):
                measure(faults)
                print(f"[{time.monotonic() - start:.0f} s] {name}", file=sys.stderr, flush=True)
    finally:
        shutil.rmtree(faults.work, ignore_errors=True)
    print("fault | injected how | inputs | crashed | hung | lost\n--- | --- | --- | --- | --- | ---")
    for row in faults.rows:
        print(row.text())
    bad = sum(row.crashed + row.hung + row.lost for row in faults.rows)
    empty = [row.fault for row in faults.rows if row.inputs == 0]
    print(f"{sum(row.inputs for row in faults.rows)} inputs in {time.monotonic() - start:.0f} s"
          + (f"; nothing was injected by: {', '.join(empty)}" if empty else ""), file=sys.stderr)
    return 1 if bad or empty else 0


if __name__ == "__main__":
    sys.exit(main())
