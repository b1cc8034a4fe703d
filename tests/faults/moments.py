"""Rows in which something happens to a run from outside: signals, full disks, ffmpeg stopped or killed, bad caches."""
import os
import random
import resource
import shutil
import signal
import subprocess
import time

import cases
import runs
import watch

RECORD = "run plain.json --no-render --backend cpu --frames 1000000 --record n.rrec --stats n.json"
SHOW = "run plain.json --headless --size 64x48 --still 0 --out shown --replay n.rrec"


def works_again(faults, room, words, limits=()):
    """None, or why not."""
    after = watch.run([faults.program, *words], room.root, room.environment, faults.core(), limits=limits)
    return None if after.status == 0 else f"the next run fails: {after.status} {after.err[-300:]}"


def at(moment, number):
    """Sends a signal once, that many seconds after the start."""
    start, sent = time.monotonic(), []

    def during(process):
        if not sent and time.monotonic() - start >= moment:
            sent.append(1)
            os.kill(process.pid, number)
    return during


def judge(faults, row, room, words, outcome, lost, again):
    if outcome.hung or outcome.crashed:
        row.count("hung" if outcome.hung else "crashed", again, f"{outcome.status} {outcome.err[-300:]}")
    else:
        row.count("lost" if lost else "", again, f"{lost} [{outcome.status}: {outcome.err[-300:]}]")


def killed(faults):
    row = faults.row("kill -9", "at a random moment of a recording, and of each verb")
    chosen = random.Random(faults.options.seed)

    def recording(moment, older):
        case = cases.Case(f"kill {older}", RECORD, ("n.rrec", "n.json") if older else ())
        room = faults.room(case)
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core(), during=at(moment, signal.SIGKILL))
        now, lost = cases.files_in(room.root), None
        if older and (now.get("n.rrec") != cases.OLD or now.get("n.json") != cases.OLD):
            lost = "an older file has changed"
        found = [name for name in now if name.endswith(".rrec") and (name != "n.rrec" or not older)]
        for name in found:
            if lost or len(now[name]) < 20000:
                continue  # killed before its first frame was written
            shown = watch.run([faults.program, *SHOW.replace("n.rrec", name).split()], room.root, room.environment, faults.core())
            if shown.status != 0 or "has no end" not in shown.err:
                lost = f"{name} cannot be shown: {shown.status} {shown.err[-300:]}"
        again = runs.repeat(room, case.words, "") + f" & sleep {moment:.3f}; kill -9 $!"
        if outcome.status not in (-signal.SIGKILL, 1):
            lost = lost or f"exit status {outcome.status}"
        elif outcome.status == -signal.SIGKILL:
            outcome.status = 1
        lost = lost or works_again(faults, room, case.words[:6] + ["2"] + case.words[7:])
        judge(faults, row, room, case.words, outcome, lost, again)

    def verb(case, moment):
        room = faults.room(case)
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core(), during=at(moment, signal.SIGKILL))
        now, lost = cases.files_in(room.root), None
        for name in case.outputs:
            if now.get(name) != cases.OLD and not cases.complete(name, now.get(name, b"")):
                lost = f"{name} is incomplete"
        if outcome.status == -signal.SIGKILL:
            outcome.status = 1
        lost = lost or works_again(faults, room, case.words)
        judge(faults, row, room, case.words, outcome, lost, runs.repeat(room, case.words) + f" & sleep {moment:.3f}; kill -9 $!")

    count = 4 if faults.quick else 100
    tasks = [lambda m=chosen.uniform(0.05, 1.5), o=k % 2 == 0: recording(m, o) for k in range(count)]
    for case in [case for case in runs.able(faults, cases.CASES) if not case.long]:
        for _ in range(max(1, int(count * 0.3 * min(case.share, 1)))):
            tasks.append(lambda c=case, m=chosen.uniform(0.02, 0.6): verb(c, m))
    faults.all(tasks)


def signals(faults):
    row = faults.row("SIGHUP, SIGINT, SIGTERM", "at a random moment of each verb")
    chosen = random.Random(faults.options.seed + 1)

    def verb(case, moment, number):
        room = faults.room(case)
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core(), during=at(moment, number))
        lost = None
        if outcome.status == -number:  # before the program had its handlers
            outcome.status = 128 + number
        if outcome.status not in (0, 128 + number):
            lost = f"exit status {outcome.status}"
        if not outcome.crashed and not outcome.hung:
            status, outcome.status = outcome.status, outcome.status or 1
            case_new, case.new = case.new, {}  # fewer frames than without the signal
            lost = lost or room.verdict(outcome, check_new=False)
            case.new = case_new
            outcome.status = status
        lost = lost or works_again(faults, room, case.words)
        judge(faults, row, room, case.words, outcome, lost, runs.repeat(room, case.words) + f" & sleep {moment:.3f}; kill -{number} $!")

    tasks = []
    for case in [case for case in runs.able(faults, cases.CASES) if not case.long]:
        for number in (signal.SIGHUP, signal.SIGINT, signal.SIGTERM):
            for _ in range(1 if faults.quick else max(1, int(20 * min(case.share, 1)))):
                tasks.append(lambda c=cases.copy(case), m=chosen.uniform(0.02, 0.6), n=number: verb(c, m, n))
    faults.all(tasks)


def disks(faults):
    row = faults.row("a full disk", "a limit of the size of files (ulimit -f); a small file system")
    sizes = [1000, 3000, 20000] if faults.quick else [1000, 1500, 2000, 3000, 4000, 6000, 10000, 15000, 20000, 30000, 50000, 100000, 300000]

    def limited(case, size):
        room = faults.room(case)
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core(), limits=[(resource.RLIMIT_FSIZE, size)])
        lost = cases.bad_message(outcome, case.err) if outcome.status != 0 else None
        lost = lost or room.verdict(outcome) or works_again(faults, room, case.words)
        judge(faults, row, room, case.words, outcome, lost, f"ulimit -f {size} bytes: {runs.repeat(room, case.words)}")

    def small(case, size):
        room = faults.room(case)
        disk = os.path.join(faults.work, f"disk-{faults.core()}")
        os.makedirs(disk, exist_ok=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", disk], capture_output=True).returncode != 0:
            return
        try:
            room.root = disk
            room.environment = dict(room.environment, XDG_CACHE_HOME=os.path.join(disk, "cache"), TMPDIR=disk, HOME=disk)
            try:
                for name, data in {**room.inputs, **{name: cases.OLD for name in case.outputs}}.items():
                    room.write(name, data)
            except OSError:
                return  # its inputs do not fit
            outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core())
            lost = cases.bad_message(outcome, case.err) if outcome.status != 0 else None
            lost = lost or room.verdict(outcome)
            subprocess.run(["mount", "-o", "remount,size=100M", disk], check=True)
            lost = lost or works_again(faults, room, case.words)
            judge(faults, row, room, case.words, outcome, lost, f"in a tmpfs of {size}: {runs.repeat(room, case.words)}")
        finally:
            subprocess.run(["umount", "-l", disk], check=False)

    able = [case for case in runs.able(faults, cases.CASES) if not case.long]
    tasks = [lambda c=case, s=size: limited(c, s) for case in able for size in sizes if case.share >= 0.2]
    tasks += [lambda c=case, s=size: small(c, s) for case in able for size in ("56k", "64k", "72k", "80k", "96k", "128k", "256k")
              if case.share >= 0.2 and case.outputs and not (faults.quick and size not in ("64k", "96k"))]
    faults.all(tasks)


def child_of(process, name):
    try:
        with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="utf-8") as file:
            for pid in map(int, file.read().split()):
                with open(f"/proc/{pid}/comm", encoding="utf-8") as comm:
                    if comm.read().strip() == name:
                        return pid
    except OSError:
        pass
    return None


def ffmpeg(faults):
    row = faults.row("ffmpeg", "stopped or killed while it writes; not installed")
    chosen = random.Random(faults.options.seed + 2)
    case = cases.Case("ffmpeg", "run plain.json --headless --backend cpu --size 320x240 --frames 100000 --video v.mp4 --out out",
                      ("v.mp4", "out/stats.json"), needs=("gl",))
    if shutil.which("ffmpeg") is None or not runs.able(faults, [c for c in cases.CASES if "gl" in c.needs]):
        return

    def one(number, moment):
        room = faults.room(case)
        seen = []

        def during(process):
            pid = child_of(process, "ffmpeg")
            if pid and not seen:
                seen.append(time.monotonic())
            if pid and len(seen) == 1 and time.monotonic() - seen[0] > moment:
                seen.append(1)
                os.kill(pid, number)
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core(), during=during, idle=60)
        lost = None
        if not outcome.hung and not outcome.crashed:
            lost = cases.bad_message(outcome, set()) or room.verdict(outcome)
            if not lost and cases.files_in(room.root)["v.mp4"] != cases.OLD:
                lost = "the older video has changed"
        judge(faults, row, room, case.words, outcome, lost, f"{runs.repeat(room, case.words)} & kill -{number} of ffmpeg after {moment:.2f} s")

    def absent():
        room = faults.room(case)
        room.environment["PATH"] = "/nonexistent"
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core())
        judge(faults, row, room, case.words, outcome, cases.bad_message(outcome, set()) or room.verdict(outcome), "no ffmpeg")

    few = 1 if faults.quick else 6
    faults.all([absent] + [lambda n=number, m=chosen.uniform(0, 1): one(n, m) for number in (signal.SIGSTOP, signal.SIGKILL, signal.SIGTERM)
                           for _ in range(few)])


def caches(faults):
    row = faults.row("bad caches", "entries that are cut, flipped, swapped, empty, links, folders, or open to others")
    chosen = random.Random(faults.options.seed + 3)
    case = cases.copy(next(c for c in cases.CASES if c.name == "run"))
    if not runs.able(faults, [case]):
        return
    wanted = {name: data for name, data in case.new.items()}

    def spoil(folder, how):
        entries = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names]
        for path in entries:
            with open(path, "rb") as file:
                data = bytearray(file.read())
            if how == "cut":
                data = data[:chosen.randrange(len(data) + 1)]
            elif how == "flip":
                for _ in range(chosen.randrange(1, 4)):
                    data[chosen.randrange(len(data))] ^= 1 << chosen.randrange(8)
            elif how == "swap":
                with open(chosen.choice(entries), "rb") as file:
                    data = bytearray(file.read())
            elif how == "long":
                data += bytes(chosen.randrange(1, 5000))
            os.remove(path)
            if how == "folder":
                os.makedirs(path)
                continue
            if how == "link":
                os.symlink("/etc/passwd", path)
                continue
            with open(path, "wb") as file:
                file.write(data)
            if how == "open":
                os.chmod(path, 0o666)
                os.chmod(os.path.dirname(path), 0o777)

    def one(how):
        room = faults.room(case)
        first = watch.run([faults.program, *case.words], room.root, room.environment, faults.core())
        spoil(os.path.join(room.root, "cache"), how)
        for name in case.outputs:
            room.write(name, cases.OLD)
        outcome = watch.run([faults.program, *case.words], room.root, room.environment, faults.core())
        lost = f"exit status {outcome.status}" if first.status == 0 and outcome.status != 0 else room.verdict(outcome)
        now = cases.files_in(room.root)
        for name, data in wanted.items():
            if not lost and now.get(name) != data:
                lost = f"{name} is not what a run without a cache writes"
        judge(faults, row, room, case.words, outcome, lost, f"cache: {how}; {runs.repeat(room, case.words)}")

    kinds = ["cut", "flip", "swap", "long", "link", "folder", "open"]
    faults.all([lambda h=how: one(h) for how in kinds for _ in range(1 if faults.quick else 20)])


ROWS = {"kills": killed, "signals": signals, "disks": disks, "ffmpeg": ffmpeg, "caches": caches}
