#!/usr/bin/env python3
"""dask_sweeps.py [SWEEP.json DIR], called by dask.sh and chart.sh: sweeps by rivulet.sweep on a Dask cluster on loopback; without arguments
those of dask.sh."""
import os
import pathlib
import signal
import sys
import threading
import time

from distributed import Client, LocalCluster

from rivulet import sweep


def kill_a_worker(cluster, folder):
    """When task 4 has ended: SIGKILL to one worker process; what had ended by then goes to before.txt."""
    while not (folder / "tasks/4").exists():
        time.sleep(0.05)
    victim = next(iter(cluster.workers.values()))
    os.kill(victim.process.process.pid, signal.SIGKILL)
    ended = sorted(path for path in (folder / "tasks").iterdir() if path.name.isdigit())
    pathlib.Path("before.txt").write_text("".join((path / "process").read_text() for path in ended))


def local_cluster(threads):
    return LocalCluster(n_workers=2, threads_per_worker=threads, processes=True, host="127.0.0.1", dashboard_address=None)


if __name__ == "__main__" and len(sys.argv) > 1:
    with local_cluster(threads=1) as cluster, Client(cluster) as client:
        sweep.run(sys.argv[1], client, sys.argv[2], program=os.environ["RIVULET"])
elif __name__ == "__main__":
    with local_cluster(threads=2) as cluster, Client(cluster) as client:
        table = sweep.run("hundred.json", client, "dask", program=os.environ["RIVULET"])
        assert len(table["task"]) == 100 and table["energy.kinetic"].dtype == float and table["fluid.method"][0] in ("pbf", "dfsph", "wcsph")
        assert all(sweep.is_time(name) for name in list(table)[-3:])
        killer = threading.Thread(target=kill_a_worker, args=(cluster, pathlib.Path("lost")))
        killer.start()
        assert len(sweep.run("slow.json", client, "lost", program=os.environ["RIVULET"])["k"]) == 16
        killer.join()
        pathlib.Path("bad.json").write_text('{"command": "/bin/false {k}", "parameters": {"k": [1, 2]}}')
        try:
            sweep.run("bad.json", client, program=os.environ["RIVULET"])
            raise SystemExit("a task that fails is not reported")
        except sweep.TaskError as error:
            assert sorted(error.failures) == [0, 1] and "`/bin/false` ended with exit status 1" in str(error), error
        try:
            sweep.prepare("none.json", program=os.environ["RIVULET"])
            raise SystemExit("a sweep that is missing is not reported")
        except ValueError as error:
            assert "none.json cannot be read" in str(error), error
