"""Speed of the module: measured times divided by the largest acceptable times. Needs scipy, and dask for the last two.

    python python/benches/speed.py [--program target/release/hardpoint] [--samples 1000000] [--only tuning]

Run it with a release wheel (`pip install ./python`) on a machine that does nothing else. Times are medians; for
sweeps they are the best of `--repeat` runs. A ratio above 1 means too slow.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

import hardpoint as hp
from hardpoint import distributed

STUDIES = Path(__file__).parents[2] / "studies"


def seconds(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def median(work: Callable[[], object], times: int) -> float:
    """Median time of a call over `times` calls, after some calls that warm up."""
    for _ in range(max(3, times // 10)):
        work()
    return statistics.median(seconds(work) for _ in range(times))


def least(work: Callable[[], object], times: int) -> float:
    return min(seconds(work) for _ in range(times))


class Bench:
    """Measurements. Each method yields names, measured values, their units, and the largest acceptable values."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.program = options.program
        self.repeat = options.repeat
        self.study = hp.load(STUDIES / "macpherson_sweep.toml", {"sweep.samples": options.samples})

    def design(self) -> Iterator[tuple[str, float, str, float]]:
        """Times of values and Jacobians of one design (four angles at all travels), and of a study with a moved point."""
        angles = {"outputs.characteristics": ["camber", "toe", "caster", "kingpin_inclination"]}
        for name, of_values, of_jacobian in [("macpherson_front", 40.0, 50.0), ("macpherson_axle", 400.0, None)]:
            f = hp.load(STUDIES / f"{name}.toml").replace(angles).function()
            x = np.zeros(len(f.variables))
            yield f"values, {name}", 1e6 * median(partial(f, x), 1000), "us", of_values
            if of_jacobian:
                jacobian = partial(f.value_and_jacobian, x)
                yield f"values and Jacobian, {name}", 1e6 * median(jacobian, 1000), "us", of_jacobian
        for name in ["macpherson_front", "double_wishbone_pushrod"]:
            study = hp.load(STUDIES / f"{name}.toml")
            moved = study["tie_rod_inner"] + 1e-3
            replace = partial(study.replace, points={"tie_rod_inner": moved})
            yield f"replace of a point, {name}", 1e6 * median(replace, 1000), "us", 20.0

    def tuning(self) -> Iterator[tuple[str, float, str, float]]:
        """Time of a tuning by SciPy with the exact Jacobian."""
        from scipy.optimize import least_squares

        r = hp.load(STUDIES / "macpherson_front.toml").residuals()
        lower, upper = r.bounds.T

        def tune() -> object:
            return least_squares(r, np.zeros(len(lower)), jac=r.jacobian, bounds=(lower, upper), x_scale=upper - lower)

        yield "tuning by SciPy", 1e3 * median(tune, 30), "ms", 6.0

    def arrays(self) -> Iterator[tuple[str, float, str, float]]:
        """Time of a sweep into arrays, divided by the time of the program's sweep into CSV, on all cores."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "study.toml"
            file.write_text(self.study.text)
            call = [*self.program, "--quiet", "sweep", file, "--out", Path(folder) / "run", "--force"]
            written = least(lambda: subprocess.run(call, check=True, stdout=subprocess.DEVNULL), self.repeat)
            made = least(lambda: hp.sweep(self.study), self.repeat)
            yield f"sweep into arrays ({made:.2f} s) to CSV ({written:.2f} s)", made / written, "", 0.6

    def dask(self) -> Iterator[tuple[str, float, str, float]]:
        """Additional time for parts with Dask, and the gain from a second worker."""
        import dask
        from dask.distributed import Client, LocalCluster

        # The documentation of Dask recommends switching the profiler off.
        dask.config.set({"distributed.worker.profile.enabled": False})

        def on(workers: int, folder: str, name: str) -> float:
            # The workers import the module before the measurement.
            with (
                LocalCluster(n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster,
                Client(cluster) as client,
            ):
                client.run(lambda: __import__("hardpoint.distributed"))
                executor = client.get_executor()
                return least(lambda: distributed.sweep(self.study, new(folder, name), executor), self.repeat)

        def new(folder: str, name: str) -> str:
            place = os.path.join(folder, name)
            shutil.rmtree(place, ignore_errors=True)
            return place

        def here(folder: str) -> None:
            count, out = distributed.parts(self.study), new(folder, "here")
            for part in range(count):
                distributed.sweep_part(self.study.text, self.study.name, out, part, count)

        with tempfile.TemporaryDirectory() as folder:
            alone = least(lambda: here(folder), self.repeat)
            one, two = on(1, folder, "one"), on(2, folder, "two")
        yield f"overhead of Dask, {distributed.parts(self.study)} parts ({alone:.2f} s without)", 100 * (one / alone - 1), "%", 6.0
        yield f"two workers ({two:.2f} s), share of one's time ({one:.2f} s)", two / one, "", 1 / 1.85


def main() -> int:
    kinds = ["design", "tuning", "arrays", "dask"]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", help="the program to compare with; else that of the module")
    parser.add_argument("--samples", type=int, default=1_000_000, help="designs of a sweep")
    parser.add_argument("--repeat", type=int, default=3, help="sweeps of which the fastest counts")
    parser.add_argument("--only", choices=kinds, action="append")
    options = parser.parse_args()
    options.program = [options.program] if options.program else [sys.executable, "-P", "-m", "hardpoint"]
    load = os.getloadavg()[0]
    print(f"hardpoint {hp.__version__}, {os.cpu_count()} cores, load {load:.2f} before")
    bench, missed = Bench(options), 0
    for kind in options.only or kinds:
        try:
            for name, figure, unit, bound in getattr(bench, kind)():
                missed += figure > bound
                word = "ok" if figure <= bound else "MISSED"
                print(f"{name:58} {figure:9.3f} {unit:2} at most {bound:6.3f}  ratio {figure / bound:5.2f}  {word}", flush=True)
        except ImportError as error:
            print(f"{kind}: left out, {error}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
