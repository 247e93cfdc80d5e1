"""Sweeps in parts: whoever does them, with workers killed, the same bytes."""

import hashlib
import multiprocessing
import os
import signal
from concurrent.futures import ProcessPoolExecutor

import pytest

import hardpoint as hp
from conftest import STUDIES
from hardpoint import distributed

SAMPLES = int(os.environ.get("HARDPOINT_SWEEP_SAMPLES", "300000"))


def study():
    return hp.load(
        STUDIES / "macpherson_sweep.toml",
        {"sweep.samples": SAMPLES, "motion.travel": [-20.0, 0.0, 20.0], "outputs.characteristics": ["camber"]},
    )


def digests(directory):
    """The SHA-256 of every part, its statistics and the summary."""
    names = sorted(p for p in directory.iterdir() if p.name.startswith("part-") or p.name == "summary.json")
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in names}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """What one process makes of it."""
    folder = tmp_path_factory.mktemp("alone")
    (folder / "macpherson_sweep.toml").write_text(study().text)
    assert hp.run(["--quiet", "sweep", folder / "macpherson_sweep.toml", "--out", folder / "run"]) == 0
    made = digests(folder / "run")
    assert len(made) == 2 * distributed.parts(study()) + 1
    return made


def pool():
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def test_a_process_pool_makes_the_same_bytes(alone, tmp_path):
    run = distributed.sweep(study(), tmp_path / "run", pool)
    assert digests(run) == alone
    # Again, nothing is left to do.
    before = {p: p.stat().st_mtime_ns for p in run.glob("part-*")}
    distributed.sweep(study(), run, pool)
    assert {p: p.stat().st_mtime_ns for p in run.glob("part-*")} == before


def test_a_killed_worker_loses_nothing(alone, tmp_path):
    victims = []

    def engine():
        made = pool()
        if not victims:
            made.submit(os.getpid).result()
            victims.append(next(iter(made._processes)))
            os.kill(victims[0], signal.SIGKILL)
        return made

    assert digests(distributed.sweep(study(), tmp_path / "run", engine)) == alone


def test_dask_makes_the_same_bytes_with_a_worker_killed(alone, tmp_path):
    pytest.importorskip("distributed")
    from dask.distributed import Client, LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster:
        with Client(cluster) as client:
            killed = []

            def engine():
                if not killed:
                    killed.append(client.run(os.getpid).popitem()[1])
                    os.kill(killed[0], signal.SIGKILL)
                return client.get_executor()

            run = distributed.sweep(study(), tmp_path / "run", engine)
    assert digests(run) == alone
