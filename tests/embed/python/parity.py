"""parity.py ROOT: the package has all that rivulet.h has. Reads the headers: each function must be called by a public method and have as many
types as parameters; each struct must have the members of the header, and where a C compiler is there their offsets. What a program in Python
does without is listed below, with the reason."""
import ctypes
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import rivulet
import rivulet.fit
from rivulet import _library, _structs

WITHOUT_STRUCT = {"jobs": "a job system in Python would hold each thread of the library until the lock of the interpreter is free",
                  "memory": "as jobs; NumPy has no allocator that another library may use",
                  "drawing": "of rivulet_renderer", "renderer": "a renderer that is called within a draw is written in C, as its OpenGL calls are",
                  "error": "an exception"}
AS_ARRAYS = {"pose": "POSE", "body_state": "STATE", "body_load": "LOAD", "body_contact": "CONTACT_ROW", "sample": "SAMPLE", "ray": "RAY", "hit": "HIT",
             "volume": "VOLUME", "volume_count": "COUNT", "load": "LOADS", "light": "LIGHT"}
root = pathlib.Path(sys.argv[1]).resolve()
headers = "\n".join(path.read_text() for path in sorted((root / "fluid/capi").glob("rivulet*.h")))
headers = re.sub(r"/\*.*?\*/", "", headers, flags=re.S)
package = "\n".join(path.read_text() for path in sorted((root / "fluid/python/rivulet").glob("*.py")) if path.name not in ("_library.py", "_structs.py"))
missing = []

functions = {name: parameters for name, parameters in re.findall(r"RIVULET_API\s[^;(]*?\brivulet_(\w+)\(([^;]*)\);", headers)}
assert len(functions) > 55, functions.keys()
for name, parameters in functions.items():
    kind, _, rest = name.partition("_")
    named = [f'"{name}"', f"rivulet_{name}(", f"rivulet_{name}."] + ([f'"_{rest}"'] if kind in ("world", "snapshot") else [])
    if name.endswith("_destroy"):
        named = ["_destroy"]
    if not any(each in package for each in named) and name != "version":
        missing.append(f"rivulet_{name} is called nowhere in the package")
    depth, count = 0, 0 if parameters.strip() == "void" else 1
    for letter in parameters:
        depth += (letter == "(") - (letter == ")")
        count += letter == "," and depth == 0
    types = getattr(_library.lib, f"rivulet_{name}").argtypes or []
    if len(types) != count:
        missing.append(f"rivulet_{name} has {count} parameters, and the package says {len(types)}")

structs = dict((name, body) for body, name in re.findall(r"typedef struct rivulet_\w+ \{(.*?)\n?\} rivulet_(\w+);", headers, re.S))
assert len(structs) > 30, structs.keys()
offsets = []  # (C, Python's value)
for name, body in structs.items():
    if name in WITHOUT_STRUCT:
        continue
    members = []
    for line in body.split(";"):
        line = re.sub(r"\[[^\]]*\]", "", line.strip())
        if "(*" in line:
            members += re.findall(r"\(\*\s*(\w+)\)", line)[:1]
        elif line:
            first, *others = line.split(",")
            members += [re.findall(r"\w+", part)[-1] for part in (first, *others)]
    if name in AS_ARRAYS:
        kind = getattr(_structs, AS_ARRAYS[name])
        offsets += [(f"sizeof(rivulet_{name})", kind.itemsize)]
        places = {member: kind.fields[member][1] for member in kind.names}
        if name == "body_state":
            members = ["pose.position", "pose.rotation", *members[1:]]
            places.update({"pose.position": places.pop("position"), "pose.rotation": places.pop("rotation")})
        have = list(places)
        have.sort(key=places.get)
    else:
        kind = getattr(_structs, name.title().replace("_", ""), None)
        if kind is None:
            missing.append(f"rivulet_{name} is no struct of the package")
            continue
        have = [field[0] for field in kind._fields_]
        places = {member: getattr(kind, member).offset for member in have}
        offsets += [(f"sizeof(rivulet_{name})", ctypes.sizeof(kind))]
    if have != members:
        missing.append(f"rivulet_{name} has the members {members}, and the package {have}")
    else:
        offsets += [(f"offsetof(rivulet_{name}, {member})", places[member]) for member in members]

if shutil.which("cc"):
    with tempfile.TemporaryDirectory() as folder:
        checks = "\n".join(f'if ({c} != {value}) {{ printf("{c} is %zu, and the package says {value}\\n", (size_t){c}); wrong = 1; }}' for c, value in offsets)
        source = f"#include <stddef.h>\n#include <stdio.h>\n#include \"fluid/capi/rivulet.h\"\nint main(void) {{ int wrong = 0;\n{checks}\nreturn wrong; }}\n"
        pathlib.Path(folder, "offsets.c").write_text(source)
        subprocess.run(["cc", f"-I{root}", "offsets.c", "-o", "offsets"], cwd=folder, check=True)
        said = subprocess.run(["./offsets"], cwd=folder, capture_output=True, text=True)
        missing += said.stdout.splitlines()
# What a program calls says what it is.
for module in (rivulet, rivulet.fit):
    for name in module.__all__:
        public = getattr(module, name)
        members = {key: value for key, value in vars(public).items() if not key.startswith("_")} if isinstance(public, type) else {}
        for key, value in {"": public, **members}.items():
            if (callable(value) or isinstance(value, property)) and not (getattr(value, "__doc__", None) or "").strip():
                missing.append(f"{module.__name__}.{name}{key and '.' + key} has no docstring")
# The words of C that the package replaces in a sentence are still those of the library.
sentences = "".join(path.read_text() for path in [*pathlib.Path(root, "fluid/capi").glob("*.cpp"), pathlib.Path(root, "fluid/render/backend.cpp")])
missing += [f"WORDS of _library.py has {words!r}, which no source of fluid/capi and not fluid/render/backend.cpp says" for words in _library.WORDS if words not in sentences]
for each in missing:
    print(each)
print(f"{len(functions)} functions and {len(structs)} structs of rivulet.h were compared, {len(offsets)} offsets and sizes")
sys.exit(bool(missing))
