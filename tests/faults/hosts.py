"""Rows in which a C host calls each function of rivulet.h, and a call behind it fails."""
import os
import re
import subprocess

import watch

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
SYSTEM = ("memory", "map", "open", "open_read", "folder", "read", "write", "sync", "rename", "link", "close", "thread")
GL = ("gl_memory", "gl_map", "gl_program", "gl_fence", "gl_target", "gl_lost")
CL = ("cl_memory", "cl_command", "cl_build", "cl_open")


def host(faults):
    """The path of the C program, compiled once."""
    path = os.path.join(faults.work, "host")
    if not os.path.exists(path):
        subprocess.run(["cc", "-std=gnu11", "-O1", "-I", os.path.join(os.path.dirname(faults.library), "include"), "-I", os.path.join(ROOT, "tests", "embed", "c"),
                        os.path.join(HERE, "host.c"), faults.library, "-Wl,-rpath," + os.path.dirname(faults.library), "-lEGL", "-lGL", "-ldl",
                        "-o", path], check=True)
    return path


def call(faults, row, backend, function, kind, onwards):
    folder = os.path.join(faults.work, f"host-{backend}-{function}-{kind}-{onwards}")
    os.makedirs(folder, exist_ok=True)
    first, second = (30, 1) if faults.quick and backend != "cpu" else (1000, 10)
    words = [host(faults), backend, function, kind, str(first), str(second), str(int(onwards)), folder]
    environment = dict(faults.environment, LD_PRELOAD=faults.interposer, RIVULET_FAULT_MODULE="librivulet.so",
                       XDG_CACHE_HOME=os.path.join(folder, "cache"))
    outcome = watch.run(words, folder, environment, faults.core(), cpu=1200)
    again = f"LD_PRELOAD=librivulet_faults.so RIVULET_FAULT_MODULE=librivulet.so host {' '.join(words[1:-1])} ."
    if outcome.hung:
        row.count("hung", again, outcome.out[-300:])
        return
    last = re.search(r"(\d+) (\d+) (\d+) (\d+)\n$", outcome.out)
    if outcome.status == 77:
        return
    if outcome.status != 0 or not last:
        row.count("crashed", again, f"{outcome.status} {outcome.out[-300:]} {outcome.err[-300:]}")
        return
    inputs, crashed, hung, lost = map(int, last.groups())
    with row.lock:
        row.inputs += inputs
        row.crashed += crashed
        row.hung += hung
        row.lost += lost
    left = [name for _, _, names in os.walk(folder) for name in names if ".rivulet-" in name or name.endswith(".tmp")]
    if left:
        row.count("lost", again, f"{left} is left behind")
    if crashed + hung + lost:
        faults.say(f"{row.fault}: {again}\n    " + "\n    ".join(outcome.out.splitlines()[-6:]))


def functions(faults, fault, how, backend, kinds, wanted=""):
    row = faults.row(fault, how)
    names = subprocess.run([host(faults)], capture_output=True, text=True, check=True, env=faults.environment).stdout.split()
    faults.all([lambda a=(name, kind, onwards): call(faults, row, backend, *a) for name in names for kind in kinds for onwards in (False, True)
                if re.search(wanted, name) and re.search(faults.options.cases, name)])


def memory(faults):
    functions(faults, "C functions, host memory", "the N-th allocation fails, or all from it on", "cpu", ["memory"])


def system(faults):
    functions(faults, "C functions, files and threads", "the N-th mmap, open, read, write, fsync, rename, close or thread fails", "cpu",
              [k for k in SYSTEM if k != "memory"], "create|save|restore|export")


def gl(faults):
    functions(faults, "C functions, OpenGL", "the N-th buffer, texture, mapping, program, fence or framebuffer fails; the context is lost", "gl",
              GL, "step|draw|buffers" if faults.quick else "")


def cl(faults):
    functions(faults, "C functions, OpenCL", "the N-th buffer, command, program, context or queue fails", "cl", CL, "step|sample" if faults.quick else "")


ROWS = {"c memory": memory, "c system": system, "c gl": gl, "c cl": cl}
