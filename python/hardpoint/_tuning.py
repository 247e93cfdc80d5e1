"""Tunings."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._study import Study, loads

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tuning:
    """What came of a tuning."""

    variables: list[str]
    """What moved."""
    x: Floats | None
    """Offsets of the best design (k,); None if no start succeeded."""
    misfit: float
    """Root of the weighted mean of squared deviations, in tolerances."""
    before: float | None
    """The same of the study's own design."""
    targets: list[tuple[float, float, float]] = field(default_factory=list)
    """Of each target: rms and largest deviation in tolerances, and the drive value of the latter."""
    study: Study | None = None
    """The tuned study, comments kept."""


def optimise(study: Study, threads: int | None = None) -> Tuning:
    """Tunes the hardpoints as the study's [optimise] says; the numbers of `hardpoint optimise`."""
    found = _hardpoint.optimise(study._study, threads)
    text = found.pop("text")
    return Tuning(study=None if text is None else loads(text, name=f"{study.name}.toml"), **found)
