"""Sweeps into arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._frame import Frame
from ._function import Designs, rows_of
from ._hardpoint import STATUS, HardpointError
from ._study import Study, study_of

Floats = NDArray[np.float64]
_NOT_FINITE = STATUS.index("not_finite")


class Sweep(Frame):
    """Rows of a sweep: the columns of `designs.csv`, a row for each design."""

    variables: tuple[str, ...]
    """Columns of the variables, which come first."""

    def __init__(self, columns: dict[str, Floats], found: dict[str, Any]) -> None:
        super().__init__(columns, status=found["status"], reasons=found["reasons"])
        self.variables = tuple(list(self)[: found["variables"]])

    def __repr__(self) -> str:
        return f"<hardpoint.Sweep: {self.rows} designs, {len(self.failed)} failed; {len(self)} columns>"


def sweep(
    study: Study | str | PathLike[str],
    x: Designs | None = None,
    *,
    variables: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Sweep:
    """The designs of the study's [sweep], in arrays; the numbers of `hardpoint sweep`, to the bit.

    With `x` (n, k) the designs are its rows, and no [sweep] is needed. Its columns are `variables`, by default those of
    [sweep], else those of `study.variables`. A row with a number that is not finite has no values, and a status.
    `progress(done, all)` is called about twenty times a second.
    """
    study = study_of(study)
    if x is None:
        if variables is not None:
            raise HardpointError("variables are the columns of x, and there is no x")
        found = _hardpoint.sweep(study._study, None, None, threads, progress)
        return Sweep(found["columns"], found)
    names = list(variables) if variables is not None else study.sweep_variables or study.variables
    rows, _ = rows_of(x, names, study.length_unit)
    good: NDArray[np.bool_] = np.asarray(np.isfinite(rows).all(axis=1))
    solved = rows
    if not good.all() or not len(rows):
        middle = study.function(names).bounds.mean(axis=1)
        solved = np.where(good[:, None], rows, middle) if len(rows) else middle[None, :]
    found = _hardpoint.sweep(study._study, solved, names, threads, progress)
    columns = found["columns"]
    if not len(rows):
        columns = {name: values[:0] for name, values in columns.items()}
        found["status"], found["reasons"] = found["status"][:0], {}
    bad = np.flatnonzero(~good)
    for place, values in enumerate(columns.values()):
        if place < len(names):
            values[bad] = rows[bad, place]
        else:
            values[bad] = np.nan
    found["status"][bad] = _NOT_FINITE
    for row in bad.tolist():
        found["reasons"][row] = "x has a number that is not finite"
    return Sweep(columns, found)
