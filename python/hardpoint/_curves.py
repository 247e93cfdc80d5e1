"""Curves of a design."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._frame import Column, Frame

Floats = NDArray[np.float64]


class Curves(Frame):
    """Curves of a design: the columns of `curves.csv`, a row for each station. Columns of the motion come first."""

    outputs: tuple[str, ...]
    """Columns of the outputs that the study asks for."""
    sensitivities: Floats | None
    """Derivatives (S, C, P, 3) of the C `outputs` by the hardpoints that the study names, in the column's unit per length
    unit. Of an axle (sides, S, C, P, 3): one side where the right wheel is the mirror image and moves with the left one,
    else by the left and the right hardpoints."""
    sensitivity_points: tuple[str, ...]
    """Names of the P hardpoints."""

    def __init__(self, found: dict[str, Any]) -> None:
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

    @property
    def drive(self) -> Floats:
        """Drive value of each station (S,): the first column of `motion`."""
        return next(iter(self.motion.values()))

    def __repr__(self) -> str:
        solved = int(np.count_nonzero(self.status == 0))
        return f"<hardpoint.Curves: {solved} of {self.rows} stations ok; {', '.join(self)}>"
