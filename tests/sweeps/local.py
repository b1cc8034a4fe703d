#!/usr/bin/env python3
"""local.py PROGRAM: rivulet.sweep without Dask, whose client is replaced by threads: tasks, failures, the table as arrays. Exit 77: NumPy is not
installed."""
import concurrent.futures
import os
import pathlib
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)
from rivulet import sweep

program = str(pathlib.Path(sys.argv[1]).resolve())


class Threads:
    """The part of a dask.distributed.Client that sweep.run uses."""

    def __init__(self):
        self.pool = concurrent.futures.ThreadPoolExecutor(3)
        self.started = 0

    def map(self, function, *lists, pure):
        self.started += len(lists[0])
        return [self.pool.submit(function, *arguments) for arguments in zip(*lists)]


def refusal(kind, call):
    try:
        call()
    except kind as error:
        return error
    raise SystemExit(f"no {kind.__name__} was raised")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    write = '/bin/sh -c \'echo "{{\\"speed\\": {a}.5, \\"wallSeconds\\": 1, \\"list\\": [1, null, 2]}" >{task}/stats.json; test {a} != 3 -o -f go\''
    pathlib.Path("s.json").write_text('{"command": "%s", "parameters": {"a": [1, 2, 3], "b": ["x,y", "z"]}}'
                                      % (write + " {b}").replace("\\", "\\\\").replace('"', '\\"'))
    client = Threads()
    error = refusal(sweep.TaskError, lambda: sweep.run("s.json", client, "out", program=program))
    assert sorted(error.failures) == [4, 5] and "task 4: `/bin/sh` ended with exit status 1" in str(error), error
    assert len(sweep.results("out")["task"]) == 4
    pathlib.Path("go").touch()
    table = sweep.run("s.json", client, "out", program=program)
    assert client.started == 8, "only the failed tasks were run again"
    assert list(table) == ["task", "a", "b", "list.0", "list.2", "speed", "time.wallSeconds"], list(table)
    assert np.array_equal(table["speed"], [1.5, 1.5, 2.5, 2.5, 3.5, 3.5]) and table["b"][4] == "x,y"
    assert [name for name in table if sweep.is_time(name)] == ["time.wallSeconds"]
    assert "none.json cannot be read" in str(refusal(ValueError, lambda: sweep.prepare("none.json", program=program)))
    assert "pip does not" in str(refusal(FileNotFoundError, lambda: sweep.prepare("s.json", program="/nowhere/rivulet")))

    # A worker without the shared folder: its task ends there, and nothing appears here.
    class Elsewhere(Threads):
        def map(self, function, lines, pure):
            return [self.pool.submit(function, ["/bin/true"]) for line in lines]

    sweep._SHARED_SECONDS = 1.0
    error = refusal(sweep.TaskError, lambda: sweep.run("s.json", Elsewhere(), "apart", program=program))
    assert len(error.failures) == 6 and "use a folder that all workers share" in str(error), error
    assert "no task of apart has ended" in str(refusal(ValueError, lambda: sweep.results("apart")))
    pathlib.Path("apart/results.csv").write_text("task,k\n")  # as after a sweep in which every task failed
    assert "no task of apart has ended" in str(refusal(ValueError, lambda: sweep.results("apart")))
    pathlib.Path("apart/results.csv").unlink()
    path, lines = sweep.prepare("s.json", "other", program=program, threads=2)
    assert path == pathlib.Path("other").absolute() and len(lines) == 6 and lines[5][-4:] == ["--task", "5", "--threads", "2"], lines
print("sweeps from Python: in order")
