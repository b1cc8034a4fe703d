#!/usr/bin/env python3
"""Writes the tables of the GPU cost model (assets/gpus) from what is counted here: no figure in them depends on this machine's speed.

    python3 tests/gpu_cost/count.py kernels [--build build/release]   what each kernel does: OpenCL kernels in Oclgrind, with counter.cpp; 20 minutes
    python3 tests/gpu_cost/count.py frames  [--build build/release]   substeps and iterations of a frame, on the cpu; 10 minutes

    python3 tests/gpu_cost/count.py passes  [--build build/release]   what each drawing pass does: gpu_cost_passes, which it builds; minutes

    python3 tests/gpu_cost/count.py small   [--build build/release]   what each kernel does in the small worlds of tests/races; 15 minutes

    python3 tests/gpu_cost/count.py waves                             fills the columns `waves` from tests/gpus/table.csv

Needs the packages oclgrind, liboclgrind-dev and llvm-14-dev (kernels), glslang-tools and spirv-tools (passes). The scene is dam_break with default settings but for method and spacing.
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
SPACINGS = (0.03125, 0.0223, 0.0179)  # 1,024, 2,662 and 4,563 particles
COUNTED_AT = 0.2                        # s: the column has spread over half of the tank
FRAMES = 24
ITERATIONS = 5  # of a solver while it is counted: with the sweep for a frame's figures, a third of pbf_lambda's search for neighbours, as by default
ITERATED = {"fluid/methods/pbf_lambda", "fluid/methods/pbf_shift", "fluid/solids/follow_walls", "fluid/methods/dfsph_rate", "fluid/methods/dfsph_push",
            "fluid/methods/residual", "fluid/methods/solver_progress"}
# Worlds of tests/races that together run every kernel that any of them runs, about as few as possible.
WORLDS = ("skin", "thesisFlow", "flow", "bodiesTouch", "voxels", "wetness", "foam", "sources", "queries", "sleep", "implicitViscosity", "shifted", "pbf", "periodic",
          "thesis", "wcsph", "bodiesPbf")
PLAIN = {"bodiesPbf"}  # optimised code of probe_response has an intrinsic that Oclgrind 21.10 does not know: counted as it is written
HELD = 16  # waves of a SIMD of NAVI21, as LLVM has it for gfx1030 in table.csv; RADV goes by registers alone, to 32 of 32 threads
ONCE = {"fluid/surface/ellipsoids", "fluid/world/stats", "fluid/world/set_ratio"}  # a frame


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


def occupancy():
    """(Path of a kernel, variant as counter.cpp writes it) -> the share of the waves that NAVI21 holds which its registers allow, where tests/gpus has it."""
    table = ROOT / "tests/gpus/table.csv"
    shares = {}
    if not table.exists():
        return shares
    lines = [line for line in table.read_text().splitlines() if not line.startswith("#")]
    for row in csv.DictReader(lines):
        if row["device"] != "NAVI21" or row["stage"] != "compute":
            continue
        defines = sorted(d for d in row["variant"].split(";") if d and not d.startswith("LOCAL_SIZE="))
        shares[row["kernel"], ";".join(defines) or "-"] = min(1.0, float(row["waves"]) / HELD)
    return shares


def waves_of(shares, row):
    """Of the variants that were counted: their waves differ by half and more. The least of them, if there are several. Empty if tests/gpus has none of them."""
    known = [shares[row["kernel"], v] for v in row["variants"].split() if (row["kernel"], v) in shares]
    return f"{min(known):.3g}" if known else ""


def count_kernels(program, to, spacings, methods, _worlds):
    rows, waves = [], occupancy()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        counter = plugin(folder)
        for method in methods:
            for spacing in spacings:
                state, counts, stats = folder / "water.rstate", folder / "counts.csv", folder / "stats.json"
                run([program, "run", "dam_break", *settings(method, spacing), "--backend", "cpu", "--seconds", COUNTED_AT, "--save", state, "--stats", stats])
                particles = json.loads(stats.read_text())["particles"]
                # One substep: with slow sound a long one is allowed. What is done in it does not depend on the sound.
                run(["oclgrind", "--num-threads", 1, "--plugins", counter, program, "run", "dam_break", *settings(method, spacing), "--backend", "cl",
                     "--resume", state, "--frames", 1, "--stats", stats, "--set", "fluid.longestFrame=0.001", "--set", "fluid.soundSpeed=1",
                     "--set", f"fluid.dfsph.maxIterations={ITERATIONS}", "--set", f"fluid.pbf.iterations={ITERATIONS}",
                     "--set", "fluid.dfsph.tolerance=1e-6"], RIVULET_COUNTS=counts, XDG_CACHE_HOME=folder / f"{method}{spacing}")
                substeps = json.loads(stats.read_text())["substeps"]
                for row in csv.DictReader(io.StringIO(counts.read_text())):
                    calls, per = float(row.pop("calls")) / substeps, "step"
                    path = row.pop("kernel")
                    row.pop("groups")
                    if path in ITERATED:
                        calls, per = 1, "iteration"
                    elif path in ONCE:
                        calls, per = 1, "frame"
                    elif method == "pbf" and path == "fluid/solids/near_walls":
                        calls -= 1 / substeps  # for the figures of the frame
                    # The figures of a frame need walls and densities where the last step has left the particles.
                    more = 1 if method == "pbf" and path in ("fluid/solids/near_walls", "fluid/methods/pbf_lambda") else 0
                    rows.append({"method": method, "particles": particles, "kernel": path, "variants": row.pop("variants"), "per": per,
                                 "calls": f"{calls:g}", "frame_calls": more, "waves": "", **row})
                    rows[-1]["waves"] = waves_of(waves, rows[-1])
                print(f"{method}, {particles} particles: {substeps} substeps", flush=True)
    write(to / "kernels.csv", "What the kernels of dam_break do in a dispatch, a thread, means: counted in Oclgrind by tests/gpu_cost/count.py kernels.\n"
          "# variants: its defines, - if none. per: calls are in a step, an iteration or a frame; frame_calls: in a frame, more. waves: share of a GPU's waves that\n"
          "# registers allow, empty if tests/gpus/table.csv has none of the variants. step8, step32, step64: operations\n"
          "# of a thread, so many in lockstep. longest: operations and loads of the longest thread of a dispatch. sectors:\n"
          "# 32 bytes, of the accesses of 32 threads together, over 32. Bytes: read and written, each sector once a dispatch; group_bytes: once a\n"
          "# work group.", rows)


def fill_waves(_program, to, *_):
    waves = occupancy()
    for path in (to / "kernels.csv", to / "kernels_small.csv"):
        lines = path.read_text().splitlines(keepends=True)
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        for row in rows:
            row["waves"] = waves_of(waves, row)
        write(path, "".join(line for line in lines if line.startswith("#"))[2:].rstrip("\n"), rows)


def count_small(program, to, _spacings, _methods, worlds):
    rows, waves = {}, occupancy()
    if worlds != WORLDS:
        lines = (to / "kernels_small.csv").read_text().splitlines()
        rows = {(row["kernel"], row["variants"]): row for row in csv.DictReader(line for line in lines if not line.startswith("#")) if row["world"] not in worlds}
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        counter = plugin(folder)
        for world in worlds:
            counts = folder / "counts.csv"
            run(["oclgrind", "--num-threads", 1, "--plugins", counter, program.parent / "test_races", "--gtest_filter=*SmallWorlds*cl"], RIVULET_COUNTS=counts,
                RIVULET_COUNT_VARIANTS=1, RIVULET_RACES="full", RIVULET_WORLDS=world, RIVULET_TEST_DEVICES=1, XDG_CACHE_HOME=folder / world,
                **({"OCLGRIND_BUILD_OPTIONS": "-cl-opt-disable"} if world in PLAIN else {}))
            for row in csv.DictReader(io.StringIO(counts.read_text())):
                key = row.pop("kernel"), row.pop("variants")
                plain = int(world in PLAIN)
                # If several worlds run it: the one with the largest dispatches. Optimised code comes before code that is not.
                if key in rows and (plain, -float(row["threads"])) >= (int(rows[key]["plain"]), -float(rows[key]["threads"])):
                    continue
                rows[key] = {"kernel": key[0], "variants": key[1], "world": world, "plain": plain, "waves": "", **row}
                rows[key]["waves"] = waves_of(waves, rows[key])
            print(f"{world}: {len(rows)} variants of {len({kernel for kernel, _ in rows})} kernels so far", flush=True)
    write(to / "kernels_small.csv", "What kernels do in the small worlds of tests/races, of some hundred particles: counted in Oclgrind by tests/gpu_cost/count.py small. No\n"
          "# benchmark: fixed costs dominate. A row is a variant of a kernel (variants: its defines, - if none), in the world with the largest dispatches\n"
          "# of it. plain: 1 if its code was not optimised, as Oclgrind does not know an intrinsic of another kernel of that world: it has more operations then.\n"
          "# calls: dispatches; groups, threads: of one dispatch, means. Other columns: see kernels.csv.", [rows[key] for key in sorted(rows)])


def count_frames(program, to, *_):
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        stats = pathlib.Path(temporary) / "stats.json"
        # Steps are as long as particles are wide: the model scales the nearest row. The first frames of larger worlds alone are not like the others.
        for spacing, methods in ((0.015625, METHODS), (0.00685, ("pbf", "dfsph"))):
            for method in methods:
                run([program, "run", "dam_break", *settings(method, spacing), "--backend", "cpu", "--frames", FRAMES, "--stats", stats])
                s = json.loads(stats.read_text())
                rows.append({"method": method, "particles": s["particles"], "frames": FRAMES, "substeps": f"{s['substeps'] / s['frames']:.4g}",
                             "iterations": f"{s['iterations']:.4g}"})
                print(rows[-1], flush=True)
    write(to / "frames.csv", "Substeps in a frame of 1/60 s, and iterations of the pressure solver in a substep: dam_break on the cpu, its first frames, by\n"
          "# tests/gpu_cost/count.py frames.", rows)


ARITHMETIC = ("FAdd", "FSub", "FMul", "FNegate", "FOrd", "FUnord", "IAdd", "ISub", "IMul", "INotEqual", "IEqual", "SLess", "SGreater", "ULess", "UGreater",
              "Select", "Convert", "Bitwise", "Shift", "Not", "LogicalAnd", "LogicalOr", "BitField")
DIVISIONS = ("FDiv", "FMod", "FRem", "UDiv", "SDiv", "UMod", "SMod")
# Functions of GLSL, a component: operations, then roots, divisions and transcendental functions. Others are one operation.
FUNCTIONS = {"Fma": (2, 0), "FMix": (3, 0), "FClamp": (2, 0), "SClamp": (2, 0), "UClamp": (2, 0), "Step": (2, 0), "SmoothStep": (8, 1), "Fract": (2, 0),
             "Pow": (1, 2), "Sqrt": (0, 1), "InverseSqrt": (0, 1), "Exp": (1, 1), "Exp2": (0, 1), "Log": (1, 1), "Log2": (0, 1), "Sin": (1, 1), "Cos": (1, 1),
             "Tan": (2, 3), "Acos": (8, 1), "Asin": (8, 1), "Atan": (10, 1), "Atan2": (12, 1), "Cross": (3, 0), "Reflect": (3, 0)}


def operations_of(text, stage, folder):
    """What a shader's text has once each: operations (a branch is two), special (roots, divisions, transcendental functions), reads of textures. SPIR-V
    with everything inlined."""
    source, code = folder / f"one.{stage}", folder / "one.spv"
    source.write_text(text)
    run(["glslangValidator", "-G", "--auto-map-locations", "--auto-map-bindings", "-S", stage, source, "-o", code])
    run(["spirv-opt", "--skip-validation", "-O", code, "-o", code])
    widths, count = {}, {"operations": 0, "special": 0, "reads": 0}
    for line in run(["spirv-dis", "--raw-id", "--no-header", code]).splitlines():
        words = line.split()
        if words and words[0] == "OpBranchConditional":
            count["operations"] += 2
        if len(words) < 3 or words[1] != "=":
            continue
        name = words[2][2:]
        if name == "TypeVector":
            widths[words[0]] = int(words[4])
        width = widths.get(words[3], 1) if len(words) > 3 else 1
        if name.startswith(("ImageSample", "ImageFetch")):
            count["reads"] += 1
        elif name == "Dot":
            count["operations"] += 5  # of three components, as are Length and Normalize
        elif name in DIVISIONS:
            count["special"] += width
        elif name == "ExtInst" and words[5] in ("Length", "Normalize", "Distance"):
            count["operations"] += 5 + (width if words[5] == "Normalize" else 0)
            count["special"] += 1
        elif name == "ExtInst":
            operations, special = FUNCTIONS.get(words[5], (1, 0))
            count["operations"] += operations * width
            count["special"] += special * width
        elif name in ("VectorTimesMatrix", "MatrixTimesVector"):
            count["operations"] += width * (2 * width - 1)
        elif name == "VectorTimesScalar" or name.startswith(ARITHMETIC):
            count["operations"] += width
    return count


def count_passes(program, to, *_):
    rows = []
    build = program.parents[1]
    run(["cmake", "--build", build, "--target", "gpu_cost_passes"])
    for spacing, frames in ((0.015625, 18), (0.00684, 12), (0.00316, 2)):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            particles = int(run([next(build.rglob("gpu_cost_passes")), spacing, frames, folder]).split()[0])
            for row in csv.DictReader(io.StringIO((folder / "passes.csv").read_text())):
                invocations = {"vert": float(row["vertices"]), "frag": float(row["fragments"])}
                reads = {"vert": float(row.pop("vertex_reads")), "frag": float(row.pop("reads"))}
                fetches = {"vert": float(row.pop("vertex_fetches")), "frag": float(row.pop("fetches"))}
                out = {"particles": particles, **row}
                for stage, before in (("frag", ""), ("vert", "vertex_")):
                    shader = folder / f"{row['pass']}.{stage}"
                    each = operations_of(shader.read_text(), stage, folder) if shader.exists() else dict.fromkeys(("operations", "special", "reads"), 0)
                    counted = reads[stage] / invocations[stage] if invocations[stage] > 0 else 0
                    loops = max(1.0, counted / each["reads"] if each["reads"] else 1.0)
                    out[before + "reads"] = f"{counted:.4g}"
                    out[before + "fetches"] = f"{fetches[stage] / invocations[stage] if invocations[stage] > 0 else 0:.4g}"
                    for kind in ("operations", "special"):
                        out[before + kind] = f"{each[kind] * loops:.4g}"
                rows.append(out)
            print(f"{particles} particles", flush=True)
    write(to / "passes.csv", "What the passes of a picture of dam_break do, 1920x1080, fine, with pbf: counted by tests/gpu_cost/count.py passes. Bytes: whole textures\n"
          "# and buffers, once for each pass that declares them. reads (of textures), fetches (of texels) among them,\n"
          "# operations (a branch is two) and special (roots, divisions, transcendental functions): of a fragment; of a vertex.", rows)


def write(path, doc, rows):
    path.parent.mkdir(exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"# {doc}\n")
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=("kernels", "frames", "passes", "small", "waves"))
    parser.add_argument("--build", default=ROOT / "build/release", type=pathlib.Path)
    parser.add_argument("--to", default=TABLES, type=pathlib.Path, help="folder of the table")
    parser.add_argument("--spacings", default=SPACINGS, type=float, nargs="+", help="of kernels, m: at least two for a prediction")
    parser.add_argument("--methods", default=METHODS, nargs="+", help="of kernels")
    parser.add_argument("--worlds", default=WORLDS, nargs="+", help="of small: only these, the others keep their rows")
    arguments = parser.parse_args()
    program = arguments.build.resolve() / "bin/rivulet"
    {"kernels": count_kernels, "frames": count_frames, "passes": count_passes, "small": count_small, "waves": fill_waves}[arguments.table](program, arguments.to, arguments.spacings, arguments.methods, arguments.worlds)


if __name__ == "__main__":
    main()
