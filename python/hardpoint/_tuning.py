"""Tunings."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._study import Study, loads

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SideEffect:
    """A change that no target asks for."""

    output: str
    """Name without unit; with the name of the motion if that is not [motion]."""
    unit: str
    """Unit of all values."""
    before_min: float | None
    """Least value before the tuning at the stations compared; None without a value."""
    before_max: float | None
    """Largest value before."""
    after_min: float | None
    """Least value after."""
    after_max: float | None
    """Largest value after."""
    largest_change: float | None
    """Change of the largest amount, with its sign."""
    at: dict[str, float]
    """Station of that change: its coordinates with their units, such as {"travel_mm": 80.0}."""
    wheel: str | None
    """Wheel of an axle that changes most, "left" or "right"."""
    tolerance: float | None
    """Customary tolerance; None if there is none."""
    flagged: bool
    """True if the change exceeds the tolerance, or if stations have lost their values."""
    lost: int
    """Number of stations with a value before the tuning and none after it."""


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
    side_effects: list[SideEffect] = field(default_factory=list)
    """Changes that no target asks for, flagged ones first; empty with side_effects = false in [optimise]."""
    study: Study | None = None
    """The tuned study, comments kept."""


def optimise(study: Study, threads: int | None = None) -> Tuning:
    """Tunes the hardpoints as the study's [optimise] says; the numbers of `hardpoint optimise`."""
    found = _hardpoint.optimise(study._study, threads)
    text = found.pop("text")
    effects = [SideEffect(**effect) for effect in found.pop("side_effects", [])]
    tuned = None if text is None else loads(text, name=f"{study.name}.toml")
    return Tuning(side_effects=effects, study=tuned, **found)
