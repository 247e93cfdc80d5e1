"""Curves of a design."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._frame import Column, Frame

if TYPE_CHECKING:
    from ._runs import Results
    from ._study import Study

Floats = NDArray[np.float64]


class Curves(Frame):
    """Curves of a design: the columns of `curves.csv`, with a row for each station. Columns of the motion come first."""

    outputs: tuple[str, ...]
    """Columns of the study's outputs."""
    sensitivities: Floats | None
    """Derivatives (S, C, P, 3) of the C `outputs` with respect to the study's sensitivity hardpoints, in the column's unit
    per length unit. An axle has (sides, S, C, P, 3). There is one side if the right wheel is a mirror image and moves with
    the left wheel. Otherwise the derivatives are with respect to the left hardpoints, then to the right ones."""
    sensitivity_points: tuple[str, ...]
    """Names of the P hardpoints."""

    def __init__(self, found: dict[str, Any], study: Study, motion: str | None = None) -> None:
        super().__init__(
            found["columns"],
            info={name: Column(name, *info) for name, info in found["info"].items()},
            status=found["status"],
            reasons=found["reasons"],
            motion=found["motion"],
        )
        self.outputs = tuple(found["outputs"])
        self.sensitivities = found.get("sensitivities")
        self.sensitivity_points = tuple(found.get("sensitivity_points", ()))
        self._study = study
        self._of_motion = motion

    @property
    def drive(self) -> Floats:
        """Drive value of each station (S,): the first column of `motion`."""
        return next(iter(self.motion.values()))

    def _results(self) -> Results:
        from ._runs import Results

        return Results(_hardpoint.solve_files(self._study._study, self._of_motion), self._study)

    def save(self, directory: str | PathLike[str]) -> Path:
        """Writes the files of `hardpoint solve` into a new or empty directory. Returns the directory."""
        return self._results().save(directory)

    def report(self, path: str | PathLike[str], plots: str | PathLike[str] | None = None) -> Path:
        """Writes one self-contained page to the file `path`, which is replaced, and pictures of the curves into the
        directory `plots`. Returns the path."""
        return self._results().report(path, plots)

    def __repr__(self) -> str:
        solved = int(np.count_nonzero(self.status == 0))
        return f"<hardpoint.Curves: {solved} of {self.rows} stations ok; {', '.join(self)}>"
