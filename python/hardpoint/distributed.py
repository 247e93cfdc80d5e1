"""Sweeps on many workers. Any executor with `submit()` works: Dask (`client.get_executor()`), dask-jobqueue,
`concurrent.futures`, or a short adapter.

The directory is the result. It consists of parts of 131,072 designs (in some sweeps of elastic parts 1,024). Each part is
written under a temporary name with its statistics, and renamed when complete; no results pass through the driver. The bytes
of a part do not depend on its worker.
If a worker, node or driver stops, only the current part is lost. Run the same call again: it skips complete parts.
Sweeps of cars are not available here.

>>> from dask.distributed import Client                                   # doctest: +SKIP
>>> import hardpoint as hp
>>> from hardpoint import distributed
>>> study = hp.load("study.toml", {"sweep.samples": 100_000_000})         # doctest: +SKIP
>>> distributed.sweep(study, "run", Client().get_executor)                # doctest: +SKIP
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from concurrent.futures import Executor, Future, as_completed
from pathlib import Path

from . import HardpointError, Study, _hardpoint
from ._commands import said_here

__all__ = ["parts", "sweep", "sweep_part"]

_log = logging.getLogger(__name__)


def parts(study: Study) -> int:
    """Number of parts of the study's sweep. It depends on the sweep alone, not on the cluster."""
    return _hardpoint.sweep_parts(study._study)


class Refused(HardpointError):
    """Error that every worker would have: the study or the directory is wrong."""


def sweep_part(text: str, name: str, out: str, part: int, of: int) -> int:
    """Solves one part (from 0) of the sweep into the directory `out`, on one thread. Returns the number of the part. It
    skips a complete part, and waits for a part that another process is solving."""
    try:
        is_whole = _hardpoint.sweep_into(_hardpoint.Study.loads(text, f"{name}.toml"), Path(out), part=(part, of), threads=1)
    except HardpointError as error:
        raise Refused(f"part {part} of {of}: {said_here(str(error))}") from None
    except OSError as error:
        raise HardpointError(f"part {part} of {of}: {said_here(str(error))}") from None
    if not is_whole:
        raise HardpointError(f"part {part} of {of} is incomplete")
    return part


def sweep(
    study: Study,
    out: str | os.PathLike[str],
    executor: Executor | Callable[[], Executor],
    tries: int = 4,
) -> Path:
    """Solves the study's sweep into the directory `out`, and returns the directory. Every worker must see `out` under this
    path.

    `executor` is an executor, or a function that makes one. A process pool that lost a worker is no longer usable, so give
    a function for such pools. Failed parts are tried again, `tries` times in total. A study that names files (`designs =
    "x.csv"`) needs absolute paths for them.
    """
    count = parts(study)
    directory = Path(out).absolute()
    left = set(range(count))
    for attempt in range(tries):
        engine = executor() if callable(executor) else executor
        futures: list[Future[int]] = []
        try:
            for part in sorted(left):
                futures.append(engine.submit(sweep_part, study.text, study.name, str(directory), part, count))
        except Exception as error:  # noqa: BLE001: the executor may already have lost its workers
            _log.warning("the executor accepts no more parts: %s", error)
        try:
            left -= _done(futures, is_last=attempt + 1 == tries)
        except BaseException:
            _stop(engine, futures, is_own=callable(executor))
            raise
        if callable(executor) and hasattr(engine, "shutdown"):
            engine.shutdown()
        if not left:
            return directory
    raise HardpointError(f"{len(left)} of {count} parts are not done after {tries} tries: {sorted(left)[:10]}")


def _done(futures: list[Future[int]], is_last: bool) -> set[int]:
    """Numbers of the parts that are done."""
    done: set[int] = set()
    for future in as_completed(futures):
        try:
            done.add(future.result())
        except Refused:
            raise
        except HardpointError:
            # Most errors would occur on every worker. But a full disk may affect one worker only, so the
            # error is raised at the last try.
            if is_last:
                raise
        except Exception as error:  # noqa: BLE001: an executor may raise any exception for a lost worker
            _log.warning("a part is tried again: %s", error)
    return done


def _stop(engine: Executor, futures: list[Future[int]], is_own: bool) -> None:
    """Cancels parts that have not started, and ends the workers of an executor made here. Incomplete parts do not count as
    results."""
    for future in futures:
        future.cancel()
    if is_own:
        processes = dict(getattr(engine, "_processes", None) or {})
        for process in processes.values():
            process.terminate()
        if hasattr(engine, "shutdown"):
            engine.shutdown(wait=not processes, cancel_futures=True)
