#!/usr/bin/env python3
"""guide.py PREFIX ROOT: what docs/embedding.md shows is true. Blocks with file=NAME are written into an empty folder, sh blocks are run there
one after the other, blocks with from=PATH must stand in that file of the project, word by word. A block that says neither is an error."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

prefix, root = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
page = root / "docs/embedding.md"
blocks = re.findall(r"^```(\S+)[ ]?([^\n]*)\n(.*?)^```$", page.read_text(), re.M | re.S)
if len(blocks) < 4:
    sys.exit(f"{page} has {len(blocks)} blocks of code: the test reads it wrongly")


def words(text):
    return " ".join(text.split())


# A reader's: nothing but the prefix is known; python3 is the system's, which has the system's NumPy.
environment = {name: os.environ[name] for name in ("HOME", "XDG_CACHE_HOME", "DISPLAY", "XAUTHORITY", "LIBGL_ALWAYS_SOFTWARE") if name in os.environ}
environment.update(PREFIX=str(prefix), PATH="/usr/bin:/bin")
has_numpy = subprocess.run(["/usr/bin/python3", "-c", "import numpy"], capture_output=True).returncode == 0
said_of_it = []  # by the programs that let the same water fall
with tempfile.TemporaryDirectory() as folder:
    for language, said, text in blocks:
        name, _, value = said.partition("=")
        if language == "sh" and "./build/window" in text and "DISPLAY" not in environment:
            print("left out, as there is no display:", text.strip())
        elif language == "sh" and "python3" in text and not has_numpy:
            print("left out, as NumPy is not installed:", text.strip())
        elif language == "sh":
            done = subprocess.run(["bash", "-eu", "-c", text], cwd=folder, env=environment, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(f"{page}: this fails:\n{text}\n{done.stdout}{done.stderr}")
            last = done.stdout.strip().splitlines()[-1] if done.stdout.strip() else ""
            print(last)
            said_of_it += [last] if "m high on average" in last else []
        elif name == "file":
            (pathlib.Path(folder) / value).write_text(text)
        elif name == "from":
            if words(text) not in words((root / value).read_text()):
                sys.exit(f"{page}: this is no longer in {value}:\n{text}")
        else:
            sys.exit(f"{page}: a block of {language} says neither file= nor from=:\n{text}")
if len(said_of_it) != 2 or said_of_it[0] != said_of_it[1]:
    sys.exit(f"{page}: in C++ and in C the same water should have fallen as low, and they say {said_of_it}")
