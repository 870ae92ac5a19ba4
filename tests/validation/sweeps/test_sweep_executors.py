"""Sweeps on a Dask cluster and on MPI ranks, for real, where these extras are installed."""

import os
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from analysis.motion.outcomes import DONE
from tests.calls import ROOT
from tests.sweeps import sweep, swept
from validation.sweeps.pools import open_pool
from validation.sweeps.results import Results

AXIS = "spin=30:45:60"
WANTED = sweep(AXIS, end=0.3)
OPTIONS = "--model 4 --formulation reduced --end 0.3 --tolerance 1e-4 --executor mpi --out"

pytestmark = [
    pytest.mark.slow,
    # Not this project's: what the extras use of each other.
    pytest.mark.filterwarnings("ignore:::distributed"),
    pytest.mark.filterwarnings("ignore:::dask"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


def check_complete() -> None:
    """Every case is there, with the numbers of a run in this process."""
    here = swept(WANTED, Path("here.db"), numbers=range(0, 60, 7)).columns
    found = Results.load("a.db").columns
    assert found["number"].tolist() == list(range(60))
    assert set(found["status"]) == {DONE}
    np.testing.assert_array_equal(found["energy_end"][::7], here["energy_end"])


def test_dask_finishes_a_sweep_though_a_worker_is_killed() -> None:
    distributed = pytest.importorskip("distributed")
    killed: list[int] = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None
    ) as cluster:

        def told(_rows: object) -> None:
            if not killed:
                killed.append(cluster.workers[0].pid)
                os.kill(killed[0], signal.SIGKILL)

        with open_pool("dask", workers=2, scheduler=cluster.scheduler_address) as pool:
            assert pool.workers == 2
            swept(WANTED, pool=pool, told=told)
    assert killed
    check_complete()


def test_lost_dask_scheduler_is_told_and_the_rows_stay() -> None:
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None)
    closing: list[threading.Thread] = []

    def told(_rows: object) -> None:
        if not closing:
            closing.append(threading.Thread(target=cluster.close))
            closing[0].start()

    with pytest.raises(OSError, match="the workers are lost"):  # noqa: SIM117
        with open_pool("dask", workers=1, scheduler=cluster.scheduler_address) as pool:
            swept(WANTED, pool=pool, told=told)
    closing[0].join()
    assert 0 < Results.load("a.db").columns["number"].size < 60


def test_dask_scheduler_without_workers_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr("validation.sweeps.pools._WORKERS_PATIENCE", 0.1)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=None) as cluster,
        pytest.raises(OSError, match=f"scheduler {cluster.scheduler_address} has no workers"),
        open_pool("dask", scheduler=cluster.scheduler_address),
    ):
        pass


def test_mpi_ranks_finish_a_sweep() -> None:
    pytest.importorskip("mpi4py")
    places = os.pathsep.join((os.environ["PATH"], str(Path(sys.executable).parent)))
    found = shutil.which("mpiexec", path=places) or pytest.skip("needs mpiexec")
    path = Path("a.db").absolute()
    call = [found, "-n", "3", sys.executable, "-m", "mpi4py.futures", "-m", "validation", "sweep"]
    call += [AXIS, *OPTIONS.split(), str(path)]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)
    assert done.stdout == f"{path}: 60 cases\n", done.stderr
    check_complete()
