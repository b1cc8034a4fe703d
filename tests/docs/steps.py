#!/usr/bin/env python3
"""steps.py PROGRAM ROOT PAGE: what a page that goes step by step tells a reader to do is done, in an empty folder that has the clone's assets/. Blocks
with file=NAME are written there; sh blocks are run one after the other and end with 0, or with N where they say exit=N; each line of a text
block is a line that the block before it printed."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

program, root, page = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
blocks = re.findall(r"^```(\S+)[ ]?([^\n]*)\n(.*?)^```$", page.read_text(), re.M | re.S)
if len(blocks) < 4:
    sys.exit(f"{page} has {len(blocks)} blocks: the test reads it wrongly")
environment = dict(os.environ, PATH=f"{program.parent}:/usr/bin:/bin")
environment.pop("RIVULET_ASSETS", None)
with tempfile.TemporaryDirectory() as folder:
    (pathlib.Path(folder) / "assets").symlink_to(root / "assets")
    printed = []
    for language, said, text in blocks:
        name, _, value = said.partition("=")
        if language == "sh":
            done = subprocess.run(["bash", "-eu", "-c", text], cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
            wanted = int(value) if name == "exit" else 0
            if done.returncode != wanted:
                sys.exit(f"{page}: this ends with {done.returncode}, not {wanted}:\n{text}\n{done.stdout}{done.stderr}")
            printed = done.stdout.splitlines()
        elif language == "text":
            for line in text.splitlines():
                if line not in printed:
                    sys.exit(f"{page}: this is not printed:\n{line}\nbut:\n" + "\n".join(printed))
        elif name == "file":
            (pathlib.Path(folder) / value).write_text(text)
        else:
            sys.exit(f"{page}: a block of {language} is neither sh nor text, and does not say file=:\n{text}")
print(f"{len(blocks)} blocks of {page.name} were followed")
