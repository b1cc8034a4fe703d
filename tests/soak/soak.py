"""soak.py ROOT [--hours H] [--window MINUTES] [SCENE...]: see tests/soak.sh.

A run is watched from outside, by /proc. The largest resident size in the last fifth of its samples may exceed that in the first fifth, in which
caches and pools of the allocator fill, by 2 MB and 1 %. Open files may not grow."""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# The scenes whose water or solids never come to rest, each with a spacing that leaves some thousand particles; None: only films on skins.
SCENES = {
    "fountain": 0.03, "paddle_wheel": 0.04, "wave_tank": 0.06, "koi": 0.035, "waving_sheet": 0.04, "rubber_ducks": 0.05,
    "shower": 0.012, "rain_on_spot": None, "window_rain": None, "cold_bottle": None, "crying": None,
}
ALLOWED = 2e6, 0.01  # bytes, share
LEDGER = 1e-4        # imbalance of volumes over what was emitted


def resident(pid):
    with open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


class Watch:
    """Samples a process; compares memory and files in the last fifth of the samples with those in the first."""

    def __init__(self, pid):
        self.pid, self.samples = pid, []

    def look(self):
        try:
            self.samples.append((resident(self.pid), descriptors(self.pid)))
        except (FileNotFoundError, ProcessLookupError, IndexError):
            pass  # it has just ended

    def grown(self):
        """Faults as text, and the two figures of memory."""
        if len(self.samples) < 20:
            return ["the run was too short to see growth"], 0, 0
        early = self.samples[: len(self.samples) // 5]
        late = self.samples[-len(self.samples) // 5 : -1]  # the last may be of a process that ends
        before, after = max(m for m, _ in early), max(m for m, _ in late)
        faults = []
        if after > before * (1 + ALLOWED[1]) + ALLOWED[0]:
            faults.append(f"memory grew from {before / 1e6:.1f} to {after / 1e6:.1f} MB")
        if max(d for _, d in late) > max(d for _, d in early):
            faults.append(f"open files grew from {max(d for _, d in early)} to {max(d for _, d in late)}")
        return faults, before, after


def report(name, what, before, after, faults):
    print(f"{name:<16} {what:<34} {before / 1e6:8.1f} {after / 1e6:8.1f}  {'; '.join(faults) if faults else 'passed'}", flush=True)
    return not faults


def scene(root, program, name, hours, work):
    stats = os.path.join(work, f"{name}.json")
    words = [program, "run", os.path.join(root, "assets/scenes", name + ".json"), "--no-render", "--backend", "cpu",
             "--seconds", str(hours * 3600), "--stats", stats]
    if SCENES[name] is not None:
        words += ["--set", f"fluid.spacing={SCENES[name]}"]
    with open(os.path.join(work, name + ".log"), "w") as log:
        running = subprocess.Popen(words, stdout=log, stderr=log, cwd=work)
        watch = Watch(running.pid)
        pause = 0.2
        while running.poll() is None:
            watch.look()
            time.sleep(pause)
            if len(watch.samples) % 500 == 0:
                pause = min(pause * 2, 10)
    faults, before, after = watch.grown()
    if running.returncode != 0:
        with open(os.path.join(work, name + ".log")) as log:
            faults.append(f"exit status {running.returncode}: {log.read().strip()[-300:]}")
        return report(name, "", before, after, faults)
    with open(stats) as file:
        figures = json.load(file)
    if figures["lost"] or figures["nan"]:
        faults.append(f"{figures['lost']} particles lost, {figures['nan']} not finite")
    error = figures.get("ledger", {}).get("error", 0)
    if not abs(error) <= LEDGER:
        faults.append(f"the ledger is off by {error:.2g}")
    if abs(figures["seconds"] + figures.get("dropped", 0) - hours * 3600) > 1:
        faults.append(f"only {figures['seconds']:.0f} s were simulated")
    return report(name, f"{figures['seconds'] / 3600:.2f} h, {figures['particles']} particles", before, after, faults)


KEYS = ["space", "r", "h", "Tab", "F1", "F12", "ctrl+f", "ctrl+z", "ctrl+y", "Escape", "Left", "Right", "Up", "Down", "Return", "n", "p", "l"]


def window(root, program, minutes, work):
    """The window of one scene under random keys, clicks, drags and wheels, on a display of its own."""
    for tool in ("Xvfb", "xdotool"):
        if shutil.which(tool) is None:
            print(f"window           skipped: {tool} is not installed")
            return True
    shown, told = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(told), "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset"],
                              pass_fds=[told], stderr=subprocess.DEVNULL)
    os.close(told)
    with os.fdopen(shown) as number:
        display = ":" + number.readline().strip()
    environment = dict(os.environ, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1", XDG_CONFIG_HOME=os.path.join(work, "config"))
    environment.pop("WAYLAND_DISPLAY", None)
    chance = random.Random(29)
    with open(os.path.join(work, "window.log"), "w") as log:
        running = subprocess.Popen([program, "run", os.path.join(root, "assets/scenes/dam_break.json"), "--set", "fluid.spacing=0.05", "--size", "900x600"],
                                   env=environment, stdout=log, stderr=log, cwd=work)
        watch = Watch(running.pid)
        actions, end = 0, time.time() + 60 * minutes
        while time.time() < end and running.poll() is None:
            x, y = chance.randrange(900), chance.randrange(600)
            act = chance.choice([["key", chance.choice(KEYS)], ["mousemove", str(x), str(y), "click", chance.choice("1345")],
                                 ["mousemove", str(x), str(y), "mousedown", "1", "mousemove_relative", "--", str(chance.randrange(-99, 99)),
                                  str(chance.randrange(-99, 99)), "mouseup", "1"],
                                 ["mousemove", str(x), str(y), "mousedown", "3", "mousemove_relative", "--", "40", "20", "mouseup", "3"]])
            subprocess.run(["xdotool"] + act, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            actions += 1
            if actions % 5 == 0:
                watch.look()
            time.sleep(0.05)
    faults, before, after = watch.grown()
    if running.poll() is None:
        running.send_signal(signal.SIGINT)
        try:
            running.wait(60)
        except subprocess.TimeoutExpired:
            running.kill()
            faults.append("it does not end after SIGINT")
    if running.returncode not in (0, 130):
        with open(os.path.join(work, "window.log")) as log:
            faults.append(f"exit status {running.returncode}: {log.read().strip()[-300:]}")
    server.terminate()
    server.wait()
    return report("window", f"{minutes:g} min, {actions} inputs", before, after, faults)


def main():
    parser = argparse.ArgumentParser(prog="tests/soak.sh", description=__doc__.split("\n\n")[1])
    parser.add_argument("root", help=argparse.SUPPRESS)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="of: " + ", ".join(SCENES))
    parser.add_argument("--hours", type=float, default=24, help="simulated hours of each scene (24)")
    parser.add_argument("--window", type=float, help="minutes of the window (180; with scenes: none)")
    given = parser.parse_args()
    for name in given.scenes:
        if name not in SCENES:
            parser.error(f"there is no scene '{name}' here; choose of: {', '.join(SCENES)}")
    minutes = given.window if given.window is not None else 0 if given.scenes else 180
    names = given.scenes or ([] if given.window is not None else list(SCENES))
    program = os.path.join(given.root, "build/release/bin/rivulet")
    os.environ["XDG_CACHE_HOME"] = os.path.join(given.root, "build/release/test_cache")
    os.environ["RIVULET_ASSETS"] = os.path.join(given.root, "assets")
    print(f"{'run':<16} {'of':<34} {'MB early':>8} {'MB late':>8}")
    with tempfile.TemporaryDirectory() as work:
        results = [scene(given.root, program, name, given.hours, work) for name in names]
        if minutes > 0:
            results.append(window(given.root, program, minutes, work))
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
