"""Tunings."""

from __future__ import annotations

import html
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._frame import Frame
from ._function import names_of
from ._hardpoint import HardpointError
from ._runs import Results
from ._study import Study, is_car, study_of

if TYPE_CHECKING:
    from ._car import Car, CarTuning

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Tuning:
    """Result of a tuning. Names follow SciPy's OptimizeResult if it has the same quantity."""

    x: Floats | None
    """Offsets of the best design (k,): in the length unit, in degrees for a rotation, in the unit of the rate for a rate. For a
    relative rate: the natural logarithm of the factor. None if no start succeeded."""
    success: bool
    """True if all constraints are satisfied, all curves of the tuned design exist, no target is missed for lack of a variable,
    a requested front has designs, and nothing was interrupted. Otherwise `hardpoint optimise` ends with exit code 1."""
    message: str
    """Outcome in words: misfit, violated constraints, and the end of the start that gave the result."""
    misfit: float
    """Root of the weighted mean of squared deviations, each divided by its tolerance; NaN if no start succeeded."""
    before: float | None
    """Misfit of the study's own design; None if it cannot be evaluated."""
    variables: list[str]
    """Names of the variables (k)."""
    moves: Frame
    """A row for each variable: design, tuned, offset, low, high, at_bound ("lower", "upper" or ""). For a fit also its
    standard error and interval."""
    targets: Frame
    """A row for each target: rms and worst deviation, divided by the tolerance, before and after. NaN without a value."""
    constraints: Frame
    """A row for each constraint: margin (negative if violated), status "kept", "binds", "violated" or "unknown"
    (no value), price."""
    side_effects: Frame
    """A row for each quantity that changed although it has no target. Flagged rows come first. Columns: output, unit,
    before_min .. after_max, largest_change, at, tolerance, flagged, lost. Empty with side_effects = false in [optimise]."""
    front: Frame | None
    """Pareto front of the targets that `front` in [optimise] names, with a row for each design; None without `front`."""
    prices: Frame | None
    """Smallest misfit for each size of the change, if `prices=True`; otherwise None."""
    history: Frame
    """A row for each iteration of each start."""
    starts: Frame
    """A row for each start, with its outcome."""
    scatter: float | None
    """Scatter of the measurements about a fit, in multiples of the tolerance; None if the tuning is no fit."""
    expected_yield: dict[str, float] | None
    """Shares of builds within all bands, if robust = "yield"; None in other tunings. `without_scatter` is the share for the
    optimum without scatter, and `tuned` the share for the result, both from `builds` builds. `surrogate` is the smooth
    approximation of the yield that the search increases."""
    study: Study | None
    """Tuned study with the comments of the original. None if there is none, or if it is refused; `message` then gives the
    reason."""
    _source: Study = field(repr=False)
    _files: Mapping[str, bytes] = field(repr=False)
    _front: str | None = field(repr=False)

    def _results(self) -> Results:
        tuned = None if self.study is None else self.study._study
        files = {**self._files, **_hardpoint.tuning_files(self._source._study, tuned, self._front)}
        if self.study is not None:
            files["optimised.toml"] = self.study.text.encode()
        return Results(files, self._source)

    def save(self, directory: str | PathLike[str]) -> Path:
        """Writes curves before and after, summary, history, front and the tuned study into a new or empty directory, under
        the names of `hardpoint optimise`. Returns the directory."""
        return self._results().save(directory)

    def report(self, path: str | PathLike[str], plots: str | PathLike[str] | None = None) -> Path:
        """Writes one self-contained page to the file `path`, which is replaced, and pictures of the curves into the
        directory `plots`. Returns the path."""
        return self._results().report(path, plots)

    def __repr__(self) -> str:
        return f"<hardpoint.Tuning: {'success' if self.success else 'NO SUCCESS'}: {self.message}>"

    def _repr_html_(self) -> str:
        """Outcome, moves and targets, for notebooks."""
        frames = [self.moves, self.targets, self.constraints]
        return f"<p>{html.escape(repr(self))}</p>" + "".join(f._repr_html_() for f in frames if f.rows)


def _move(name: str, record: dict[str, Any]) -> dict[str, Any]:
    """Row of `Tuning.moves`."""
    low, high = record.pop("range")
    return {"name": name, **record, "low": low, "high": high, "at_bound": record["at_bound"] or ""}


def effect_row(record: dict[str, Any]) -> dict[str, Any]:
    """Row of `Tuning.side_effects`, with its station in words."""
    at = ", ".join(f"{place['name']} {place['value']:g} {place['unit']}" for place in record["at"])
    return {**record, "at": at, "wheel": record["wheel"] or ""}


@overload
def optimise(
    study: Study | str | PathLike[str],
    *,
    front: Sequence[str] | bool | None = None,
    prices: bool = False,
    threads: int | None = None,
    callback: Callable[[int, int, float], object] | None = None,
) -> Tuning: ...
@overload
def optimise(study: Car, *, threads: int | None = None) -> CarTuning: ...
def optimise(
    study: Study | Car | str | PathLike[str],
    *,
    front: Sequence[str] | bool | None = None,
    prices: bool = False,
    threads: int | None = None,
    callback: Callable[[int, int, float], object] | None = None,
) -> Tuning | CarTuning:
    """Tunes the hardpoints as the study's [optimise] requests; for a `Car` also rates. Results equal those of
    `hardpoint optimise`.

    `front` names the targets of a Pareto front, instead of those of the study; False computes no front. With `prices`, the
    result also contains the smallest misfit for each size of the design change. About twenty times a second, the calling
    thread calls `callback(start, iteration, misfit)` once for each new iteration. `StopIteration` or a true result of the
    callback ends the tuning with its present result. If the tuning has converged before the callback can end it, the result
    is complete.
    """
    if is_car(study):
        if front is not None or prices or callback is not None:
            raise HardpointError("a tuning of a car has no front, prices and callback; leave them out")
        return study.optimise(threads=threads)
    study = study_of(study)
    if front is not None and not isinstance(front, bool):
        study = study.replace({"optimise.front": names_of(front, "front")})
    found = _hardpoint.optimise(study._study, front is not False, prices, threads, callback)
    summary: dict[str, Any] = json.loads(found["summary"])
    constraints = summary["constraints"]
    misfit = summary["misfit_after"]
    files = {"summary.json": found["summary"].encode(), "history.csv": found["history"]}
    files |= {f"{name}.csv": found[name] for name in ("front", "side_effects") if found[name] is not None}
    return Tuning(
        x=found["x"],
        success=found["success"],
        message=found["message"],
        misfit=float("nan") if misfit is None else misfit,
        before=summary["misfit_before"],
        variables=found["variables"],
        moves=Frame.of_records(map(_move, found["variables"], summary["variables"])),
        targets=Frame.of_records(summary["targets"]),
        constraints=Frame.of_records(constraints),
        side_effects=Frame.of_records(map(effect_row, summary.get("side_effects", []))),
        front=None if found["front"] is None else Frame(_hardpoint.parse_table(found["front"])),
        prices=Frame.of_records(summary["prices"]) if prices else None,
        history=Frame(_hardpoint.parse_table(found["history"])),
        starts=Frame.of_records(summary["starts"]),
        scatter=summary["scatter"],
        expected_yield=found["expected_yield"],
        study=None if found["study"] is None else Study(found["study"]),
        _source=study,
        _files=files,
        _front=found["front_record"],
    )
