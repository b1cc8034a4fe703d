"""Finds the parameters of a scene whose run reproduces a measured curve.

    python3 -m rivulet.fit FIT.json            # prints the result; writes result.json, points.csv and fit.png into FIT's folder

    from rivulet.fit import fit
    found = fit("dam.json", {"fluid.viscosity": (1e-6, 1e-1, "log")}, measured, "front")     # measured: n x 2, seconds and SI units
    print(found)

Every run is kept in the folder of the fit by its values: a fit that was killed goes on where it was, and a fit with another curve or another
method of search reuses the runs. Needs NumPy and SciPy; Matplotlib for the plot. docs/fitting.md explains the results. A wrong argument
raises BadInput, a run that cannot be compared raises Error.
"""
from __future__ import annotations

import concurrent.futures
import contextlib
import copy
import csv
import hashlib
import importlib.util
import inspect
import io
import json
import math
import multiprocessing
import os
import pathlib
import sys
from typing import Any, Callable, Mapping, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _fit_input as given
from ._fit_input import OF_A_WORLD
from ._library import BadInput, Error, array_of, text_of, version
from .context import Context
from .world import World

__all__ = ["Fit", "Point", "fit", "fit_file", "front"]

Array = NDArray[Any]
Path = Union[str, "os.PathLike[str]"]
Series = Callable[[World, float], float]  # of a world and the particle spacing (m), in SI units
Start = Callable[[Context, "dict[str, Any]"], World]  # of a context and the scene with the values that are tried
Curve = Sequence[Sequence[float]]  # a run's times (s) and its values
NOT_OF_A_WORLD = ("colliders", "bodies", "flow")
METHODS = ("brent", "nelder-mead", "differential evolution")
SCAN = 7  # values over the range of a single parameter, before Brent's method searches between the best of them
BESIDE = (-0.08, -0.04, 0.04, 0.08)  # places beside the best, as shares of the range, at which the curvature is measured after Brent's method


class Point(NamedTuple):
    """Values that were tried."""

    values: dict[str, float]  #: by the parameter's path
    residual: float  #: rms difference from the measured curve, in its unit, at the best shift
    shift: float  #: s: time of the run = time of the measurement + shift
    cached: bool  #: the run was there before this fit


# --- series: a number of a world, at the current time ------------------------------------------------------------------------------------------

def front(positions: ArrayLike, spacing: float) -> float:
    """Position (m) of the water's front along +x, of particles at positions (n, 3), m, that are about `spacing` (m) apart: of those within two
    spacings above the lowest, the median over the tank's width, which ignores single drops that run ahead. BadInput: no particles."""
    at = array_of(positions, (-1, 3), "positions")
    if not len(at) or not spacing > 0:
        raise BadInput(f"{len(at)} particles {spacing:g} m apart have no front: give at least one, and a spacing above 0")
    near = at[at[:, 1] < at[:, 1].min() + 2 * spacing]
    strip = np.floor(near[:, 2] / spacing)
    return float(np.median([near[strip == k, 0].max() for k in np.unique(strip)]) + 0.5 * spacing)


def _centre_of_mass(axis: int) -> Series:
    return lambda world, _: float(world.stats().centre_of_mass[axis])


SERIES: dict[str, Series] = {
    "front": lambda world, spacing: front(world.particles().positions, spacing),
    "height": lambda world, spacing: float(world.particles().positions[:, 1].max() + 0.5 * spacing),  # the highest particle's top
    **{f"centre_of_mass_{name}": _centre_of_mass(axis) for axis, name in enumerate("xyz")},
    "kinetic": lambda world, _: float(world.stats().kinetic),
    "potential": lambda world, _: float(world.stats().potential),
    "maximum_speed": lambda world, _: float(world.stats().maximum_speed),
}
LATE = SERIES.keys() - {"front", "height"}  # from World.stats(), which is some frames old on a GPU


def _function(name: str, what: str) -> Callable[..., Any]:
    """A function by `FILE.py:NAME`."""
    file, _, function = name.rpartition(":")
    if not file or not pathlib.Path(file).is_file():
        named = f"neither {', '.join(SERIES)} nor" if what == "series" else "not"
        raise BadInput(f"{what} {name!r} is {named} FILE.py:FUNCTION of a file that exists")
    spec = importlib.util.spec_from_file_location("rivulet_fit_" + pathlib.Path(file).stem, file)
    if spec is None or spec.loader is None:
        raise BadInput(f"{what} {name!r}: {file} is no Python file; name it with .py")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise BadInput(f"{what} {name!r}: {file} cannot be imported: {type(error).__name__}: {error}") from error
    found: Callable[..., Any] | None = getattr(module, function, None)
    if not callable(found):
        raise BadInput(f"{file} has no function {function}")
    return found


def _named(function: Callable[..., Any]) -> str:
    """FILE.py:NAME, by which another process finds a function."""
    file = inspect.getsourcefile(function)
    if file is None or "<" in function.__qualname__ or "." in function.__qualname__:
        raise BadInput(f"{function} cannot be called by another process: define it with def at the top of a file")
    return f"{os.path.abspath(file)}:{function.__name__}"


# --- one run -----------------------------------------------------------------------------------------------------------------------------------

def _set(scene: dict[str, Any], path: str, value: Any) -> None:
    """Sets "fluid.blocks.0.max" in a scene's dict."""
    at: Any = scene
    names = path.split(".")
    for name, following in zip(names[:-1], names[1:]):
        if isinstance(at, list):
            if not name.isdigit() or int(name) >= len(at):
                raise BadInput(f"{path}: the scene has {len(at)} items there")
            at = at[int(name)]
        else:
            at = at.setdefault(name, [] if following.isdigit() else {})
    if isinstance(at, list):
        if not names[-1].isdigit() or int(names[-1]) >= len(at):
            raise BadInput(f"{path}: the scene has {len(at)} items there; write the list into the scene")
        at[int(names[-1])] = value
    else:
        at[names[-1]] = value


def _run(job: dict[str, Any]) -> Curve:
    """The curve of one run; called in a process of its own. `job`: as fit makes it."""
    scene = copy.deepcopy(job["scene"])
    for path, value in job["settings"].items():
        _set(scene, path, value)
    series = SERIES.get(job["series"]) or _function(job["series"], "series")
    spacing = scene.get("fluid", {}).get("spacing", 0.02)
    with Context(backend=job["backend"], threads=job["threads"]) as context:
        world = _function(job["start"], "start")(context, scene) if job["start"] else context.world(scene)
        with world:
            times, values = [world.stats().time], [series(world, spacing)]
            while times[-1] < job["seconds"]:
                world.step(job["frame"])
                if world.stats().time <= times[-1]:
                    raise Error(f"the run stopped at {times[-1]:.3g} s with {job['settings']}: its time no longer advances")
                times.append(world.stats().time)
                values.append(series(world, spacing))
    if not np.isfinite(values).all():
        raise Error(f"series {job['series']} is not finite with {job['settings']}")
    return [times, values]


def _write(path: Path, text: str) -> None:
    part = f"{path}.part{os.getpid()}"
    try:
        with open(part, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        os.replace(part, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.remove(part)
        raise Error(f"{path} cannot be written: {error.strerror}") from error


# --- the search --------------------------------------------------------------------------------------------------------------------------------

class _Range:
    """The range of a parameter, as 0 to 1."""

    def __init__(self, name: str, low: float, high: float, scale: str = "linear") -> None:
        self.name, self.log = name, given.one_of(scale, ("linear", "log"), f"{name}: scale") == "log"
        self.low, self.high = (given.number(value, f"{name}: the range's {end}") for value, end in ((low, "lower end"), (high, "upper end")))
        if not self.low < self.high or not math.isfinite(self.high - self.low):
            raise BadInput(f"{name}: a range goes from a smaller to a larger number, not from {low} to {high}")
        if self.log and self.low <= 0:
            raise BadInput(f"{name}: a range with scale log begins above 0, not at {low}")

    def value(self, u: float) -> float:
        u = min(max(float(u), 0.0), 1.0)
        value = self.low * (self.high / self.low) ** u if self.log else self.low + u * (self.high - self.low)
        return float(f"{value:.9g}")  # the key of the kept run

    def place(self, value: float) -> float:
        return math.log(value / self.low) / math.log(self.high / self.low) if self.log else (value - self.low) / (self.high - self.low)


class _Enough(Exception):
    """A method has used the runs that it may make."""


def _kept(path: pathlib.Path, seconds: float) -> Curve | None:
    """A run that was kept. None: there is none, it is shorter than that, or its file is damaged."""
    try:
        curve: Curve = json.loads(path.read_text(encoding="utf-8"))
        times, values = np.array(curve, dtype=float)
    except (OSError, ValueError, TypeError):
        return None
    return curve if len(times) == len(values) > 0 and times[-1] >= seconds else None


def _cores() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0))


class _Search:
    """Runs at places (one number from 0 to 1 for each parameter), kept in files, and their differences from the measured curve."""

    def __init__(self, job: dict[str, Any], ranges: list[_Range], measured: Array, shift: tuple[float, float], folder: Path, jobs: int,
                 most: int) -> None:
        self.job, self.ranges, self.measured, self.shift, self.folder, self.jobs = job, ranges, measured, shift, pathlib.Path(folder), jobs
        self.most = most  # of different points
        self.points: list[Point] = []
        self.curves: dict[tuple[float, ...], Curve] = {}
        self.pool: concurrent.futures.ProcessPoolExecutor | None = None
        try:
            (self.folder / "runs").mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadInput(f"folder: {self.folder / 'runs'} cannot be made: {error.strerror}; name another folder") from error

    def path(self, values: Mapping[str, float]) -> pathlib.Path:
        """Of the kept run with these values."""
        what: dict[str, Any] = {**self.job, "settings": {**self.job["settings"], **values}, "version": version()}
        del what["threads"], what["seconds"]  # values do not depend on them
        for name in ("series", "start"):  # a function that was changed is another one
            if what[name] and what[name] not in SERIES:
                what[name] += hashlib.sha256(pathlib.Path(what[name].rpartition(":")[0]).read_bytes()).hexdigest()
        return self.folder / "runs" / (hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:24] + ".json")

    def residual(self, curve: Curve) -> tuple[float, float]:
        """Least rms difference over the shifts, and the shift: time of the run = time of the measurement + shift."""
        times, values = (np.array(part) for part in curve)
        t, y = self.measured.T

        def rms(shift: float) -> float:
            return math.sqrt(np.mean((np.interp(t + shift, times, values) - y) ** 2))

        low, high = self.shift
        if low == high:
            return rms(low), low
        tried = np.linspace(low, high, 201)
        best = tried[np.argmin([rms(s) for s in tried])]
        step = tried[1] - tried[0]
        fine = np.clip(np.linspace(best - step, best + step, 101), low, high)
        costs = [rms(s) for s in fine]
        return min(costs), float(fine[np.argmin(costs)])

    def many(self, places: Sequence[ArrayLike] | Array) -> list[float]:
        """Residuals at several places, each run in a process of its own. _Enough: there would be more points than `most`."""
        wanted = [{r.name: r.value(u) for r, u in zip(self.ranges, np.atleast_1d(place))} for place in places]
        known = {tuple(p.values.values()) for p in self.points}
        if len(known | {tuple(values.values()) for values in wanted}) > self.most:
            raise _Enough
        paths = [self.path(values) for values in wanted]
        kept = [_kept(path, self.job["seconds"]) is not None for path in paths]
        missing = {path: values for path, values, there in zip(paths, wanted, kept) if not there}
        threads = max(1, _cores() // max(1, min(self.jobs, len(missing))))
        work = {path: {**self.job, "threads": threads, "settings": {**self.job["settings"], **values}} for path, values in missing.items()}
        if len(work) > 1 and self.jobs > 1:
            if self.pool is None:
                self.pool = concurrent.futures.ProcessPoolExecutor(self.jobs, multiprocessing.get_context("spawn"))
            running = {self.pool.submit(_run, one): path for path, one in work.items()}
            for done in concurrent.futures.as_completed(running):
                _write(running[done], json.dumps(done.result()))
        else:
            for path, one in work.items():
                _write(path, json.dumps(_run(one)))
        results = []
        for values, path, cached in zip(wanted, paths, kept):
            curve = _kept(path, self.job["seconds"])
            if curve is None:
                raise Error(f"{path} cannot be read, though it has just been written: is the disk full?")
            residual, shift = self.residual(curve)
            if not any(p.values == values for p in self.points):
                self.points.append(Point(values, residual, shift, cached))
                self.curves[tuple(values.values())] = curve
            results.append(residual)
        return results

    def one(self, place: ArrayLike) -> float:
        return self.many([place])[0]

    def close(self) -> None:
        if self.pool is not None:
            self.pool.shutdown(cancel_futures=True)


def _least(method: str, count: int) -> int:
    """Runs without which a method cannot begin and end, for that number of parameters."""
    if method == "brent":
        return SCAN + 2 + len(BESIDE)
    return _starts(count) + count + 2 if method == "nelder-mead" else 2 * _generation(count)


def _starts(count: int) -> int:
    return max(4 * count, 8)


def _generation(count: int) -> int:
    return 5 * count


def _search(search: _Search, method: str, tolerance: float, seed: int) -> None:
    """At most search.most runs."""
    from scipy import optimize
    from scipy.stats import qmc
    count, evaluations = len(search.ranges), search.most
    if method == "brent":
        scan = np.linspace(0, 1, SCAN)
        costs = search.many([[u] for u in scan])
        k = int(np.argmin(costs))
        between = (scan[max(k - 1, 0)], scan[min(k + 1, SCAN - 1)])
        search.most -= len(BESIDE)
        with contextlib.suppress(_Enough):
            optimize.minimize_scalar(lambda u: search.one([u]), bounds=between, method="bounded",
                                     options={"xatol": tolerance, "maxiter": evaluations})
        search.most = evaluations
        best = search.ranges[0].place(min(search.points, key=lambda p: p.residual).values[search.ranges[0].name])
        # Points beside the best: the curvature is measured, not found by chance.
        search.many([[min(max(best + d, 0), 1)] for d in BESIDE])
    elif method == "nelder-mead":
        starts = qmc.LatinHypercube(count, seed=seed).random(_starts(count))
        costs = search.many(starts)
        start: Array = starts[np.argmin(costs)]
        sides = np.diag(np.where(start < 0.5, 0.15, -0.15))
        simplex = np.vstack([start, np.clip(start + sides, 0, 1)])
        with contextlib.suppress(_Enough):
            optimize.minimize(search.one, start, method="Nelder-Mead", bounds=[(0, 1)] * count,
                              options={"initial_simplex": simplex, "xatol": tolerance, "fatol": 0, "maxfev": 10 * evaluations})
    else:
        optimize.differential_evolution(search.one, [(0, 1)] * count, popsize=5, maxiter=evaluations // _generation(count) - 1, tol=tolerance,
                                        seed=seed, polish=False, updating="deferred", workers=lambda work, places: search.many(list(places)))


# --- the result --------------------------------------------------------------------------------------------------------------------------------

class Fit:
    """What `fit` found. str() is a report: the points, the values with their errors, the notes."""

    best: dict[str, float]  #: values by the parameter's path, of the point with the least residual
    residual: float  #: its rms difference from the measured curve, in the curve's unit
    relative: float  #: the same, divided by the range of the curve; NaN: the curve is constant
    shift: float  #: s: time of the run = time of the measurement + shift
    error: dict[str, float | None]  #: standard error by the parameter's path, in its unit; None: it cannot be determined
    interval: dict[str, tuple[float, float]]  #: lowest and highest value that fit as well as the best, within one standard error
    notes: list[str]  #: sentences on what the curve does not determine
    points: list[Point]  #: all that were tried, in order
    measured: Array  #: (n, 2): s and the curve's unit
    times: Array  #: (m,) s, of the best run
    values: Array  #: (m,) the best run's curve, in the curve's unit

    def __init__(self, search: _Search) -> None:
        self.points = search.points
        best = min(search.points, key=lambda p: p.residual)
        self.best, self.residual, self.shift = best.values, best.residual, best.shift
        self._ranges, self.measured = search.ranges, search.measured
        height = float(np.ptp(search.measured[:, 1]))
        self.relative = best.residual / height if height > 0 else math.nan
        self.times, self.values = (np.array(part) for part in search.curves[tuple(best.values.values())])
        self.error, self.interval, self.notes = {}, {}, []
        self._uncertainty()

    def _uncertainty(self) -> None:
        n, count = len(self.measured), len(self._ranges)
        free = count + (1 if any(p.shift != self.shift for p in self.points) else 0)
        places = np.array([[r.place(p.values[r.name]) for r in self._ranges] for p in self.points])
        squares = n * np.array([p.residual for p in self.points]) ** 2
        best = int(np.argmin(squares))
        exact = n * (1e-9 * float(np.abs(self.measured[:, 1]).max())) ** 2  # as of numbers that were rounded
        rise = max(squares[best], exact, 1e-300) / max(n - free, 1)  # of the sum of squares, at one standard error
        curvature, noise = self._curvature(places, squares, best, rise)
        level = rise + 2 * noise  # runs differ among themselves, as particles do
        for k, r in enumerate(self._ranges):
            value, u = self.best[r.name], places[best, k]
            deviation = None if curvature is None else math.sqrt(2 * level * np.linalg.inv(curvature)[k, k])
            if count == 1:
                low, high = self._crossings(places[:, 0], squares, squares[best] + level)
            else:
                low, high = (0.0, 1.0) if deviation is None else (max(u - deviation, 0.0), min(u + deviation, 1.0))
            self.interval[r.name] = (r.value(low), r.value(high))
            bounded = deviation is not None and low > 0 and high < 1
            self.error[r.name] = 0.5 * (r.value(u + deviation) - r.value(u - deviation)) if bounded else None
            text = f"from {r.value(low):.3g} to {r.value(high):.3g}"
            if low <= 0 and high >= 1:
                self.notes.append(f"{r.name} does not matter for this curve: values {text}, the whole range, fit as well as the best.")
            elif min(u, 1 - u) < 0.02:
                self.notes.append(f"{r.name} = {value:.3g} lies on the border of its range, {r.low:g} to {r.high:g}: widen the range.")
            elif low <= 0 or high >= 1:
                side, border = ("lower", r.low) if low <= 0 else ("upper", r.high)
                self.notes.append(f"{r.name} has no {side} bound: values {text} fit as well as {value:.3g}, and {border:g} is the border of the range.")

    @staticmethod
    def _crossings(places: Array, squares: Array, level: float) -> tuple[float, float]:
        """The interval outside which the sum of squares is above `level`, from straight lines between the tried places."""
        order = np.argsort(places)
        u, s = places[order], squares[order]
        below = np.flatnonzero(s <= level)
        first, last = below[0], below[-1]
        low = 0.0 if first == 0 else u[first] - (u[first] - u[first - 1]) * (level - s[first]) / (s[first - 1] - s[first])
        high = 1.0 if last == len(u) - 1 else u[last] + (u[last + 1] - u[last]) * (level - s[last]) / (s[last + 1] - s[last])
        return low, high

    @staticmethod
    def _curvature(places: Array, squares: Array, best: int, rise: float) -> tuple[Array | None, float]:
        """Second derivatives of the sum of squares, from a quadratic through the points about the best, and the rms of what it leaves.
        None: there are too few points, or it has no minimum."""
        count = places.shape[1]
        terms = [(i, j) for i in range(count) for j in range(i, count)]
        need = 1 + count + len(terms)
        d = places - places[best]
        near = np.argsort(np.abs(d).max(axis=1))
        near = near[:max(2 * need + 1, np.count_nonzero(squares <= squares[best] + 9 * rise))]  # those within three standard errors, too
        if len(near) < need + 1:
            return None, 0.0
        size = max(np.abs(d[near]).max(), 1e-12)
        x = d[near] / size
        columns = np.column_stack([np.ones(len(x))] + [x[:, i] for i in range(count)] + [x[:, i] * x[:, j] for i, j in terms])
        weights = 1 / (1 + (squares[near] - squares[best]) / rise)
        c, _, rank, _ = np.linalg.lstsq(columns * weights[:, None], squares[near] * weights, rcond=None)
        noise = math.sqrt(np.sum((weights * (columns @ c - squares[near])) ** 2) / (np.sum(weights**2) * (1 - need / len(near))))
        if rank < need:
            return None, noise
        curvature = np.zeros((count, count))
        for (i, j), value in zip(terms, c[1 + count:]):
            curvature[i, j] += value / size**2
            curvature[j, i] += value / size**2
        return (curvature if np.linalg.eigvalsh(curvature).min() > 0 else None), noise

    def __str__(self) -> str:
        lines = [f"{'run':>4}  " + "  ".join(f"{r.name:>18}" for r in self._ranges) + "      residual   shift, s"]
        for k, p in enumerate(self.points):
            lines.append(f"{k + 1:>4}  " + "  ".join(f"{v:>18.6g}" for v in p.values.values()) + f"  {p.residual:>12.4g}  {p.shift:>9.4g}")
        for name, value in self.best.items():
            error, (low, high) = self.error[name], self.interval[name]
            log = any(r.name == name and r.log for r in self._ranges)  # whose errors are not alike on both sides
            about = "" if error is None else f", from {low:.3g} to {high:.3g}" if log else f" +- {error:.2g}"
            lines.append(f"{name} = {value:.4g}{about}")
        late = "later" if self.shift > 0 else "earlier"
        shift = f"; the run is {abs(self.shift):.3g} s {late} than the measurement" if self.shift else ""
        share = "" if math.isnan(self.relative) else f", {100 * self.relative:.2g} % of the curve's range"
        lines.append(f"rms difference {self.residual:.3g}{share}{shift}")
        return "\n".join(lines + self.notes)

    def save(self, folder: Path) -> None:
        """Writes result.json (best, error, interval, residual, relative, shift, notes) and points.csv (one row for each point) into a folder
        that exists. Error: they cannot be written."""
        folder = pathlib.Path(folder)
        _write(folder / "result.json", json.dumps({"best": self.best, "error": self.error, "interval": self.interval, "residual": self.residual,
                                                   "relative": None if math.isnan(self.relative) else self.relative, "shift": self.shift, "notes": self.notes}, indent=2) + "\n")
        text = io.StringIO()
        rows = csv.writer(text)
        rows.writerow([*self.best, "residual", "shift"])
        rows.writerows([*p.values.values(), p.residual, p.shift] for p in self.points)
        _write(folder / "points.csv", text.getvalue())

    def plot(self, path: Path, label: str = "", unit: str = "") -> None:
        """Writes a picture (PNG, or what the ending of `path` says): the measured curve with the best run, and the residual over each parameter,
        with the interval shaded. label, unit: of the curve's axis. Needs Matplotlib."""
        from matplotlib.figure import Figure  # not pyplot: its open figures and its backend belong to the user
        figure = Figure(figsize=(5.2 + 3.8 * len(self._ranges), 4.2), dpi=110, layout="constrained")
        axes = figure.subplots(1, 1 + len(self._ranges))
        axes[0].plot(self.times, self.values, color="#1769aa", linewidth=2, label=", ".join(f"{n} = {v:.3g}" for n, v in self.best.items()))
        axes[0].plot(self.measured[:, 0] + self.shift, self.measured[:, 1], "o", color="#c0392b", markersize=5, label="measured")
        axes[0].set(xlabel="time (s)", ylabel=f"{label} ({unit})" if unit else label)
        axes[0].locator_params(axis="x", nbins=6)
        axes[0].legend(frameon=False)
        for axis, r in zip(axes[1:], self._ranges):
            axis.plot([p.values[r.name] for p in self.points], [p.residual for p in self.points], "o", color="0.45", markersize=4)
            axis.plot(self.best[r.name], self.residual, "o", color="#1769aa", markersize=8)
            axis.axvspan(*self.interval[r.name], color="#1769aa", alpha=0.12, linewidth=0)
            axis.set(xlabel=r.name, ylabel="rms difference" + (f" ({unit})" if unit else ""), xscale="log" if r.log else "linear", ylim=(0, None))
        for axis in axes:
            axis.grid(color="0.92")
        figure.savefig(path)


def fit(scene: Mapping[str, Any] | Path, parameters: Mapping[str, Sequence[Any]], measured: ArrayLike, series: Series | str, *,
        start: Start | str | None = None, settings: Mapping[str, Any] | None = None, seconds: float | None = None,
        shift: Sequence[float] = (0, 0), method: str | None = None, evaluations: int = 40, tolerance: float = 5e-3, folder: Path = "fit",
        jobs: int | None = None, backend: str = "cpu", frame: float = 1 / 240, seed: int = 1) -> Fit:
    """A Fit: the values of `parameters` with which a run of `scene` reproduces `measured` best.

    scene       a dict, or a path of a scene file; with colliders, bodies or surface flow it needs `start`
    parameters  {path: (low, high)} or {path: (low, high, "log")}, paths and units as in docs/parameters.md
    measured    (n, 2): time (s) and value (SI units), in the order of time
    series      front, height, centre_of_mass_x, _y, _z (m), kinetic, potential (J), maximum_speed (m/s); or a function f(world, spacing) -> float
                at the top of a file, spacing in m; or "FILE.py:FUNCTION"
    start       f(context, scene) -> World, for particles or walls that a scene cannot have; or "FILE.py:FUNCTION"; None: context.world(scene)
    settings    {path: value} that all runs have
    seconds     simulated time of a run, s; None: to the last measured time
    shift       (low, high), s: the clock of the measurement may be behind that of the run by as much, which is fitted, too
    method      brent (one parameter), nelder-mead (several) or differential evolution; None: by the number of parameters
    evaluations the largest number of runs, kept ones included; tolerance: of the values, as a share of the range
    folder      where runs are kept; it is made
    jobs        processes at the same time, where the method allows; None: as many as cores
    backend     of the runs' contexts; series other than front and height need cpu; frame: s between two values of the curve; seed: of the random starts

    BadInput: a wrong argument. Error: a run failed, or its series is not finite."""
    whole = given.scene_of(os.fspath(scene) if isinstance(scene, os.PathLike) else scene)
    for part in NOT_OF_A_WORLD:
        if whole.get(part) and start is None:
            raise BadInput(f"the scene has {part}, which a fit cannot make by itself: give start, a function that makes the world")
    ranges = []
    for name, values in given.mapping(parameters, "parameters", '{"fluid.viscosity": (1e-6, 1e-2, "log")}').items():
        if not isinstance(values, (list, tuple)) or len(values) not in (2, 3):
            raise BadInput(f"{name}: the range is {values!r}: give (low, high) or (low, high, scale)")
        ranges.append(_Range(name, *values))
    if not ranges:
        raise BadInput("no parameter is to be found: name one with its range")
    settings = given.mapping({} if settings is None else settings, "settings", '{"fluid.viscosity": 0.01}')
    for what, paths in (("parameters", parameters), ("settings", settings)):
        for name in paths if start is None else ():  # a function makes of the scene what it likes
            given.check_path(name, what)
    shift = given.shift_of(shift)
    try:
        curve = np.array(measured, dtype=float)
    except (TypeError, ValueError) as error:
        raise BadInput(f"the measured curve is not of numbers: give rows of two, time and value ({error})") from error
    if curve.ndim != 2 or curve.shape[1] != 2 or len(curve) < len(ranges) + 2 or not np.isfinite(curve).all():
        raise BadInput(f"the measured curve has the shape {curve.shape}: give finite times and values, at least {len(ranges) + 2} rows of two")
    if (np.diff(curve[:, 0]) <= 0).any() or curve[0, 0] + shift[0] < 0:
        raise BadInput("the measured times must increase, and be at least 0 s with the shift added")
    method = given.one_of(("brent" if len(ranges) == 1 else "nelder-mead") if method is None else method, METHODS, "method")
    if method == "brent" and len(ranges) > 1:
        raise BadInput(f"brent finds one parameter, not {len(ranges)}: use nelder-mead or differential evolution")
    least = _least(method, len(ranges))
    evaluations = given.whole_number(evaluations, "evaluations", least, f", which {method} needs for {len(ranges)} "
                                     f"parameter{'s' if len(ranges) > 1 else ''}")
    tolerance = given.number(tolerance, "tolerance", 1e-9, 0.5, "a share of the range, from 1e-9 to 0.5")
    frame = given.number(frame, "frame", 1e-9, 3600, "seconds above 0 (at most 3600)")
    seed = given.whole_number(seed, "seed", 0)
    jobs = _cores() if jobs is None else given.whole_number(jobs, "jobs", 1)
    given.one_of(backend, given.BACKENDS, "backend")
    if start is not None and not callable(start):
        _function(given.text(start, "start", "FILE.py:FUNCTION"), "start")
    if callable(series):
        series = _named(series)
    elif given.text(series, "series", f"FILE.py:FUNCTION, {', '.join(SERIES)}") in LATE and backend != "cpu":
        raise BadInput(f"series {series} is some frames old on a GPU: set backend to cpu, or give a function that reads world.particles()")
    elif series not in SERIES:
        _function(series, "series")
    seconds = float(curve[-1, 0] + shift[1]) if seconds is None else given.number(seconds, "seconds")
    if seconds < curve[-1, 0] + shift[1]:
        raise BadInput(f"a run of {seconds:g} s ends before the measured curve with its shift, {curve[-1, 0] + shift[1]:g} s: raise seconds")
    plain = json.loads(text_of([{part: whole[part] for part in OF_A_WORLD if part in whole}, dict(settings)]) or b"")
    job = {"scene": plain[0], "settings": plain[1], "series": series,
           "start": _named(start) if callable(start) else start, "backend": backend, "seconds": seconds, "frame": frame, "threads": 0}
    search = _Search(job, ranges, curve, shift, folder, jobs, evaluations)
    try:
        _search(search, method, tolerance, seed)
        return Fit(search)
    finally:
        search.close()


def fit_file(path: Path) -> Fit:
    """A Fit of FIT.json (keys and units: docs/fitting.md), whose paths are relative to it; writes result.json, points.csv and fit.png into the
    folder of the fit. BadInput, Error: as fit."""
    path = pathlib.Path(path)
    try:
        asked = given.read(path)
        label, unit = asked.pop("label"), asked.pop("unit")
        found = fit(**asked)
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error
    found.save(asked["folder"])
    try:
        found.plot(asked["folder"] / "fit.png", label, unit)
    except ImportError:
        print("there is no plot, because Matplotlib is not installed: python3-matplotlib", file=sys.stderr)
    return found


def main(arguments: Sequence[str]) -> int:
    """The command: arguments after its name; returns the exit status."""
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print("usage: python3 -m rivulet.fit FIT.json\n\nFinds the parameters of a scene that reproduce a measured curve; docs/fitting.md has the keys.")
        return 0 if arguments in (["-h"], ["--help"]) else 2
    try:
        print(fit_file(arguments[0]))
    except (ImportError, OSError, RuntimeError) as error:  # OSError: of the plot
        print(f"rivulet.fit: {error}", file=sys.stderr)
        return 2 if isinstance(error, ValueError) else 1
    except KeyboardInterrupt:
        print("rivulet.fit: interrupted; the same command goes on with the runs that ended", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
