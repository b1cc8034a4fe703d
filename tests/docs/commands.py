#!/usr/bin/env python3
"""commands.py PROGRAM ROOT: checks what README.md, CONTRIBUTING.md and docs/ tell a reader to type. It looks at every command in a block
without a language or of sh, and at every `rivulet ...`, `bash ...` and `--option` in a line. A run is shortened to one frame. A command that
takes minutes, or that has a FILE for the reader to name, is compared with --help: the verb, its options, its cases. A bare `--set ...`
belongs to the scene of its page or of its table row. On these pages and on those of all folders, links must lead to files and headings,
and files that are named must exist. docs/embedding.md and docs/tears_on_your_own_character.md have tests of their own (tests/embed/guide.py,
tests/docs/steps.py); docs/api.md and parameters.md hold no commands."""
import concurrent.futures
import fnmatch
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

program, root = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
pages = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]
linked = [*pages, root / "CHANGELOG.md", *(page for top in ("engine", "fluid", "assets", "third_party") for page in sorted((root / top).rglob("*.md")))]
pages = [page for page in pages if page.name not in ("embedding.md", "api.md", "parameters.md", "tears_on_your_own_character.md")]
scenes = {path.stem for path in (root / "assets/scenes").glob("*.json")}
LONG = ("validate", "bench", "chart")  # minutes each
wrong = []


def options(verb):
    said = subprocess.run([program, verb, "--help"], capture_output=True, text=True)
    return said.stdout if said.returncode == 0 else None


verbs = re.findall(r"^  ([\w-]+) ", subprocess.run([program, "--help"], capture_output=True, text=True).stdout, re.M)
helps = {verb: options(verb) for verb in verbs}
if "run" not in helps or not all(helps.values()):
    sys.exit(f"{program} --help names verbs that have no --help: {helps.keys()}")


def for_the_reader_to_name(word):
    return bool(re.fullmatch(r"\[?[A-Z]{2,}[A-Za-z0-9_.]*\]?(\.\.\.\]?)?|S|N", word)) or "YOUR" in word or "..." in word


def held_against_help(words, where):
    """What --help can say of a command that is not run."""
    verb = words[1]
    for word in words[2:]:
        name = word.strip("[]").split("=")[0]
        if name.startswith("--") and not re.search(rf"(^|[ ,|]){name}\b", helps[verb], re.M):
            wrong.append(f"{where}: `rivulet {verb}` has no {name}")
        elif verb in LONG and re.fullmatch(r"[a-z][a-z0-9_]+", word) and words[words.index(word) - 1] not in ("--out", "--method", "--backend"):
            if not re.search(rf"\b{word}\b", helps[verb]):
                wrong.append(f"{where}: `rivulet {verb}` knows no case {word}")


def shortened(words, folder):
    """The same command, of one frame or of a coarse mesh, that writes into the folder."""
    verb, out = words[1], [str(program), words[1]]
    values = {"--frames": "1", "--seconds": "0.02", "--still": "0", "--size": "64x36", "--resolution": "24", "--every": "1"}
    files = ("--out", "--video", "--stats", "--trace", "--save", "--record", "--slices", "--picture", "--json", "--markdown")
    dropped = False
    for before, word in zip([""] + words[2:], words[2:]):
        if dropped:
            dropped = False
        elif word in values or word in files:
            out += [word, values[word]] if word in values else [word, str(folder / os.path.basename(words[words.index(word) + 1]))]
            dropped = True
        elif verb == "voxelize" and re.search(r"\.(obj|glb|gltf|fbx)$", word) and not (root / word).exists() and before != "--set":
            out.append(str(root / "assets/meshes/spot.obj"))
        else:
            out.append(word)
    if verb in ("run", "export") and "--out" not in out:
        out += ["--out", str(folder / "out")]
    if verb == "run":
        shows = any(re.search(r"look\.|background\.|light\.|camera\.", word) or word in ("--still", "--video", "--size") for word in out)
        if not {"--frames", "--seconds", "--still"} & set(out):
            out += ["--frames", "1"]
        if "--no-render" not in out:
            out += ["--headless", "--size", "64x36"] if shows and "--size" not in out else ["--headless"] if shows else ["--no-render"]
    if verb == "export" and "--seconds" not in out:
        out += ["--seconds", "0.02"]
    if verb == "sweep":
        out += ["--output", str(folder / "sweep"), "--dry-run"]
    if verb == "voxelize" and "--out" not in out:
        out += ["--out", str(folder / "mesh.rvox")]
    return out


def run(command, where):
    with tempfile.TemporaryDirectory() as folder:
        words = shortened(command, pathlib.Path(folder))
        done = subprocess.run(words, cwd=root, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            return f"{where}: `{shlex.join(command)}`, run as `rivulet {shlex.join(words[1:])}`, says {done.stderr.strip()}"
    return None


runs = {}  # what is to be run: the first place that says so


def look_at(text, where):
    try:
        words = shlex.split(text, comments=True)
    except ValueError as error:
        wrong.append(f"{where}: `{text}`: {error}")
        return
    while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
        words.pop(0)
    for cut in ("|", ">", "&&", "<"):
        if cut in words:
            words = words[: words.index(cut)]
    if not words:
        return
    if words[0] == "bash":
        script = root / words[1]
        if not script.is_file() or subprocess.run(["bash", "-n", script]).returncode != 0:
            wrong.append(f"{where}: {words[1]} is no script of this project")
        if words[1] == "demos/run.sh" and len(words) > 2:
            before = [] if words[2] in helps else ["run", "column_over_spot"] if words[2].startswith("-") else ["run"]
            look_at("rivulet " + shlex.join(before + words[2:]), where)
    elif words[0] == "cmake" and "--preset" in words:
        if f'"{words[words.index("--preset") + 1]}"' not in (root / "CMakePresets.json").read_text():
            wrong.append(f"{where}: there is no preset {words[words.index('--preset') + 1]}")
    elif words[0] == "rivulet" and len(words) > 1:
        if words[1] in ("VERB", "--help"):
            return
        if words[1] not in helps:
            wrong.append(f"{where}: there is no verb {words[1]}")
        elif words[1] in LONG or any(for_the_reader_to_name(word) for word in words[2:]) or "--replay" in words or "--resume" in words:
            held_against_help(words, where)
        else:
            runs.setdefault(tuple(words), where)


def headings(page):
    """The anchors that GitHub gives to a page's headings."""
    lines = re.findall(r"^#+ (.*)$", page.read_text(), re.M)
    return {re.sub(r"[^\w -]", "", line.lower()).replace(" ", "-") for line in lines}


TOPS = ("engine", "fluid", "shaders", "tests", "demos", "assets", "docs", "third_party")
files = {path.name for top in TOPS for path in (root / top).rglob("*") if path.is_file()} | {path.name for path in root.iterdir()}
for page in linked:
    name, text = page.relative_to(root), re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    for link, anchor in re.findall(r"\]\(([^)#\s]*)(#[^)\s]*)?\)", re.sub(r"`[^`\n]*`", "", text)):
        target = page.parent / link if link else page
        if "://" in link:
            continue
        if not target.exists():
            wrong.append(f"{name}: the link {link} leads to no file")
        elif anchor and target.suffix == ".md" and anchor[1:] not in headings(target):
            wrong.append(f"{name}: the link {link}{anchor} leads to no heading")
    if page.name in ("CHANGELOG.md", "parameters.md"):
        continue  # old names; keys that look like files
    for code in re.findall(r"`([^`\n]+)`", re.sub(r"^`[^`\n]+`, new:$", "", text, flags=re.M)):  # a recipe's new files
        code = code.strip('"<>').removeprefix("rivulet/")  # as a host includes a header
        is_path = re.fullmatch(rf"({'|'.join(TOPS)})/[\w./*-]+", code) and re.search(r"/$|\*|\.\w+$", code)
        if is_path and not re.search("[A-Z]{4}", code) and not any(root.glob(code.rstrip("/"))):
            wrong.append(f"{name}: there is no file {code}")
        elif (re.fullmatch(r"[\w*]+\.(h|cpp|kernel|cmake|glsl|frag|vert)", code) and not re.search("[A-Z]{4}", code)
              and not fnmatch.filter(files, code)):
            wrong.append(f"{name}: there is no file called {code}")

for page in pages:
    name, scene = page.relative_to(root), page.stem if page.parent.name == "scenes" and page.stem in scenes else None
    text = page.read_text()
    language = None  # of the block that this line is in
    joined = ""
    for line in text.splitlines():
        if line.startswith("```"):
            language = line[3:].split(" ")[0] if language is None else None
            continue
        if language is not None:
            joined += line
            if joined.endswith("\\"):
                joined = joined[:-1]
            else:
                if language in ("", "sh", "bash"):
                    look_at(re.split(r" {2,}", joined.strip())[0], name)  # after two blanks a synopsis says what the verb does
                joined = ""
            continue
        codes = re.findall(r"`([^`]+)`", line)
        row = [code for code in codes if code in scenes] if line.startswith("|") else []
        for code in codes:
            if re.match(r"(rivulet|bash) ", code):
                look_at(code, name)
            elif re.match(r"--[a-z]", code):
                for owner in row or ([scene] if scene else []):
                    look_at(f"rivulet run {owner} {code}", name)
                option = re.match(r"--[a-z-]+", code)[0]
                if not any(re.search(rf"(^|[ ,|]){option}\b", text, re.M) for text in helps.values()) and option not in ("--help", "--video"):
                    wrong.append(f"{name}: no verb has {option}")
for scene in sorted(scenes):
    page = root / f"docs/scenes/{scene}.md"
    if not page.is_file() or f"rivulet run {scene}" not in page.read_text():
        wrong.append(f"{page.relative_to(root)}: the page of a scene, with a command that runs it, is missing")
if len(runs) < 60:
    sys.exit(f"only {len(runs)} commands were found in {len(pages)} pages: the test reads them wrongly")
with concurrent.futures.ThreadPoolExecutor(2) as pool:
    for said in pool.map(lambda item: run(list(item[0]), item[1]), runs.items()):
        wrong += [said] if said else []
print(f"{len(runs)} commands of {len(pages)} pages were run")
for each in wrong:
    print(each)
sys.exit(1 if wrong else 0)
