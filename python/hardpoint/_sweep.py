"""Sweeps into arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._frame import Frame
from ._function import Designs, names_of, rows_of
from ._hardpoint import STATUS, HardpointError
from ._study import Study, is_car, study_of

if TYPE_CHECKING:
    from ._car import Car

Floats = NDArray[np.float64]
_NOT_FINITE = STATUS.index("not_finite")


class Sweep(Frame):
    """Rows of a sweep: the columns of `designs.csv`, with a row for each design."""

    variables: tuple[str, ...]
    """Columns of the variables, which come first."""

    curves: Frame | None
    """Every station of every design, with curves = true in [sweep]: the columns of `curves.csv`. None otherwise. Designs
    that are not finite have no rows."""

    def __init__(
        self, columns: dict[str, Floats], found: dict[str, Any], study: Study | None = None, names: list[str] | None = None
    ) -> None:
        super().__init__(columns, status=found["status"], reasons=found["reasons"])
        self.variables = tuple(list(self)[: found["variables"]])
        self.curves = None if found["curves"] is None else _curves(found["curves"], found["status"])
        self._study = study
        self._names = names

    def _source(self) -> tuple[Study, Floats | None]:
        """Study, and the designs if they do not come from its [sweep]."""
        if self._study is None:
            raise HardpointError('to write the sweep of a car, use hp.run(["sweep", "car.toml", "--report"])')
        if self._names is None:
            return self._study, None
        x = np.column_stack([self[name] for name in self.variables])
        if not np.isfinite(x).all():
            raise HardpointError("the sweep has designs that are not finite; leave them out")
        return self._study, np.ascontiguousarray(x)

    def save(self, directory: str | PathLike[str]) -> Path:
        """Solves the designs again and writes the files of `hardpoint sweep` into a directory. Returns the directory."""
        study, x = self._source()
        _hardpoint.sweep_into(study._study, Path(directory), x, self._names)
        return Path(directory)

    def report(self, path: str | PathLike[str]) -> Path:
        """Solves the designs again and writes one self-contained page to the file `path`, which is replaced. Returns the
        path."""
        study, x = self._source()
        Path(path).write_text(_hardpoint.sweep_page(study._study, x, self._names), encoding="utf-8", newline="")
        return Path(path)

    def __repr__(self) -> str:
        return f"<hardpoint.Sweep: {self.rows} designs, {len(self.failed)} failed; {len(self)} columns>"


def _curves(csv: bytes, status: NDArray[np.uint8]) -> Frame:
    """Curves of the designs without those that are not finite."""
    table = _hardpoint.parse_table(csv)
    bad = np.flatnonzero(status == _NOT_FINITE)
    kept = ~np.isin(table["design"], bad)
    return Frame({name: np.asarray(values)[kept] for name, values in table.items()} if bad.size else table)


@overload
def sweep(
    study: Study | str | PathLike[str],
    x: Designs | None = None,
    *,
    variables: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Sweep: ...
@overload
def sweep(
    study: Car, *, threads: int | None = None, progress: Callable[[int, int], object] | None = None
) -> Sweep: ...
def sweep(
    study: Study | Car | str | PathLike[str],
    x: Designs | None = None,
    *,
    variables: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Sweep:
    """Solves the designs of the study's [sweep] into arrays. Results equal those of `hardpoint sweep` bit for bit.

    With `x` (n, k) the designs are its rows, and the study needs no [sweep]. The columns of x are `variables`; the default
    is the variables of [sweep], otherwise `study.variables`. The numbers are offsets or coordinates in the length unit, or
    rates. A row with a number that is not finite has a status but no values. `progress(done, all)` is called about twenty
    times a second. A `Car` uses the designs of its [sweep].
    """
    if is_car(study):
        if x is not None or variables is not None:
            raise HardpointError("a car uses the designs of its [sweep]; leave out x and variables")
        return study.sweep(threads=threads, progress=progress)
    study = study_of(study)
    if x is None:
        if variables is not None:
            raise HardpointError("variables name the columns of x, but there is no x")
        found = _hardpoint.sweep(study._study, None, None, threads, progress)
        return Sweep(found["columns"], found, study)
    names = names_of(variables, "variables") if variables is not None else study.sweep_variables or study.variables
    columns, at_design = zip(*_hardpoint.sweep_columns(study._study, names), strict=True) if names else ((), ())
    rows, _ = rows_of(x, names, columns)
    good: NDArray[np.bool_] = np.asarray(np.isfinite(rows).all(axis=1))
    solved = rows
    if not good.all() or not len(rows):
        # The study's own design replaces each row that cannot be solved. Further below, the results of these rows are
        # set to NaN.
        own = np.array(at_design)
        solved = np.where(good[:, None], rows, own) if len(rows) else own[None, :]
    found = _hardpoint.sweep(study._study, solved, names, threads, progress)
    found_columns = found["columns"]
    if not len(rows):
        found_columns = {name: values[:0] for name, values in found_columns.items()}
        found["status"], found["reasons"] = found["status"][:0], {}
        if found["curves"] is not None:
            found["curves"] = found["curves"].split(b"\n", 1)[0] + b"\n"
    bad = np.flatnonzero(~good)
    for place, values in enumerate(found_columns.values()):
        if place < len(names):
            values[bad] = rows[bad, place]
        else:
            values[bad] = np.nan
    found["status"][bad] = _NOT_FINITE
    for row in bad.tolist():
        found["reasons"][row] = "x has a number that is not finite"
    return Sweep(found_columns, found, study, names)
