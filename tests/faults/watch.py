"""Runs a program and says how it ended: by itself, by a signal, or not at all."""
import os
import resource
import signal
import subprocess
import tempfile
import time

CPU_SECONDS = 120  # of one run that is not expected to take long
IDLE_SECONDS = 20  # without a runnable thread: a program that waits for ever. On a loaded machine a slow one is runnable, and not hung.


class Outcome:
    def __init__(self, status, out, err, hung):
        self.status, self.out, self.err, self.hung = status, out, err, hung

    @property
    def crashed(self):
        """Ended by a signal, or by a handler of the C++ runtime."""
        return not self.hung and (self.status < 0 or self.status >= 128 and "terminate called" in self.err)


def threads_of(pid):
    """(states, seconds of processor time) of a process, its threads and its children."""
    states, ticks, todo = "", 0, [pid]
    while todo:
        process = todo.pop()
        try:
            for task in os.listdir(f"/proc/{process}/task"):
                with open(f"/proc/{process}/task/{task}/stat", encoding="utf-8", errors="replace") as file:
                    words = file.read().rsplit(")", 1)[1].split()
                states += words[0]
                ticks += int(words[11]) + int(words[12])
                with open(f"/proc/{process}/task/{task}/children", encoding="utf-8") as file:
                    todo += [int(word) for word in file.read().split()]
        except (OSError, IndexError):
            pass
    return states, ticks / os.sysconf("SC_CLK_TCK")


def kill_all(process):
    for end in (signal.SIGCONT, signal.SIGKILL):
        try:
            os.killpg(process.pid, end)
        except OSError:
            pass


def niceness():
    """Of this process's scheduling group (/proc/PID/autogroup): a new session gets one of its own, at 0."""
    try:
        with open("/proc/self/autogroup", encoding="utf-8") as file:
            return file.read().split()[-1]
    except (OSError, IndexError):
        return None


NICENESS = niceness()


def run(words, folder, environment, core=None, limits=(), closed=(), during=None, idle=IDLE_SECONDS, cpu=CPU_SECONDS):
    """`limits`: (resource, value); `closed`: descriptors that the program does not have; `during(process)` is called every 10 ms."""
    def before():
        if NICENESS not in (None, "0"):
            with open("/proc/self/autogroup", "w", encoding="utf-8") as file:
                file.write(NICENESS)
        if core is not None:
            os.sched_setaffinity(0, {core})
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for which, value in limits:
            resource.setrlimit(which, (value, value))
        for stream in closed:
            os.close(stream)

    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = subprocess.Popen(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                   preexec_fn=before, start_new_session=True)
        hung, waited, last, used = False, 0.0, time.monotonic(), -1.0
        while True:
            try:
                process.wait(timeout=0.01 if during else 0.5)
                break
            except subprocess.TimeoutExpired:
                pass
            if during:
                during(process)
            now = time.monotonic()
            if now - last < 0.4:
                continue
            states, seconds = threads_of(process.pid)
            waited = 0.0 if seconds != used or "R" in states or "D" in states else waited + now - last
            last, used = now, seconds
            if waited > idle or seconds > cpu:
                hung = True
                break
        kill_all(process)  # what it has left behind, too
        process.wait()
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read(1 << 20).decode("utf-8", "replace"))
        return Outcome(process.returncode, texts[0], texts[1], hung)
