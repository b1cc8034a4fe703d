#!/usr/bin/env python3
"""Reads every C++ file of the project a second time, with clang: `clang.py tidy BUILD` runs clang-tidy with .clang-tidy, which tells
of the compiler's own warnings too; `clang.py syntax BUILD` compiles the others, the tests, with -Werror and writes nothing. A file that
passed is not read again until its command, one of the files it includes, or .clang-tidy changes (stamps in BUILD/clang_stamps).
With RIVULET_LINT=part it reads the files that changed in the last 25 commits, or whose header did, and a twelfth of all others.
Which twelfth depends on the number of commits. Without git's history it reads all files. Exit 77: clang is not installed."""
import hashlib, json, os, shlex, shutil, subprocess, sys
from concurrent.futures import ThreadPoolExecutor

mode, build = sys.argv[1], os.path.abspath(sys.argv[2])
root = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
tool = {"syntax": "clang++", "tidy": "clang-tidy"}[mode]
if not shutil.which(tool) or not shutil.which("clang++"):
    print(f"skipped: {tool} is not installed")
    sys.exit(77)
stamps = os.path.join(build, "clang_stamps")
os.makedirs(stamps, exist_ok=True)


def files_of(entry):
    """The entry itself, or one for each file of the batch that it compiles (rivulet_batches of CMakeLists.txt): each file must stand alone."""
    if not entry["file"].startswith(os.path.join(build, "batches") + "/"):
        return [entry]
    with open(entry["file"]) as stream:
        files = [os.path.join(root, line.split('"')[1]) for line in stream]
    return [{"directory": entry["directory"], "file": file, "command": entry["command"].replace(entry["file"], file)} for file in files]


def clang_command(entry):
    """The file's own compile command, with clang++ in the compiler's place and nothing written."""
    words = shlex.split(entry["command"])
    while words and os.path.basename(words[0]).startswith("ccache"):
        words.pop(0)
    kept, skip = [], False
    for word in words[1:]:
        if skip:
            skip = False
        elif word in ("-o", "-MF", "-MT", "-MQ"):
            skip = True
        elif word not in ("-c", "-MD", "-MMD"):
            kept.append(word)
    return ["clang++", *kept, "-fsyntax-only", "-Werror", "-Wno-unknown-warning-option"]


def digest(command, files):
    total = hashlib.sha256("\0".join([mode, *command]).encode())
    for path in sorted({*files, os.path.join(root, ".clang-tidy"), os.path.abspath(__file__)}):
        with open(path, "rb") as stream:
            total.update(path.encode() + b"\0" + stream.read())
    return total.hexdigest()


def check(entry):
    source, command = os.path.join(entry["directory"], entry["file"]), clang_command(entry)
    stamp = os.path.join(stamps, hashlib.sha256("\0".join([mode, *command]).encode()).hexdigest())
    try:
        with open(stamp) as stream:
            known, *files = stream.read().splitlines()
        if digest(command, files) == known:
            return True, ""
    except (OSError, ValueError):
        pass
    deps = stamp + ".d"
    run = lambda words: subprocess.run(words, cwd=entry["directory"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    done = run([*command, "-MD", "-MF", deps] if mode == "syntax" else [*command[:-3], "-M", "-MF", deps])
    if done.returncode == 0 and mode == "tidy":
        done = run(["clang-tidy", "--quiet", "--warnings-as-errors=*", f"--header-filter=^{root}/(engine|fluid|demos)/.*", source,
                    "--", *command[1:-3], "-Wno-unknown-warning-option"])
    if done.returncode == 0:
        with open(deps) as stream:
            words = stream.read().replace("\\\n", " ").split()
        files = [os.path.join(entry["directory"], word) for word in words if not word.endswith(":")]
        with open(stamp, "w") as stream:
            stream.write("\n".join([digest(command, files), *files]))
    if os.path.exists(deps):
        os.remove(deps)
    return done.returncode == 0, f"== {os.path.relpath(source, root)}\n{done.stdout}"


with open(os.path.join(build, "compile_commands.json")) as stream:
    entries = [e for e in json.load(stream) if e["file"].endswith(".cpp")]
entries = [each for e in entries for each in files_of(e) if each["file"].startswith(root + "/") and not each["file"].startswith(build)]
# A kernel is compiled once an instruction set; tidy reads it once, and leaves the tests alone.
tidied = list({e["file"]: e for e in entries if not e["file"].startswith(root + "/tests/")}.values())
entries = tidied if mode == "tidy" else [e for e in entries if e not in tidied]


def part_of(entries):
    """See RIVULET_LINT above; all where git does not know the last 25 commits."""
    git = lambda *words: subprocess.run(["git", "-C", root, *words], capture_output=True, text=True).stdout.split()
    commits = git("rev-list", "--count", "HEAD")
    changed = {os.path.splitext(path)[0] for path in git("diff", "--name-only", "HEAD~25", "HEAD")}
    if not commits or not changed:
        return entries
    twelfth = lambda path: (int(hashlib.sha256(path.encode()).hexdigest(), 16) + int(commits[0])) % 12 == 0
    name = lambda entry: os.path.relpath(entry["file"], root)
    return [e for e in entries if os.path.splitext(name(e))[0] in changed or twelfth(name(e))]


if os.environ.get("RIVULET_LINT") == "part":
    entries = part_of(entries)
with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
    results = list(pool.map(check, entries))
for passed, text in results:
    if not passed:
        print(text)
failures = sum(not passed for passed, _ in results)
print(f"{tool}: {len(results) - failures} of {len(results)} compiled files pass")
sys.exit(failures != 0)
