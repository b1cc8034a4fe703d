#!/usr/bin/env python3
"""Writes the tables of the GPU cost model (assets/gpus) from what is counted here: no figure in them depends on this machine's speed.

    python3 tests/gpu_cost/count.py kernels [--build build/release]   what each kernel does: OpenCL kernels in Oclgrind, with counter.cpp; 20 minutes
    python3 tests/gpu_cost/count.py frames  [--build build/release]   substeps and iterations of a frame, on the cpu; 10 minutes

Needs the packages oclgrind, liboclgrind-dev and llvm-14-dev (kernels). The scene is dam_break with default settings but for method and spacing.
"""
import argparse
import csv
import io
import json
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLES = ROOT / "assets/gpus"
METHODS = ("wcsph", "pbf", "dfsph")
SPACINGS = (0.03125, 0.0223, 0.015625)  # 1,024, 2,662 and 8,192 particles
COUNTED_AT = 0.2                        # s: the column has spread over half of the tank
ITERATIONS = 3                          # of dfsph while it is counted


def run(words, **environment):
    done = subprocess.run([str(w) for w in words], env={**os.environ, **{k: str(v) for k, v in environment.items()}}, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, words))}\nended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def plugin(folder):
    """counter.cpp as a library; Oclgrind is built without type information, and against LLVM 14."""
    to = folder / "counter.so"
    flags = run(["llvm-config-14", "--cppflags"]).split()
    run(["g++", "-std=c++20", "-O2", "-fPIC", "-shared", "-fno-rtti", "-I/usr/include/oclgrind", *flags, ROOT / "tests/gpu_cost/counter.cpp", "-o", to])
    return to


def settings(method, spacing):
    return ["--set", f"fluid.method={method}", "--set", f"fluid.spacing={spacing}", "--no-render"]


def paths():
    """Name of a kernel -> its path below shaders: the names of those in fluid/ are unique."""
    return {p.stem: p.relative_to(ROOT / "shaders").with_suffix("").as_posix() for p in (ROOT / "shaders/fluid").rglob("*.kernel")}


def occupancy():
    """Path of a kernel -> the share of waves that its registers allow on NAVI21, where tests/gpus has measured it; the least of its variants."""
    table = ROOT / "tests/gpus/table.csv"
    shares = {}
    if not table.exists():
        return shares
    lines = [line for line in table.read_text().splitlines() if not line.startswith("#")]
    for row in csv.DictReader(lines):
        if "navi21" not in row["device"].lower() or not row["waves"] or not row["most_waves"]:
            continue
        share = float(row["waves"]) / float(row["most_waves"])
        shares[row["kernel"]] = min(share, shares.get(row["kernel"], 1.0))
    return shares


def count_kernels(program):
    rows, names, waves = [], paths(), occupancy()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        counter = plugin(folder)
        for method in METHODS:
            for spacing in SPACINGS:
                state, counts, stats = folder / "water.rstate", folder / "counts.csv", folder / "stats.json"
                run([program, "run", "dam_break", *settings(method, spacing), "--backend", "cpu", "--seconds", COUNTED_AT, "--save", state, "--stats", stats])
                particles = json.loads(stats.read_text())["particles"]
                # One substep: with slow sound a long one is allowed. What is done in it does not depend on the sound.
                run(["oclgrind", "--num-threads", 1, "--plugins", counter, program, "run", "dam_break", *settings(method, spacing), "--backend", "cl",
                     "--resume", state, "--frames", 1, "--stats", stats, "--set", "fluid.longestFrame=0.001", "--set", "fluid.soundSpeed=1",
                     "--set", f"fluid.dfsph.maxIterations={ITERATIONS}"], RIVULET_COUNTS=counts, XDG_CACHE_HOME=folder)
                substeps = json.loads(stats.read_text())["substeps"]
                for row in csv.DictReader(io.StringIO(counts.read_text())):
                    calls = float(row.pop("calls")) / substeps
                    per = "step"
                    if method == "dfsph" and calls == ITERATIONS:
                        calls, per = 1, "iteration"
                    path = names[row.pop("kernel")]
                    if path in ("fluid/surface/ellipsoids", "fluid/world/stats"):
                        calls, per = 1, "frame"
                    rows.append({"method": method, "particles": particles, "kernel": path, "per": per, "calls": f"{calls:g}",
                                 "waves": f"{waves.get(path, 1):.3g}", **row})
                print(f"{method}, {particles} particles: {substeps} substeps", flush=True)
    write("kernels", "What the kernels of dam_break do in a dispatch, a thread, means: counted in Oclgrind by tests/gpu_cost/count.py kernels.\n"
          "# per: calls are in a step, an iteration or a frame. waves: share of a GPU's waves that registers allow. step8, step32, step64: operations\n"
          "# if all threads of a group take as long as its longest. longest: operations and loads of the longest thread of a dispatch. sectors:\n"
          "# 32 bytes, of the accesses of 32 threads together, over 32. Bytes: read and written, each sector once a dispatch; group_bytes: once a\n"
          "# work group.", rows)


def count_frames(program):
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        stats = pathlib.Path(temporary) / "stats.json"
        for spacing, frames in ((0.015625, (24, 24, 24)), (0.00685, (3, 24, 24)), (0.00316, (0, 3, 2))):
            for method, many in zip(METHODS, frames):
                if many == 0:  # steps of wcsph are as long as particles are wide: the model scales the row before
                    continue
                run([program, "run", "dam_break", *settings(method, spacing), "--backend", "cpu", "--frames", many, "--stats", stats])
                s = json.loads(stats.read_text())
                rows.append({"method": method, "particles": s["particles"], "frames": many, "substeps": f"{s['substeps'] / s['frames']:.4g}",
                             "iterations": f"{s['iterations']:.4g}"})
                print(rows[-1], flush=True)
    write("frames", "Substeps in a frame of 1/60 s, and iterations of the pressure solver in a substep: dam_break on the cpu, its first frames, by\n"
          "# tests/gpu_cost/count.py frames.", rows)


def write(name, doc, rows):
    TABLES.mkdir(exist_ok=True)
    with open(TABLES / f"{name}.csv", "w", encoding="utf-8") as file:
        file.write(f"# {doc}\n")
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=("kernels", "frames"))
    parser.add_argument("--build", default=ROOT / "build/release", type=pathlib.Path)
    arguments = parser.parse_args()
    program = arguments.build.resolve() / "bin/rivulet"
    {"kernels": count_kernels, "frames": count_frames}[arguments.table](program)


if __name__ == "__main__":
    main()
