"""Curves of a design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """What a column is."""

    name: str
    """With its unit, as in `camber_deg`."""
    output: str
    """Without order and unit."""
    unit: str
    """The unit alone; empty for a plain number."""
    positive: str | None
    """When it is positive, in words."""


class Curves(Mapping[str, Floats]):
    """Curves of a design: a mapping from column names to arrays (S,), NaN where there is no value."""

    def __init__(self, found: dict[str, Any]) -> None:
        self._columns: dict[str, Floats] = found["columns"]
        self.columns: list[Column] = [Column(name, *info) for name, info in found["info"].items()]
        """What each column is."""
        self.motion: dict[str, Floats] = found["motion"]
        """Where the stations are, by the columns that `curves.csv` begins with, such as "travel_mm", of an axle
        "roll_deg", "heave_mm", "travel_left_mm": each (S,)."""
        self.drive: Floats = found.get("drive", next(iter(self.motion.values())))
        """Drive value of each station (S,): travel in the length unit, angles in degrees; of an axle the first column
        of `motion`."""
        self.status: list[str] = found["status"]
        """What came of each station: "ok", "unreachable", ..."""
        self.sensitivities: Floats | None = found.get("sensitivities")
        """Derivatives (S, C, P, 3) by the hardpoints that the study names, in the column's unit per length unit. Of an
        axle (sides, S, C, P, 3): one side where the right wheel is the mirror image and moves with the left one, else
        by the left and the right hardpoints."""
        self.sensitivity_points: list[str] = found.get("sensitivity_points", [])

    def __getitem__(self, name: str) -> Floats:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        solved = sum(s == "ok" for s in self.status)
        return f"<hardpoint.Curves: {solved} of {len(self.status)} stations ok; {', '.join(self._columns)}>"
