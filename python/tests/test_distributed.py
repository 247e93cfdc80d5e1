"""Sweeps in parts have the same bytes with every executor, also if workers and drivers are killed during the sweep.

`HARDPOINT_SWEEP_SAMPLES=1000000` selects the long check.
"""

import hashlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import pytest

import hardpoint as hp
from conftest import STUDIES
from hardpoint import distributed

SAMPLES = int(os.environ.get("HARDPOINT_SWEEP_SAMPLES", "300000"))


@pytest.fixture(scope="module")
def study():
    fields = {"sweep.samples": SAMPLES, "motion.travel": [-20.0, 0.0, 20.0], "outputs.characteristics": ["camber"]}
    return hp.load(STUDIES / "macpherson_sweep.toml", fields)


def digests(directory):
    """SHA-256 of every part, of its statistics and of the summary."""
    names = sorted(p for p in directory.iterdir() if p.name.startswith("part-") or p.name == "summary.json")
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in names}


def program(*arguments):
    return subprocess.Popen([sys.executable, "-P", "-m", "hardpoint", "--quiet", *map(str, arguments)])


@pytest.fixture(scope="module")
def file(study, tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "macpherson_sweep.toml"
    path.write_text(study.text)
    return path


@pytest.fixture(scope="module")
def alone(study, file, tmp_path_factory):
    """Hashes of the files that a single process writes for the sweep."""
    run = tmp_path_factory.mktemp("alone") / "run"
    assert program("sweep", file, "--out", run).wait() == 0
    made = digests(run)
    assert len(made) == 2 * distributed.parts(study) + 1
    return made


class Killer(threading.Thread):
    """Kills a process as soon as a directory contains a file of a part."""

    def __init__(self, directory, process):
        super().__init__(daemon=True)
        self.directory, self.process, self.has_killed = directory, process, False
        self.start()

    def run(self):
        end = time.monotonic() + 120.0
        while time.monotonic() < end and not self.has_killed:
            if self.directory.is_dir() and any("part-" in p.name for p in self.directory.iterdir()):
                os.kill(self.process, signal.SIGKILL)
                self.has_killed = True
            time.sleep(0.005)


def pool():
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def test_shards_of_the_program_make_the_same_bytes(alone, file, tmp_path):
    shards = [program("sweep", file, "--out", tmp_path / "run", "--shard", f"{i}/2", "--threads", 1) for i in (1, 2)]
    assert [shard.wait() for shard in shards] == [0, 0]
    assert digests(tmp_path / "run") == alone


def test_a_process_pool_with_a_killed_worker_makes_the_same_bytes(alone, study, tmp_path):
    killers = []

    def engine():
        made = pool()
        made.submit(os.getpid).result()
        if not killers:
            killers.append(Killer(tmp_path / "run", next(iter(made._processes))))
        return made

    run = distributed.sweep(study, tmp_path / "run", engine)
    assert killers[0].has_killed
    assert digests(run) == alone
    # A second call finds all parts complete, so it writes no file.
    before = {p: p.stat().st_mtime_ns for p in run.glob("part-*")}
    distributed.sweep(study, run, pool)
    assert {p: p.stat().st_mtime_ns for p in run.glob("part-*")} == before


DRIVER = """
import sys
import hardpoint as hp
from dask.distributed import Client
from hardpoint import distributed
study = hp.loads(open(sys.argv[1]).read(), name="macpherson_sweep.toml")
distributed.sweep(study, sys.argv[2], Client(sys.argv[3]).get_executor)
"""


def test_dask_with_a_killed_worker_and_a_killed_driver_makes_the_same_bytes(alone, study, file, tmp_path):
    pytest.importorskip("distributed")
    from dask.distributed import Client, LocalCluster

    run = tmp_path / "run"
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        workers = client.run(os.getpid)
        worker = Killer(run, next(iter(workers.values())))
        command = [sys.executable, "-P", "-c", DRIVER, str(file), str(run), cluster.scheduler_address]
        driver = subprocess.Popen(command)
        worker.join()
        assert worker.has_killed
        driver.kill()
        driver.wait()
        assert set(digests(run)) != set(alone), "the driver was killed before its end"
        # A second call of the sweep computes the missing parts.
        distributed.sweep(study, run, client.get_executor)
    assert digests(run) == alone
    assert hp.read_run(run)["designs"].rows == SAMPLES


def test_an_occupied_directory_is_refused_at_once_with_the_reason(study, tmp_path):
    small = study.replace({"sweep.samples": 1000})
    with ThreadPoolExecutor(2) as engine:
        distributed.sweep(small, tmp_path / "run", engine)
        with pytest.raises(distributed.Refused, match="part 0 of 1: .*run"):
            distributed.sweep(small.replace({"sweep.seed": 2}), tmp_path / "run", engine)


def test_ctrl_c_ends_the_workers(study, tmp_path):
    large = study.replace({"sweep.samples": 20_000_000})
    engines = []

    def engine():
        engines.append(ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")))
        return engines[-1]

    timer = threading.Timer(6.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        distributed.sweep(large, tmp_path / "run", engine)
    timer.join()
    before = len(list((tmp_path / "run").glob("part-*.csv")))
    time.sleep(3.0)
    assert len(list((tmp_path / "run").glob("part-*.csv"))) == before
