"""Sweeps from Python: the tasks of `rivulet sweep` on a Dask cluster, and the table of their results.

    from dask.distributed import Client
    from rivulet import sweep

    with Client() as client:                       # or Client("scheduler:8786")
        table = sweep.run("viscosity.json", client)
    table["fluid.viscosity"], table["energy.kinetic"]

docs/sweeps.md describes the file. Needs the program `rivulet`, on all workers at the same path, and a folder that all of them share. Workers
need nothing else: neither this package nor librivulet.so. pip does not install the program.
"""

from __future__ import annotations

import csv
import functools
import os
import pathlib
import shlex
import subprocess
import time
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["TaskError", "is_time", "prepare", "results", "run"]

_Path = str | os.PathLike[str]
_SHARED_SECONDS = 60.0  # NFS keeps the content of a folder for up to 60 s


class TaskError(RuntimeError):
    """Tasks failed. `failures`: a sentence for each, by the number of the task. The other tasks have ended; run() tries the failed again."""

    def __init__(self, failures: dict[int, str]) -> None:
        first = next(iter(failures.values()))
        more = f"; {len(failures) - 1} more tasks failed" if len(failures) > 1 else ""
        super().__init__(first + more)
        self.failures = failures


def _sentence(done: subprocess.CompletedProcess[str]) -> str:
    lines = done.stderr.strip().splitlines()
    return lines[-1].removeprefix("rivulet: ") if lines else f"{shlex.join(done.args)} ended with exit status {done.returncode}"


def prepare(path: _Path, output: _Path | None = None, *, threads: int = 1, program: str = "rivulet") -> tuple[pathlib.Path, list[list[str]]]:
    """The folder of a sweep, made if there is none, and the command line of each task as words, for any engine that runs commands.

    output: the folder; by default NAME of NAME.json, in the working directory. threads: of each task. Raises ValueError with the
    program's sentence if the sweep is refused, FileNotFoundError if there is no program."""
    folder = pathlib.Path(output if output is not None else pathlib.Path(path).stem).absolute()
    words = [program, "sweep", os.fspath(path), "--output", str(folder), "--threads", str(threads), "--dry-run"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise FileNotFoundError(f"the program {program} is not there; build or install rivulet, which pip does not, "
                                "and name its path as `program`") from None
    except PermissionError:
        raise PermissionError(f"the program {program} may not be run; name the path of rivulet as `program`") from None
    if done.returncode != 0:
        raise ValueError(_sentence(done))
    return folder, [shlex.split(line) for line in (folder / "tasks.txt").read_text().splitlines()]


def run(path: _Path, client: Any, output: _Path | None = None, *, threads: int = 1, program: str = "rivulet") -> dict[str, npt.NDArray[Any]]:
    """Runs the tasks that have not ended on a dask.distributed Client and returns the results. A task that was killed is done again.

    Arguments as of prepare(). Raises TaskError after the last task if some failed, or if a worker does not share the folder."""
    folder, lines = prepare(path, output, threads=threads, program=program)
    command = functools.partial(subprocess.run, capture_output=True, text=True, check=False)
    failures: dict[int, str] = {}

    def left() -> list[int]:
        return [k for k in range(len(lines)) if k not in failures and not (folder / "tasks" / str(k)).exists()]

    tasks = left()
    if tasks:
        futures = client.map(command, [lines[k] for k in tasks], pure=False)  # Dask does a task again if its worker was lost
        for k, future in zip(tasks, futures, strict=True):
            lost = future.exception()
            if lost is not None:
                failures[k] = f"task {k}: {lost!r}"
            elif (done := future.result()).returncode != 0:
                failures[k] = _sentence(done)
        deadline = time.monotonic() + _SHARED_SECONDS  # a network's file system shows a new folder after some seconds
        while (tasks := left()) and time.monotonic() < deadline:
            time.sleep(0.5)
        for k in tasks:
            failures[k] = f"task {k} has ended, but {folder / 'tasks' / str(k)} does not appear; use a folder that all workers share"
    if failures:
        raise TaskError(failures)
    return results(folder)


def is_time(column: str) -> bool:
    """Whether a column holds times of the wall clock, which differ from run to run; all others are the same on any machine of a kind."""
    return column.startswith("time.")


def results(folder: _Path) -> dict[str, npt.NDArray[Any]]:
    """The columns of results.csv in a sweep's folder, in order: one element for each task that has ended. A column of numbers is float64, with
    NaN where a task has no value; other columns are texts. pandas.DataFrame(results(folder)) makes a table of it. Raises ValueError before the
    first task has ended."""
    path = pathlib.Path(folder) / "results.csv"
    rows = []
    if path.exists() or not (path.parent / "sweep.json").exists():
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    if len(rows) < 2:
        raise ValueError(f"no task of {folder} has ended, so that there are no results; run the sweep")
    columns = {}
    for k, name in enumerate(rows[0]):
        cells = [row[k] for row in rows[1:]]
        try:
            columns[name] = np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
        except ValueError:
            columns[name] = np.array(cells)
    return columns
