"""Rows in which a verb of the program runs, and a call of it fails."""
import os
import re
import shutil

import cases
import watch


def fixture(faults):
    """The inputs of the cases, made by the program."""
    folder = os.path.join(faults.work, "fixture")
    os.makedirs(folder)
    for name, text in (("s.json", cases.SCENE), ("plain.json", cases.PLAIN)):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
    shutil.copy(os.path.join(faults.environment["RIVULET_ASSETS"], "meshes", "paddle.obj"), folder)
    words = "run s.json --no-render --backend cpu --frames 2 --record r.rrec --save s.rstate --stats n.json"
    made = watch.run([faults.program, *words.split()], folder, dict(faults.environment, XDG_CACHE_HOME=os.path.join(folder, "cache")),
                     min(os.sched_getaffinity(0)))  # on one core, as the cases: a recording names how many there were
    if made.status != 0:
        raise SystemExit(f"faults: the inputs cannot be made: {made.err}")
    return {name: data for name, data in cases.files_in(folder).items() if name in cases.INPUTS}


def repeat(room, words, fault=""):
    return f"(cd {room.root}; {f'RIVULET_FAULT={fault} ' if fault else ''}rivulet {' '.join(words)})"


def measure_case(faults, case, module="rivulet"):
    """Runs it twice without failures: its outputs, and how many calls of each kind it makes. False: it cannot run on this machine."""
    if case.long:
        case.counts = dict.fromkeys(faults.kinds, 0) | {"memory": 400, "open": 1, "open_read": 3, "read": 3}
        return True
    room = faults.room(case)
    counts = os.path.join(faults.work, f"counts-{faults.core()}")
    news = []
    for preload in (False, True):
        room.fill()
        environment = dict(room.environment)
        if preload:
            if os.path.exists(counts):
                os.remove(counts)
            environment.update(LD_PRELOAD=faults.interposer, RIVULET_FAULT_MODULE=module, RIVULET_FAULT_COUNTS=counts)
        outcome = watch.run([faults.program, *case.words], room.root, environment, faults.core(), cpu=10 * case.cpu)
        if outcome.status != 0:
            if case.needs:
                return False
            raise SystemExit(f"faults: {case.name} does not work without faults: {outcome.status} {outcome.err}")
        news.append(cases.files_in(room.root))
    case.new = {name: news[0][name] for name in case.outputs if news[0].get(name) == news[1].get(name)}
    lost = room.verdict(outcome)
    if lost:
        raise SystemExit(f"faults: {case.name}, without faults: {lost}")
    case.err = set(outcome.err.splitlines())
    case.counts = faults.counts(counts)
    return True


def numbers(count, first, more):
    """The first numbers, and some of the rest, closer together at the beginning."""
    if count <= first + more:
        return list(range(1, count + 1))
    picked = set(range(1, first + 1))
    for k in range(more):
        share = (k + 0.5) / more
        picked.add(int(first + 1 + (count - first - 1) * (0.3 * share ** 3 + 0.7 * share)))
    return sorted(picked)


def inject(faults, row, case, kind, number, onwards, module="rivulet"):
    room = faults.room(case)
    counts = os.path.join(faults.work, f"counts-{faults.core()}")
    if os.path.exists(counts):
        os.remove(counts)
    start = cases.files_in(room.root)
    fault = f"{kind}:{number}{'+' if onwards else ''}"
    environment = dict(room.environment, LD_PRELOAD=faults.interposer, RIVULET_FAULT_MODULE=module, RIVULET_FAULT_COUNTS=counts,
                       RIVULET_FAULT=fault)
    outcome = watch.run([faults.program, *case.words], room.root, environment, faults.core(), cpu=10 if case.long else 10 * case.cpu)
    if faults.counts(counts)["failed"] == 0 or (case.long and outcome.hung):
        return
    again = repeat(room, case.words, fault)
    if outcome.hung or outcome.crashed:
        row.count("hung" if outcome.hung else "crashed", again, f"{outcome.status} {outcome.err[-300:]}")
        return
    lost = cases.bad_message(outcome, case.err) if outcome.status != 0 else None
    lost = lost or room.verdict(outcome, check_new=kind not in ("read", "open_read"))
    if not lost and outcome.status != 0 and not case.long and (number % 10 == 0 or cases.files_in(room.root) != start):
        after = watch.run([faults.program, *case.words], room.root, room.environment, faults.core(), cpu=10 * case.cpu)
        lost = room.verdict(after) if after.status == 0 else f"the next run fails: {after.err[-300:]}"
    row.count("lost" if lost else "", again, f"{lost} [{outcome.status}: {outcome.err[-300:]}]")


measured = {}


def able(faults, which):
    """Those of the cases that are asked for and can run here, measured."""
    which = [case for case in which if re.search(faults.options.cases, case.name)]
    faults.all([lambda case=case: measured.__setitem__(case.name, measure_case(faults, case)) for case in which if case.name not in measured])
    return [case for case in which if measured[case.name]]


def sweep(faults, fault, how, kinds, which, first, more):
    """One row: the kinds of calls that fail, in turn, in all the cases."""
    row = faults.row(fault, how)
    tasks = []
    for case in able(faults, which):
        for kind in kinds:
            for onwards in (True,) if case.long else (False, True):
                part = case.share * (0.3 if onwards else 1)
                for number in numbers(case.counts[kind], max(1, int(first * part)), max(1, int(more * part))):
                    tasks.append(lambda a=(case, kind, number, onwards): inject(faults, row, *a))
    faults.all(tasks)



def memory(faults):
    sweep(faults, "host memory", "the N-th allocation fails, or all from it on", ["memory"], cases.CASES, *((6, 4) if faults.quick else (300, 200)))


def files(faults):
    few = (3, 2) if faults.quick else (100, 30)
    sweep(faults, "files that are opened", "the N-th open, pipe or mkdir fails", ["open", "open_read", "folder"], cases.CASES, *few)
    sweep(faults, "files that are read", "the N-th read fails (EIO)", ["read"], cases.CASES, *few)
    sweep(faults, "files that are written", "the N-th write, fsync, rename, link or close fails (ENOSPC, EIO)",
          ["write", "sync", "rename", "link", "close"], cases.CASES, *few)


def processes(faults):
    few = (2, 2) if faults.quick else (40, 10)
    sweep(faults, "processes and threads", "the N-th start fails (EAGAIN); the pipe to ffmpeg breaks", ["process", "thread", "send", "map"], cases.CASES, *few)


def gl(faults):
    few = (2, 2) if faults.quick else (80, 40)
    sweep(faults, "OpenGL", "the N-th buffer, texture, mapping, program, fence or framebuffer fails", cases.GL_KINDS, cases.GL_CASES, *few)


def cl(faults):
    few = (2, 2) if faults.quick else (80, 40)
    sweep(faults, "OpenCL", "the N-th buffer, command, program, context or queue fails", cases.CL_KINDS, cases.CL_CASES, *few)


def lost(faults):
    sweep(faults, "a lost device", "OpenGL's context is lost at the N-th dispatch or draw", ["gl_lost"], cases.GL_CASES,
          *((2, 2) if faults.quick else (40, 40)))


ROWS = {"lost": lost, "memory": memory, "files": files, "processes": processes, "gl": gl, "cl": cl}
