"""A sweep on Dask: every worker writes parts of 131,072 designs into one directory; nothing goes through the driver.

With a cluster: `dask_jobqueue.SLURMCluster(...)` or `PBSCluster`, `LSFCluster` in place of `LocalCluster`, and a directory
that every node sees. Run it again after a kill, of whatever: parts that are whole are passed over.
"""

import sys
import tempfile
from pathlib import Path

from dask.distributed import Client, LocalCluster

import hardpoint as hp
from hardpoint import distributed

STUDY = Path(__file__).resolve().parents[2] / "studies" / "macpherson_sweep.toml"

if __name__ == "__main__":
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 200_000
    study = hp.load(STUDY, {"sweep.samples": samples, "motion.travel": [-20.0, 0.0, 20.0]})
    # A part is one thread's work, so a worker is one thread.
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        run = hp.read_run(distributed.sweep(study, Path(folder) / "run", client.get_executor))
        assert run["designs"].rows == samples
        print(f"misfit from {min(run['designs']['misfit']):.3g}, of {samples} designs in {distributed.parts(study)} parts")
