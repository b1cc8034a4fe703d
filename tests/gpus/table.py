#!/usr/bin/env python3
"""What compilers for GPUs make of every shader that scenes use: see README.md. run.sh starts it.

table.py BUILD             compares with table.csv: texts that changed since it was written, and an eleventh of the others
table.py BUILD whole       all texts
table.py BUILD write       all texts; writes table.csv, texts.txt and compilers.txt
table.py BUILD more        all texts, for more GPUs: prints what spills
table.py BUILD variants    writes variants.txt: runs all scenes
table.py BUILD check       whether variants.txt lacks a shader, or a kernel that a scene uses

Exit status 1: a new spill, a lost wave, a text that does not compile. 77: a compiler is not installed."""
import concurrent.futures
import csv
import glob
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import undefined

here = pathlib.Path(__file__).resolve().parent
root = here.parents[1]
COLUMNS = ["kernel", "variant", "stage", "compiler", "device", "registers", "spilled", "scratch_bytes", "waves", "most_waves", "instructions", "latency"]
# Compiler, its devices in table.csv, and more; the number: most waves (README.md says of what).
DEVICES = {"radv": {"POLARIS10": 8, "NAVI21": 32, "GFX1100": 32},
           "amdgcn": {"gfx900": 10, "gfx1030": 16},
           "nvptx": {"sm_61": ""},
           "igc": {"skl": 32}}
MORE = {"radv": {"TONGA": 10, "VEGA10": 10, "NAVI10": 40, "NAVI23": 32},
        "amdgcn": {"gfx803": 10, "gfx90a": 8},
        "nvptx": {"sm_86": ""},
        "igc": {"dg2": 32, "tgllp": 32}}
# The figures of a compiler depend on the versions of these packages.
PACKAGES = {"radv": ["mesa-vulkan-drivers", "glslang-tools"], "amdgcn": ["clang", "libclc-14"], "nvptx": ["clang", "libclc-14"],
            "igc": ["intel-opencl-icd", "libigc1", "libopencl-clang14"]}
PROGRAMS = {"glslangValidator": "glslang-tools", "spirv-val": "spirv-tools", "clang": "clang", "ocloc": "intel-opencl-icd"}
CLANG = ["clang", "-x", "cl", "-cl-std=CL1.2", "-cl-fp32-correctly-rounded-divide-sqrt", "-O3", "-S", "-w", "-nogpulib", "-Xclang", "-finclude-default-header",
         "-Xclang", "-fdeclare-opencl-builtins", "-Xclang", "-mlink-builtin-bitcode", "-Xclang"]
WITHOUT_DOUBLES = {"dg2", "icllp", "tgllp"}
TURNS = 11  # odd: .ci/run has eight kinds of runs, chosen by the same number, and this test is in five of them
pool = concurrent.futures.ThreadPoolExecutor(int(os.environ.get("RIVULET_JOBS", os.cpu_count())))


def run(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)


def ask(*command):
    """Output of a program of ours, or the end."""
    made = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True)
    if made.returncode:
        sys.exit(made.returncode)
    return made.stdout


class Refused(Exception):
    pass


class Shader:
    """A line of variants.txt, and its texts in a folder."""

    def __init__(self, folder, line):
        self.number, self.line, *files = line.rstrip("\n").split("\t")
        self.kernel, _, self.variant = self.line.partition(";")
        self.draws = "+" in self.kernel
        self.files = [names.split(" ") for names in files]
        self.path = folder / self.number

    def texts(self):
        return [f"{self.path}.{ending}" for ending in (("vert", "frag") if self.draws else ("comp",))]

    def hash(self):
        all_texts = self.texts() + ([] if self.draws else [f"{self.path}.cl"])
        return hashlib.sha256("".join(pathlib.Path(text).read_text() for text in all_texts).encode()).hexdigest()[:12]

    def row(self, stage, compiler, device, **figures):
        return {"kernel": self.kernel, "variant": self.variant, "stage": stage, "compiler": compiler, "device": device, **figures}

    def readable(self, log):
        """glslang's "ERROR: 2:17:" with the file's name; of a program, the fragment shader's"""
        names = self.files[-1]
        log = re.sub(r"ERROR: (\d+):(\d+):", lambda m: f"{names[int(m[1])] if int(m[1]) < len(names) else m[1]}:{m[2]}:", log)
        return "\n".join(line for line in log.splitlines() if ":" in line)[:1500]


def accept(shader):
    """Checks a shader as OpenGL and makes SPIR-V of it. Returns a sentence if that fails."""
    texts = shader.texts()
    checked = run("glslangValidator", "-l", *texts)
    if checked.returncode:
        return f"glslang does not accept {shader.line}:\n{shader.readable(checked.stdout)}"
    folder = pathlib.Path(f"{shader.path}.spirv")
    folder.mkdir()
    made = run("glslangValidator", "-V", "-R", "--aml", "--amb", *texts, cwd=folder)  # writes vert.spv, frag.spv or comp.spv
    if made.returncode:
        return f"glslang makes no SPIR-V of {shader.line}:\n{shader.readable(made.stdout)}"
    for module in sorted(folder.iterdir()):
        valid = run("spirv-val", "--target-env", "vulkan1.1", module)
        if valid.returncode:
            return f"spirv-val refuses {shader.line}, {module.stem}:\n{valid.stderr[:1500]}"
        if faults := undefined.check(module, module.stem):
            return "\n".join(f"{shader.line}, {module.stem}: {fault}" for fault in faults)
    return ""


def radv(build, shaders, chip, most):
    """Rows of one chip: RADV's null device compiles for it without the GPU."""
    drivers = ":".join(glob.glob("/usr/share/vulkan/icd.d/radeon_icd.*.json"))
    environment = dict(os.environ, VK_ICD_FILENAMES=drivers, VK_DRIVER_FILES=drivers, RADV_FORCE_FAMILY=chip, MESA_SHADER_CACHE_DISABLE="true")
    stages = {False: ["comp"], True: ["vert", "frag"]}
    lines = "".join(f"{s.number} " + " ".join(f"{s.path}.spirv/{stage}.spv" for stage in stages[s.draws]) + "\n" for s in shaders)
    made = run(build / "bin/gpu_pipelines", input=lines, env=environment)
    if made.returncode:
        raise Refused(f"RADV does not compile for {chip}: {made.stderr[-1500:]}")
    by_number = {s.number: s for s in shaders}
    rows = []
    for line in made.stdout.splitlines():
        if line.startswith("#"):
            continue
        number, stage, _, *pairs = line.split("\t")
        figure = {name: int(value) for name, value in (pair.split("=") for pair in pairs)}
        rows.append(by_number[number].row(
            stage, "radv", chip, registers=figure["VGPRs"], spilled=figure["Spilled VGPRs"], scratch_bytes=figure["Scratch size"],
            waves=figure["Subgroups per SIMD"], most_waves=most, instructions=figure["Instructions"], latency=figure["Latency"]))
    return rows


def assembly(shader, compiler, device, target, library):
    to = f"{shader.path}.{device}"
    made = run(*CLANG, library, "-target", target, f"-mcpu={device}" if compiler == "amdgcn" else "-Xclang", *([] if compiler == "amdgcn" else ["-target-cpu", "-Xclang", device]), "-o", to, f"{shader.path}.cl")
    if made.returncode:
        raise Refused(f"clang does not compile {shader.line} for {device}:\n{made.stderr[:1500]}")
    return pathlib.Path(to).read_text()


def amdgcn(build, shader, device, most):
    text = assembly(shader, "amdgcn", device, "amdgcn--amdhsa", "/usr/lib/clc/amdgcn--amdhsa.bc")
    figure = {name: int(re.search(pattern + r":\s+(\d+)", text)[1]) for name, pattern in
              {"registers": r"; NumVgprs", "spilled": r"\.vgpr_spill_count", "scratch_bytes": r"; ScratchSize", "waves": r"; Occupancy"}.items()}
    code = text[:text.index("s_endpgm")]
    return shader.row("compute", "amdgcn", device, most_waves=most, instructions=len(re.findall(r"^\t[a-z]", code, re.M)), latency="", **figure)


def nvptx(build, shader, device, most):
    text = assembly(shader, "nvptx", device, "nvptx64-unknown-nvidiacl", "/usr/lib/clc/nvptx64--nvidiacl.bc")
    depot = re.search(r"\.local .*__local_depot\d+\[(\d+)\]", text)
    return shader.row("compute", "nvptx", device, registers="", spilled="", scratch_bytes=int(depot[1]) if depot else 0, waves="", most_waves=most,
                      instructions=len(re.findall(r"^\t(?!\.|//)[^\n]*;", text, re.M)), latency="")


def igc(build, shader, device, most):
    """Nothing for a kernel with 64-bit floats on a GPU that has none."""
    text = re.sub(r"#define TO_DOUBLE.*", "", pathlib.Path(f"{shader.path}.cl").read_text())
    if device in WITHOUT_DOUBLES and re.search(r"\bTO_DOUBLE\(|\bdouble\b", text):
        return []
    folder = f"{shader.path}.{device}"
    made = run("ocloc", "compile", "-q", "-file", f"{shader.path}.cl", "-device", device, "--format", "zebin", "-options", "-cl-std=CL1.2",
               "-out_dir", folder, "-output", "kernel")
    binaries = glob.glob(folder + "/*.bin")
    if made.returncode or not binaries:
        raise Refused(f"ocloc does not compile {shader.line} for {device}:\n{made.stdout[:1500]}")
    info = pathlib.Path(binaries[0]).read_bytes().decode("latin-1")
    info = info[info.index("kernels:\n"):]
    def number(pattern):
        found = re.search(pattern, info)
        return int(found[1]) if found else 0
    spill = number(r"usage: +(?:spill_fill|single)_space\n +size: +(\d+)")
    return shader.row("compute", "igc", device, registers=number(r"grf_count: +(\d+)"), spilled=spill,
                      scratch_bytes=spill + number(r"usage: +private_space\n +size: +(\d+)"), waves=number(r"simd_size: +(\d+)"), most_waves=most,
                      instructions="", latency="")


def compiled(build, shaders, devices):
    """Rows of all, and the sentences about what does not compile."""
    faults = [fault for fault in pool.map(accept, shaders) if fault]
    if faults:
        return [], faults
    tasks = [pool.submit(radv, build, shaders, chip, most) for chip, most in devices.get("radv", {}).items()]
    for compiler, make in (("igc", igc), ("amdgcn", amdgcn), ("nvptx", nvptx)):
        for device, most in devices.get(compiler, {}).items():
            tasks += [pool.submit(make, build, shader, device, most) for shader in shaders if not shader.draws]
    rows = []
    for task in tasks:
        try:
            made = task.result()
            rows += made if isinstance(made, list) else [made]
        except Refused as fault:
            faults.append(str(fault))
    return rows, faults


def key(row):
    return tuple(row[column] for column in COLUMNS[:5])


def name(row):
    return f"{row['kernel']}{';' if row['variant'] else ''}{row['variant']}, {row['stage']}, {row['compiler']} for {row['device']}"


def worse(row, before):
    """Sentences about what got worse."""
    found = []
    for column, what in (("spilled", "spills"), ("scratch_bytes", "needs scratch memory of")):
        if row[column] != "" and int(row[column]) > int(before[column]):
            found.append(f"{name(row)}: {what} {row[column]}, and {before[column]} in table.csv")
    if row["waves"] != "" and int(row["waves"]) < int(before["waves"]):
        found.append(f"{name(row)}: {row['waves']} of {row['most_waves']} waves, and {before['waves']} in table.csv")
    return found


def summary(rows):
    for compiler, device in dict.fromkeys((row["compiler"], row["device"]) for row in rows):
        own = [row for row in rows if (row["compiler"], row["device"]) == (compiler, device)]
        spills = [row for row in own if row["spilled"] not in ("", 0)]
        scratch = [row for row in own if row["scratch_bytes"] not in ("", 0)]
        print(f"{compiler} for {device}: {len(own)} shaders, {len(spills)} spill, {len(scratch)} use scratch memory")
        for row in spills[:20]:
            print(f"  {name(row)}: {row['registers']} registers, {row['spilled']} spilled, {row['waves']} waves")


def versions():
    found = {}
    for package in sorted({package for packages in PACKAGES.values() for package in packages}):
        found[package] = run("dpkg-query", "-W", "-f", "${Version}", package).stdout.strip()
    return found


def planted(build, folder, devices):
    """The comparison sees a spill: of a text that holds 400 numbers at once, against a row that has none."""
    values = range(400)
    reads = "".join(f"    float v{k} = a[i + {k}u * 64u];\n" for k in values)
    total = " + ".join(f"v{k}" for k in values)
    writes = "".join(f"    b[i + {k}u * 64u] = v{k} * sum;\n" for k in values)
    body = f"{reads}    float sum = {total};\n{writes}"
    (folder / "planted.comp").write_text(
        "#version 450 core\nlayout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer A { float a[]; };\n"
        "layout(std430, binding = 1) buffer B { float b[]; };\nvoid main() {\n    uint i = gl_GlobalInvocationID.x;\n" + body + "}\n")
    (folder / "planted.cl").write_text("__kernel void planted(__global float* a, __global float* b) {\n    uint i = (uint)get_global_id(0);\n"
                                       + body.replace("u * 64u", " * 64") + "}\n")
    shader = Shader(folder, "planted\tplanted\tplanted")
    chosen = {compiler: dict([list(of.items())[-1]]) for compiler, of in devices.items() if compiler in ("radv", "igc")}  # clang takes minutes for it
    rows, faults = compiled(build, [shader], chosen)
    for row in rows:
        before = dict(row, spilled=0, scratch_bytes=0, waves=0)
        if not any("spills" in sentence for sentence in worse(row, before)):
            faults.append(f"the spill planted for {row['compiler']} and {row['device']} was not seen: {row}")
    return faults


def planted_undefined(folder):
    """undefined.py finds what was planted, and nothing in what is right."""
    def look(case):
        number, (stage, *wanted, body) = case
        text = folder / f"undefined{number}.{stage}"
        text.write_text(f"#version 450 core\n{undefined.BEGINS[stage]}{body}\n")
        made = run("glslangValidator", "-V", "-R", "--aml", "--amb", "-o", f"{text}.spv", text)
        if made.returncode:
            return f"glslang makes no SPIR-V of {body}:\n{made.stdout}"
        found = undefined.check(f"{text}.spv", stage)
        if wanted and not any(wanted[0] in sentence for sentence in found):
            return f"what was planted was not found: {body}"
        return "" if wanted or not found else f"a fault was found where there is none: {body}: {found}"
    return [fault for fault in pool.map(look, enumerate(undefined.PLANTED + undefined.SOUND)) if fault]


def compare(build, mode):
    for program, package in PROGRAMS.items():
        if run("which", program).returncode:
            print(f"skipped: {program} is not installed (package {package})")
            return 77
    installed = versions()
    missing = [package for package, version in installed.items() if not version]
    if missing or not (build / "bin/gpu_pipelines").exists():
        print(f"skipped: not installed: {', '.join(missing) or 'libvulkan-dev, when the tests were built'}")
        return 77
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        ask(build / "bin/test_gpus", "texts", here / "variants.txt", folder)
        shaders = [Shader(folder, line) for line in (folder / "index.txt").read_text().splitlines()]
        hashes = {shader.line: shader.hash() for shader in shaders}
        if mode in ("write", "more"):
            rows, faults = compiled(build, shaders, MORE if mode == "more" else DEVICES)
            summary(rows)
            print(*faults, sep="\n")
            if mode == "write" and rows:
                write(rows, hashes, installed)
            return 1 if faults else 0
        known = {line.split(" ", 1)[1]: line.split(" ", 1)[0] for line in (here / "texts.txt").read_text().splitlines()}
        made_with = dict(line.split(" ") for line in (here / "compilers.txt").read_text().splitlines())
        with open(here / "table.csv", newline="") as file:
            table = {key(row): row for row in csv.DictReader(file)}
        others = {compiler for compiler, packages in PACKAGES.items() if any(installed[p] != made_with.get(p) for p in packages)}
        for compiler in sorted(others):
            print(f"{compiler} is not the one that table.csv was made with, so its figures are not compared: "
                  + ", ".join(f"{p} {installed[p]}, table {made_with.get(p)}" for p in PACKAGES[compiler]))
        changed = [shader for shader in shaders if known.get(shader.line) != hashes[shader.line]]
        turn = int(run("git", "-C", root, "rev-list", "--count", "HEAD").stdout or 0)
        same = [shader for shader in shaders if shader not in changed]
        chosen = shaders if mode == "whole" else changed + same[turn % TURNS::TURNS]
        print(f"{len(shaders)} shaders, {len(changed)} with another text than in table.csv; compiling {len(chosen)}")
        rows, faults = compiled(build, chosen, DEVICES)
        for row in rows:
            before = table.get(key(row))
            if before is None and row["compiler"] not in others:
                faults.append(f"table.csv has no row for {name(row)}; write it again: bash tests/gpus/run.sh write")
            elif row["compiler"] not in others:
                faults += worse(row, before)
        faults += planted(build, folder, DEVICES) + planted_undefined(folder)
    print(*faults, sep="\n")
    if faults:
        print("If a change is meant, write the table again and give its figures in the commit: bash tests/gpus/run.sh write")
    return 1 if faults else 0


def write(rows, hashes, installed):
    with open(here / "table.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: (row["kernel"], row["variant"], row["stage"], list(DEVICES).index(row["compiler"]),
                                                       list(DEVICES[row["compiler"]]).index(row["device"]))))
    (here / "texts.txt").write_text("".join(f"{hashes[line]} {line}\n" for line in sorted(hashes)))
    (here / "compilers.txt").write_text("".join(f"{package} {version}\n" for package, version in installed.items()))


def scenes():
    named = [line for line in (root / "assets/scenes.txt").read_text().splitlines() if line and not line.startswith("#")]
    return named, sorted(str(path) for folder in ("cases", "stability") for path in (root / "assets" / folder).glob("*.json"))


def list_variants(build):
    named, others = scenes()
    lines = ask(build / "bin/test_gpus", "variants", *named, *others)
    (here / "variants.txt").write_text(lines)
    rest = ask(build / "bin/test_gpus", "rest", here / "variants.txt")
    (here / "variants.txt").write_text("".join(sorted((lines + rest).splitlines(keepends=True))))
    return 0


def many_buffers():
    """Kernels with a row above 8 in any form, also in those that variants.txt does not list."""
    for path in sorted((root / "shaders").rglob("*")):
        if path.suffix not in (".kernel", ".h") or path.parent.name == "common":
            continue
        rows = re.findall(r"\b(?:RO|RW|MATTER_ARG)\((\d+),|#define \w+_(?:ROW|AT) (\d+)", path.read_text())
        if (most := max((int(row or other) for row, other in rows), default=0)) > 8:
            yield f"{path.relative_to(root)} has row {most} of ARGS: OpenGL guarantees 8 storage buffers"


def main():
    build, mode = pathlib.Path(sys.argv[1]).resolve(), (sys.argv[2:] or [""])[0]
    if mode not in ("", "whole", "write", "more", "variants", "check"):
        sys.exit(__doc__)
    if mode == "variants":
        return list_variants(build)
    if mode == "check":
        if faults := list(many_buffers()):
            print(*faults, sep="\n")
            return 1
        return subprocess.run([build / "bin/test_gpus", "check", here / "variants.txt", *scenes()[0]]).returncode
    return compare(build, mode)


sys.exit(main())
