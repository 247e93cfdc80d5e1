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
    scatter: float | None = None
    """Scatter of the measurements about a fit, in tolerances; None if the tuning is no fit with intervals."""
    standard_errors: list[float | None] | None = None
    """Standard error of each offset of such a fit; None where the measurements do not determine it, and for all
    variables if one of them is at its bound."""
    intervals: list[tuple[str, float | None, float | None]] | None = None
    """The 95 % interval of each offset of such a fit: "two_sided", "at_most" (at its lower bound), "at_least" (at its
    upper bound) or "not_determined"; lowest and highest offset, None on a side without a limit."""
    study: Study | None = None
    """The tuned study, comments kept."""


def optimise(study: Study, threads: int | None = None) -> Tuning:
    """Tunes the hardpoints as the study's [optimise] says; the numbers of `hardpoint optimise`."""
    found = _hardpoint.optimise(study._study, threads)
    text = found.pop("text")
    return Tuning(study=None if text is None else loads(text, name=f"{study.name}.toml"), **found)
