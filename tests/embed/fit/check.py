"""Fits whose answers are known: the decay of a wave of shear, and free fall."""
import contextlib
import io
import json
import math
import os
import pathlib
import resource
import signal
import subprocess
import sys
import time

import matplotlib
import matplotlib.pyplot as pyplot
import numpy as np
import rivulet.fit

import shear_wave
from refusals import refused

WAVE = dict(series=shear_wave.amplitude, start=shear_wave.start, frame=1 / 60, evaluations=17)


def wave(folder, low=2e-3, high=5e-2, nu=0.008, **more):
    return rivulet.fit.fit(shear_wave.SCENE, {"fluid.viscosity": (low, high, "log")}, shear_wave.decay(nu, 0.2), folder=folder, **{**WAVE, **more})


# Changes of a FIT.json that is right, and words of the sentence with which each is refused.
WRONG = [
    ({"scene": [1]}, "scene is [1]"), ({"scene": "no.json"}, "no.json", "cannot be read"), ({"scene": "list.json"}, "list.json", "an object"),
    ({"parameters": {"fluid.gravity.1": {"from": "a", "to": 1}}}, "fluid.gravity.1", '"a"', "number"),
    ({"parameters": {"fluid.gravity.1": {"from": -12, "to": -5, "scal": "log"}}}, "scal ", "scale"),
    ({"parameters": {"fluid.gravity.1": {"from": -12}}}, "fluid.gravity.1", "lacks to"), ({"parameters": {"fluid.gravity.1": 3}}, "fluid.gravity.1 is 3"),
    ({"parameters": 3}, "parameters is 3"), ({"parameters": {"fluid.gravity.1": {"from": 1, "to": 2, "scale": 3}}}, "scale is 3", "log"),
    ({"parameters": {"budget.frameMs": {"from": 1, "to": 2}}}, "budget.frameMs", "speed of the machine", "fluid.spacing"),
    ({"parameters": {"look.size": {"from": 1, "to": 2}}}, "look.size", "begins with fluid"),
    ({"settings": [1]}, "settings is [1]"), ({"settings": {"gravity": 1}}, "settings: gravity"),
    ({"series": 3}, "series is 3"), ({"series": "a.py:f"}, "a.py:f", "file that exists"), ({"series": "wrong.py:f"}, "wrong.py", "SyntaxError"),
    ({"start": "a.py:f"}, "start", "a.py:f", "not FILE.py:FUNCTION"), ({"start": 1}, "start is 1"),
    ({"seconds": "a"}, 'seconds is "a"'), ({"frame": 0}, "frame is 0", "above 0"),
    ({"shift": 0.1}, "shift is 0.1", "[-0.02, 0.02]"), ({"shift": [0.02, 0.01]}, "from 0.02 to 0.01"), ({"shift": [0, "b"]}, 'shift is "b"'),
    ({"measured": "c.csv"}, 'measured is "c.csv"', "file"), ({"measured": {"file": "fall.csv", "colums": [1, 0]}}, "colums", "columns"),
    ({"measured": {"file": "fall.csv", "columns": [0, 7]}}, "fall.csv:3", "columns 0 and 7"), ({"measured": {"file": 3}}, "measured.file is 3"),
    ({"measured": {"file": "fall.csv", "columns": 1}}, "measured.columns is 1"), ({"measured": {"file": "fall.csv", "time": "ms"}}, 'measured.time is "ms"'),
    ({"measured": {"file": "none.csv"}}, "none.csv", "cannot be read"), ({"measured": [[0, 1], [1]]}, "measured", "rows of two"),
    ({"evaluations": "5"}, 'evaluations is "5"', "at least 13"), ({"evaluations": 12}, "evaluations is 12", "at least 13", "brent"),
    ({"evaluations": 0, "method": "nelder-mead"}, "at least 11"), ({"evaluations": 9, "method": "differential evolution"}, "at least 10"),
    ({"evaluations": True}, "evaluations is true"), ({"tolerance": -1}, "tolerance is -1"), ({"jobs": -1}, "jobs is -1"), ({"seed": 0.5}, "seed is 0.5"),
    ({"method": []}, "method is []", "brent"), ({"backend": "abacus"}, "abacus", "cpu"), ({"label": 1}, "label is 1"),
    ({"folder": "/proc/x"}, "/proc/x", "another folder"), ({"folder": 1}, "folder is 1"), ({"scnee": 1}, "scnee", "scene")]


def check_files(right):
    """Each wrong file is refused by one line that names it, and exit status 2."""
    pathlib.Path("list.json").write_text("[1]")
    pathlib.Path("wrong.py").write_text("def f(:")
    texts = [(json.dumps({**right, **change}), words) for change, *words in WRONG]
    texts += [("3", ("the file is 3", "an object")), ("{", ("cannot be read",)), ("{}", ("lacks scene",))]
    for text, words in texts:
        pathlib.Path("bad.json").write_text(text)
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            status = rivulet.fit.main(["bad.json"])
        assert status == 2 and said.getvalue().count("\n") == 1, (text, said.getvalue())
        assert all(word in said.getvalue() for word in ("bad.json", *words)), (words, said.getvalue())


def main():
    # The front of a block, whose face is at 0.5 m, with a drop that runs ahead on the floor.
    block = np.stack(np.meshgrid(*(np.arange(0.05, side, 0.1) for side in (0.5, 0.3, 1)), indexing="ij"), axis=-1).reshape(-1, 3)
    for low in (0, -2, 7):
        assert abs(rivulet.fit.front(np.vstack([block, [[3, 0.05, 0.45]]]) + [0, low, 0], 0.1) - 0.5) < 1e-6
    rows = np.array([[1, 0, -0.9], [2, 0, -0.1], [4, 0, 0.1], [8, 0, 0.9]])  # one strip on each side of z = 0
    assert rivulet.fit.front(rows, 1.0) == 0.5 * (2 + 8) + 0.5
    refused(lambda: rivulet.fit.front(np.zeros((0, 3)), 0.1), "0 particles", "at least one")

    # The theory's viscosity, within 3 %; the interval is about the value, and the runs that ended are kept.
    found = wave("wave")
    nu, low_high = found.best["fluid.viscosity"], found.interval["fluid.viscosity"]
    assert abs(nu / 0.008 - 1) < 0.03 and low_high[0] < nu < low_high[1] and found.error["fluid.viscosity"] < 0.05 * nu and not found.notes, str(found)
    kept = {path: path.stat().st_mtime_ns for path in pathlib.Path("wave/runs").iterdir()}
    assert len(kept) == len(found.points) and not any(point.cached for point in found.points)
    # Another curve with the same runs: no run is made twice.
    wave("wave", nu=0.02)
    assert all(path.stat().st_mtime_ns == when for path, when in kept.items())
    # A shorter curve, too; a longer one needs longer runs.
    scan = rivulet.fit.SCAN
    shorter = rivulet.fit.fit(shear_wave.SCENE, {"fluid.viscosity": (2e-3, 5e-2, "log")}, shear_wave.decay(0.008, 0.1), folder="wave", **WAVE)
    assert all(point.cached for point in shorter.points[:scan]) and all(path.stat().st_mtime_ns == when for path, when in kept.items())
    longer = rivulet.fit.fit(shear_wave.SCENE, {"fluid.viscosity": (2e-3, 5e-2, "log")}, shear_wave.decay(0.008, 0.22), folder="wave", **WAVE)
    assert not any(point.cached for point in longer.points[:scan]) and longer.times[-1] >= 0.22
    kept = {path: path.stat().st_mtime_ns for path in kept}
    # The curve of one of the runs is met exactly; the backend and the figures of whoever plots stay.
    own = np.column_stack([found.times, found.values])
    exact = rivulet.fit.fit(shear_wave.SCENE, {"fluid.viscosity": (0.5 * nu, 1.5 * nu)}, own, folder="wave", **WAVE)  # the middle of the scan
    assert exact.residual == 0 and exact.best == found.best and exact.error["fluid.viscosity"] < 1e-3 * nu and not exact.notes, str(exact)
    matplotlib.use("svg")
    figure = pyplot.figure()
    exact.plot("exact.png")
    assert matplotlib.get_backend().lower() == "svg" and pyplot.fignum_exists(figure.number) and os.path.getsize("exact.png") > 10000

    # A run whose file is damaged is made again. On a logarithmic scale the interval is printed: it is not symmetric.
    for path in list(kept)[:2]:
        path.write_text("")
    assert wave("wave").best == found.best and all(path.stat().st_size > 10 for path in kept)
    line = next(line for line in str(found).splitlines() if line.startswith("fluid.viscosity = "))
    assert "+-" not in line and f"from {low_high[0]:.3g} to {low_high[1]:.3g}" in line, line

    # Killed in the middle, and taken up again: the same result, and no run is lost or made again.
    child = [sys.executable, "-c", "import check; check.wave('killed', jobs=1)"]
    environment = {**os.environ, "PYTHONPATH": os.environ["PYTHONPATH"] + ":" + str(pathlib.Path(__file__).parent)}
    process = subprocess.Popen(child, env=environment, start_new_session=True)
    runs = lambda: list(pathlib.Path("killed/runs").glob("*.json"))
    while len(runs()) < 3:
        assert process.poll() is None, "the fit ended before it could be killed"
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = {path: path.stat().st_mtime_ns for path in runs()}
    again = wave("killed")
    assert len(before) < len(runs()) and all(path.stat().st_mtime_ns == when for path, when in before.items())
    assert again.best == found.best and again.residual == found.residual and sum(p.cached for p in again.points) == len(before)

    # What cannot be told is said.
    border = wave("border", low=2e-2, high=8e-2)
    assert any("border of its range" in note for note in border.notes) and abs(border.best["fluid.viscosity"] / 2e-2 - 1) < 0.05, border.notes
    density = rivulet.fit.fit(shear_wave.SCENE, {"fluid.restDensity": (500, 2000)}, shear_wave.decay(1e-2, 0.1), settings={"fluid.viscosity": 1e-2},
                              folder="density", **{**WAVE, "evaluations": 13})
    assert any("does not matter" in note for note in density.notes) and density.error["fluid.restDensity"] is None, density.notes

    # A series that is constant, as the curve is: nothing can be told, and nothing fails.
    flat = rivulet.fit.fit(shear_wave.SCENE, {"fluid.viscosity": (1e-3, 1e-2)}, [[0.02, 1], [0.04, 1], [0.06, 1]], "height", folder="flat",
                           start=shear_wave.start, frame=1 / 60, evaluations=13)
    assert math.isnan(flat.relative) and "curve's range" not in str(flat), str(flat)

    # Free fall from the command: gravity, and with it a clock that is late.
    drop = {"name": "drop", "fluid": {"spacing": 0.05, "gravity": [0, -9.81, 0], "box": {"max": [1, 1.5, 1]}, "blocks": [{"min": [0.3, 1, 0.3], "max": [0.7, 1.4, 0.7]}]}}
    pathlib.Path("drop.json").write_text(json.dumps(drop))
    t = np.linspace(0.02, 0.3, 15)
    rows = "".join(f"{1000 * a:.6f},{100 * b:.6f}\n" for a, b in zip(t, 1.2 - 0.5 * 8 * (t + 0.03)**2))
    pathlib.Path("fall.csv").write_text("# ms, cm\nt,y\n" + rows)
    asked = {"scene": "drop.json", "parameters": {"fluid.gravity.1": {"from": -12, "to": -5}}, "series": "centre_of_mass_y", "shift": [-0.02, 0.05],
             "measured": {"file": "fall.csv", "time": 1e-3, "value": 1e-2}, "evaluations": 16, "folder": "fall"}
    pathlib.Path("fall.json").write_text(json.dumps(asked))
    command = [sys.executable, "-m", "rivulet.fit"]
    said = subprocess.run([*command, "fall.json"], capture_output=True, text=True)
    assert said.returncode == 0 and "fluid.gravity.1 = -" in said.stdout and "s later than the measurement" in said.stdout, said
    result = json.loads(pathlib.Path("fall/result.json").read_text())
    # A mark of Unicode in front of the first row is none of a number; a first row that was mistyped is no row of names.
    pathlib.Path("mark.csv").write_text(rows.split("\n", 1)[1], encoding="utf-8-sig")
    pathlib.Path("typo.csv").write_text("2O.000000,119.5\n" + rows)
    assert len(rivulet.fit.given._rows(pathlib.Path("mark.csv"), [0, 1], (1, 1))) == 14
    refused(lambda: rivulet.fit.given._rows(pathlib.Path("typo.csv"), [0, 1], (1, 1)), "typo.csv:1", "correct the line")
    # No method makes more runs than it is allowed to.
    for method, most in (("brent", 13), ("nelder-mead", 11), ("differential evolution", 14)):
        pathlib.Path("few.json").write_text(json.dumps({**asked, "evaluations": most, "method": method, "tolerance": 1e-6}))
        few = rivulet.fit.fit_file("few.json")
        assert 7 < len(few.points) <= most, (method, len(few.points))
    assert abs(result["best"]["fluid.gravity.1"] + 8) < 0.25 and abs(result["shift"] - 0.03) < 0.004, result
    assert pathlib.Path("fall/fit.png").stat().st_size > 5000 and len(pathlib.Path("fall/points.csv").read_text().splitlines()) > 8

    # Two parameters at once: both velocities of a drop in free flight.
    t = np.linspace(0.01, 0.2, 12)
    curve = np.column_stack([t, 0.5 * 3.0 * t**2 + 0.5 * 0.4 * t])
    two = rivulet.fit.fit({**drop, "fluid": {**drop["fluid"], "gravity": [3, 0, 0], "blocks": [{**drop["fluid"]["blocks"][0], "velocity": [0.2, 0, 0]}]}},
                          {"fluid.gravity.0": (1, 5), "fluid.blocks.0.velocity.0": (0, 0.5)}, curve + [0, 0.5], "centre_of_mass_x", folder="two",
                          evaluations=45, frame=1 / 120)
    assert len(two.points) <= 45 and abs(two.best["fluid.gravity.0"] / 3 - 1) < 0.1 and abs(two.best["fluid.blocks.0.velocity.0"] / 0.2 - 1) < 0.1, str(two)

    refused(lambda: wave("wave", low=1, high=1), "fluid.viscosity", "smaller to a larger")
    refused(lambda: wave("wave", method="newton"), "newton", "nelder-mead")
    refused(lambda: wave("wave", seconds=0.01), "raise seconds")
    refused(lambda: rivulet.fit.fit({"colliders": [{}]}, {"fluid.viscosity": (0, 1)}, curve, "front"), "colliders", "start")
    refused(lambda: rivulet.fit.fit({}, {"fluid.viscosity": (0, 1)}, curve, "fronts"), "fronts", "maximum_speed")
    refused(lambda: rivulet.fit.fit({}, {"fluid.viscosity": (0, 1)}, curve, "fall.csv:front"), "fall.csv is no Python file")
    # On OpenCL a fit of the kinetic energy compared frames with the numbers of earlier ones.
    refused(lambda: rivulet.fit.fit(drop, {"fluid.viscosity": (0, 1)}, curve, "kinetic", backend="cl"), "kinetic", "set backend to cpu")
    check_files(asked)
    # A run that cannot be kept, as on a full disk, ends the fit with a sentence, and nothing is left of it.
    pathlib.Path("full.json").write_text(json.dumps({**asked, "folder": "full"}))
    limits = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))
    said = subprocess.run([*command, "full.json"], capture_output=True, text=True, preexec_fn=limits)
    assert said.returncode == 1 and said.stderr.count("\n") == 1 and "cannot be written" in said.stderr, said
    assert not list(pathlib.Path("full/runs").iterdir())
    # Runs at a time: as many as this process has cores.
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    assert rivulet.fit._cores() == 1
    os.sched_setaffinity(0, cores)


if __name__ == "__main__":
    main()
