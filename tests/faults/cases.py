"""Small cases of the program's verbs, and what is owed to a user after a failure: old files whole, new ones complete, a sentence."""
import json
import os
import re
import shutil

SCENE = """{"name": "small", "duration": 0.1, "fluid": {"spacing": 0.03, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]},
 "blocks": [{"min": [0.05, 0.05, 0.05], "max": [0.2, 0.2, 0.15], "dye": [0.5, 1, 0.2]}]},
 "colliders": [{"mesh": "paddle.obj", "fitSize": 0.1, "position": [0.3, 0.3, 0.3], "resolution": 8, "motion": {"spin": 90}}],
 "emitters": [{"position": [0.1, 0.35, 0.3], "radius": 0.06, "litresPerSecond": 1}],
 "sinks": [{"position": [0.3, 0.1, 0.3], "size": [0.1, 0.1, 0.1]}],
 "bodies": [{"shape": "box", "position": [0.2, 0.35, 0.3], "size": [0.1, 0.1, 0.1]}],
 "presets": [{"name": "a", "set": "fluid.viscosity=0.01"}]}
"""
# 75 particles and nothing else, for runs of long duration.
PLAIN = """{"name": "plain", "duration": 0.1, "fluid": {"spacing": 0.03, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]},
 "blocks": [{"min": [0.05, 0.05, 0.05], "max": [0.2, 0.2, 0.15]}]}}
"""
OLD = b"an older file of this name\n"
INPUTS = ("s.json", "plain.json", "paddle.obj", "r.rrec", "s.rstate")


class Case:
    def __init__(self, name, words, outputs=(), needs=(), kinds=None, share=1.0, cpu=60, long=False):
        """`outputs`: files that it writes; `kinds`: of failures, those of table.py's list by default; `share`: of the usual inputs.
        `long`: minutes. It is not run to its end: all calls fail from the N-th on."""
        self.name, self.words, self.outputs = name, words.split(), tuple(outputs)
        self.needs, self.kinds, self.share, self.cpu = needs, kinds, share, cpu
        self.long = long
        self.new = {}      # contents of outputs that are the same in each run
        self.counts = {}   # calls of each kind
        self.err = set()  # lines of messages of a run without failures


def copy(case):
    """Of a measured case: for a worker that changes it."""
    other = Case(case.name, " ".join(case.words), case.outputs, case.needs, case.kinds, case.share, case.cpu, case.long)
    other.new, other.counts, other.err = dict(case.new), case.counts, case.err
    return other


CPU = "--no-render --backend cpu"
CASES = [
    Case("list", "list"),
    Case("list scenes", "list scenes"),
    Case("info", "info", share=0.5),
    Case("run", f"run s.json {CPU} --frames 2 --preset a --record n.rrec --save n.rstate --stats n.json --trace t.json --explain",
         ("n.rrec", "n.rstate", "n.json", "t.json"), share=2),
    Case("run --resume", f"run s.json {CPU} --frames 1 --resume s.rstate --save n.rstate --stats n.json", ("n.rstate", "n.json")),
    Case("run --video", "run plain.json --headless --backend cpu --size 64x48 --frames 2 --video v.mp4 --out out",
         ("v.mp4", "out/stats.json", "out/plain_0000.png", "out/plain_0001.png"), needs=("gl",), share=0.5),
    Case("run --replay", "run s.json --headless --size 64x48 --still 0 --out out --replay r.rrec", ("out/small_0000.png",),
         needs=("gl",), share=0.5),
    Case("voxelize", "voxelize paddle.obj --resolution 12 --backend cpu --labels --band --stats n.json --slices s.png --picture p.png"
         " --out p.rvox", ("p.rvox", "n.json", "s.png", "p.png")),
    Case("export csv", "export s.json --backend cpu --format csv --surface obj --out out --seconds 0.03",
         ("out/small_particles_0000.csv", "out/small_particles_0001.csv", "out/small_0000.obj", "out/small_0001.obj")),
    Case("export vtk", "export s.json --backend cpu --format vtk --surface ply --up z --out out --seconds 0.03",
         ("out/small_particles_0000.vtp", "out/small_particles_0001.vtp", "out/small_particles.pvd", "out/small_0000.ply",
          "out/small_0001.ply"), share=0.3),
    Case("validate", "validate elliptical_drop --method wcsph --quick --json n.json --pictures out",
         ("n.json",), share=0.2),
    Case("bench", "bench collide --json n.json --markdown n.md", ("n.json", "n.md"), long=True, share=0.3),
    Case("chart", "chart taylor_green --quick --out out", ("out/speed_accuracy.md",), long=True, share=0.3),
]
GL_KINDS = ("gl_memory", "gl_map", "gl_program", "gl_fence", "gl_target")
GL_CASES = [
    Case("run on gl", "run plain.json --no-render --backend gl --frames 2 --record n.rrec --stats n.json", ("n.rrec", "n.json"),
         needs=("gl",), kinds=GL_KINDS),
    Case("pictures by gl", "run plain.json --headless --backend cpu --size 64x48 --still 0 --out out", ("out/plain_0000.png",
         "out/stats.json"), needs=("gl",), kinds=GL_KINDS),
    Case("voxelize on gl", "voxelize paddle.obj --resolution 12 --backend gl --out p.rvox", ("p.rvox",), needs=("gl",), kinds=GL_KINDS),
]
CL_KINDS = ("cl_memory", "cl_command", "cl_build", "cl_open")
CL_CASES = [
    Case("run on cl", "run plain.json --no-render --backend cl --frames 2 --record n.rrec --stats n.json", ("n.rrec", "n.json"),
         needs=("cl",), kinds=CL_KINDS),
    Case("voxelize on cl", "voxelize paddle.obj --resolution 12 --backend cl --out p.rvox", ("p.rvox",), needs=("cl",), kinds=CL_KINDS),
]


def files_in(folder):
    found = {}
    for at, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(at, name)
            try:
                with open(path, "rb") as file:
                    found[os.path.relpath(path, folder)] = file.read()
            except OSError:
                found[os.path.relpath(path, folder)] = b""
    return found


def complete(name, data):
    """Whether a file of this kind ends as one that was written to its end."""
    if name.endswith(".json"):
        try:
            json.loads(data)
            return True
        except ValueError:
            return False
    if name.endswith(".png"):
        return data.startswith(b"\x89PNG") and data.endswith(b"IEND\xaeB`\x82")
    if name.endswith(".mp4"):
        return b"ftyp" in data[:16] and b"moov" in data and b"mdat" in data
    if name.endswith(".svg"):
        return data.rstrip().endswith(b"</svg>")
    if name.endswith((".vtp", ".pvd")):
        return data.rstrip().endswith(b"</VTKFile>")
    return len(data) > 0 and data.endswith(b"\n") if name.endswith((".md", ".csv", ".obj")) else len(data) > 0


RAW = re.compile(r"bad_alloc|std::|terminate|what\(\)|filesystem error|Assertion|basic_string|unexpected fault")


def bad_message(outcome, known):
    """Why the messages of a run that failed are not what a user is owed; None: they are."""
    lines = [line for line in outcome.err.splitlines() if line not in known]
    if outcome.status not in (1, 2):
        return f"exit status {outcome.status}"
    if not lines:
        return "no message"
    if RAW.search(outcome.err):
        return "raw words of a library"
    if not all(line.startswith("rivulet: ") for line in lines if "cannot compile" not in outcome.err and "link" not in outcome.err):
        return "a line that is no message"
    if any(len(line) > 520 for line in lines):
        return "a message of more than 500 characters"
    return None


class Room:
    """A folder in which a case runs again and again, from the same start."""
    def __init__(self, root, fixture, case, environment):
        self.root, self.case = root, case
        shutil.rmtree(root, ignore_errors=True)
        os.makedirs(root)
        self.inputs = {name: data for name, data in fixture.items() if name in INPUTS}
        self.environment = dict(environment, XDG_CACHE_HOME=os.path.join(root, "cache"), HOME=root, TMPDIR=root)
        self.fill()

    def write(self, name, data):
        path = os.path.join(self.root, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(data)

    def fill(self):
        """Inputs, older files under the names of the outputs, an empty cache."""
        shutil.rmtree(self.root, ignore_errors=True)
        os.makedirs(self.root)
        for name, data in self.inputs.items():
            self.write(name, data)
        for name in self.case.outputs:
            self.write(name, OLD)

    def verdict(self, outcome, check_new=True):
        """What is lost after a run; None: nothing."""
        case, now = self.case, files_in(self.root)
        for name, data in self.inputs.items():
            if now.get(name) != data:
                return f"the input {name} has changed"
        for name in now:
            if ".rivulet-" in name or name.endswith(".tmp"):
                return f"{name} is left behind"
        for name in case.outputs:
            data = now.get(name)
            if data is None:
                return f"{name} is gone"
            if data == OLD:
                if outcome.status == 0 and check_new:
                    return f"{name} was not written, and the exit status is 0"
            elif name in case.new and not name.endswith(".rrec"):
                if data != case.new[name]:
                    return f"{name} is not what a run without failures writes"
            elif not complete(name, data):
                return f"{name} is incomplete"
        for name, data in now.items():
            if name in self.inputs or name in case.outputs or name.startswith("cache/"):
                continue
            if not complete(name, data):
                return f"{name} is incomplete"
        return None
