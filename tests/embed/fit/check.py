"""Fits whose answers are known: the decay of a wave of shear, and free fall."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import rivulet.fit

import shear_wave

WAVE = dict(series=shear_wave.amplitude, start=shear_wave.start, frame=1 / 60, evaluations=13)


def wave(folder, low=2e-3, high=5e-2, nu=0.008, **more):
    return rivulet.fit.fit(shear_wave.SCENE, {"fluid.viscosity": (low, high, "log")}, shear_wave.decay(nu, 0.2), folder=folder, **{**WAVE, **more})


def refused(work, *words):
    try:
        work()
    except rivulet.BadInput as error:
        assert all(word in str(error) for word in words), error
    else:
        raise AssertionError(f"not refused: {words}")


def main():
    # The front of a block, whose face is at 0.5 m, with a drop that runs ahead on the floor.
    block = np.stack(np.meshgrid(*(np.arange(0.05, side, 0.1) for side in (0.5, 0.3, 1)), indexing="ij"), axis=-1).reshape(-1, 3)
    for low in (0, -2, 7):
        assert abs(rivulet.fit.front(np.vstack([block, [[3, 0.05, 0.45]]]) + [0, low, 0], 0.1) - 0.5) < 1e-6
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
                              folder="density", **{**WAVE, "evaluations": 8})
    assert any("does not matter" in note for note in density.notes) and density.error["fluid.restDensity"] is None, density.notes

    # Free fall from the command: gravity, and with it a clock that is late.
    drop = {"name": "drop", "fluid": {"spacing": 0.05, "gravity": [0, -9.81, 0], "box": {"max": [1, 1.5, 1]}, "blocks": [{"min": [0.3, 1, 0.3], "max": [0.7, 1.4, 0.7]}]}}
    pathlib.Path("drop.json").write_text(json.dumps(drop))
    t = np.linspace(0.02, 0.3, 15)
    rows = "".join(f"{1000 * a:.6f},{100 * b:.6f}\n" for a, b in zip(t, 1.2 - 0.5 * 8 * (t + 0.03)**2))
    pathlib.Path("fall.csv").write_text("# ms, cm\nt,y\n" + rows)
    asked = {"scene": "drop.json", "parameters": {"fluid.gravity.1": {"from": -12, "to": -5}}, "series": "centre_of_mass_y", "shift": [-0.02, 0.05],
             "measured": {"file": "fall.csv", "time": 1e-3, "value": 1e-2}, "evaluations": 12, "folder": "fall"}
    pathlib.Path("fall.json").write_text(json.dumps(asked))
    command = [sys.executable, "-m", "rivulet.fit"]
    said = subprocess.run([*command, "fall.json"], capture_output=True, text=True)
    assert said.returncode == 0 and "fluid.gravity.1 = -" in said.stdout and "s later than the measurement" in said.stdout, said
    result = json.loads(pathlib.Path("fall/result.json").read_text())
    assert abs(result["best"]["fluid.gravity.1"] + 8) < 0.25 and abs(result["shift"] - 0.03) < 0.004, result
    assert pathlib.Path("fall/fit.png").stat().st_size > 5000 and len(pathlib.Path("fall/points.csv").read_text().splitlines()) > 8

    # Two parameters at once: both velocities of a drop in free flight.
    t = np.linspace(0.01, 0.2, 12)
    curve = np.column_stack([t, 0.5 * 3.0 * t**2 + 0.5 * 0.4 * t])
    two = rivulet.fit.fit({**drop, "fluid": {**drop["fluid"], "gravity": [3, 0, 0], "blocks": [{**drop["fluid"]["blocks"][0], "velocity": [0.2, 0, 0]}]}},
                          {"fluid.gravity.0": (1, 5), "fluid.blocks.0.velocity.0": (0, 0.5)}, curve + [0, 0.5], "centre_of_mass_x", folder="two",
                          evaluations=45, frame=1 / 120)
    assert abs(two.best["fluid.gravity.0"] / 3 - 1) < 0.1 and abs(two.best["fluid.blocks.0.velocity.0"] / 0.2 - 1) < 0.1, str(two)

    refused(lambda: wave("wave", low=1, high=1), "fluid.viscosity", "smaller to a larger")
    refused(lambda: wave("wave", method="newton"), "newton", "nelder-mead")
    refused(lambda: wave("wave", seconds=0.01), "raise seconds")
    refused(lambda: rivulet.fit.fit({"colliders": [{}]}, {"fluid.viscosity": (0, 1)}, curve, "front"), "colliders", "start")
    refused(lambda: rivulet.fit.fit({}, {"fluid.viscosity": (0, 1)}, curve, "fronts"), "fronts", "maximum_speed")
    refused(lambda: rivulet.fit.fit({}, {"fluid.viscosity": (0, 1)}, curve, "fall.csv:front"), "fall.csv is no Python file")
    # On OpenCL a fit of the kinetic energy compared frames with the numbers of earlier ones.
    refused(lambda: rivulet.fit.fit(drop, {"fluid.viscosity": (0, 1)}, curve, "kinetic", backend="cl"), "kinetic", "set backend to cpu")
    pathlib.Path("bad.json").write_text(json.dumps({**asked, "scnee": 1}))
    said = subprocess.run([*command, "bad.json"], capture_output=True, text=True)
    assert said.returncode == 2 and said.stderr.count("\n") == 1 and "scnee" in said.stderr, said


if __name__ == "__main__":
    main()
