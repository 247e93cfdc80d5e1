"""Curves and targets as functions of the design."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hardpoint
from ._hardpoint import HardpointError

if TYPE_CHECKING:
    from ._study import Study

Floats = NDArray[np.float64]


def rows_of(x: ArrayLike, names: list[str]) -> tuple[Floats, bool]:
    """Designs as an array (n, k), and whether it was one alone."""
    try:
        array = np.ascontiguousarray(x, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise HardpointError(f"x is no array of numbers ({error}); expected float64") from None
    k = len(names)
    if array.ndim not in (1, 2) or array.shape[-1] != k or np.ndim(x) == 0:
        raise HardpointError(f"x has shape {np.shape(x)}; expected ({k},) or (n, {k}), a column for each of variables")
    return np.atleast_2d(array), array.ndim == 1


class Function:
    """Curves as a pure function of the design.

    `f(x)` takes offsets (k,) and gives (A, S), or (n, k) and gives (n, A, S): A outputs at S stations. A variable that a
    sweep marks as absolute is a coordinate, not an offset.
    """

    words = ("ok", "failed", "faulty")
    """What the numbers of `status` mean: every station has a pose; some has none; the design cannot be solved."""

    def __init__(self, function: _hardpoint.Function) -> None:
        self._function = function
        self.variables: list[str] = function.variables
        """Names (k)."""
        self.bounds: Floats = function.bounds
        """Lowest and highest value (k, 2), in the length unit; degrees of a turn."""
        self.outputs: list[str] = function.outputs
        """Column names (A)."""
        self.stations: Floats = function.stations
        """Drive value and rack displacement (S, 2)."""

    def __call__(self, x: ArrayLike, threads: int | None = None) -> Floats:
        """Values (A, S) or (n, A, S); NaN where a design has none."""
        rows, single = rows_of(x, self.variables)
        values, _ = self._function.values(rows, threads)
        return values[0] if single else values

    def value_and_jacobian(self, x: ArrayLike, threads: int | None = None) -> tuple[Floats, Floats]:
        """Values, and their exact derivatives by the variables: (A, S, k) or (n, A, S, k)."""
        rows, single = rows_of(x, self.variables)
        values, jacobian, _ = self._function.value_and_jacobian(rows, threads)
        return (values[0], jacobian[0]) if single else (values, jacobian)

    def status(self, x: ArrayLike, threads: int | None = None) -> NDArray[np.uint8]:
        """What came of each design (n,), a place in `words`."""
        rows, _ = rows_of(x, self.variables)
        return self._function.values(rows, threads)[1]

    def __repr__(self) -> str:
        return repr(self._function)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Function, (self._function,))


class Residuals:
    """The targets of [optimise] as least squares: r(x) (m,) in tolerances, weighted so that the misfit is the root of
    their mean square. SciPy asks for r and its Jacobian apart; the last x is remembered."""

    def __init__(self, study: Study) -> None:
        self._residuals = _hardpoint.Residuals(study._study)
        self.names: list[str] = self._residuals.variables
        """Names of the variables (k)."""
        self.bounds: Floats = self._residuals.bounds
        """Lowest and highest offset (k, 2)."""
        self._last: tuple[bytes, Floats, Floats] | None = None

    def value_and_jacobian(self, x: ArrayLike) -> tuple[Floats, Floats]:
        """r (m,) and its derivatives (m, k). A design that cannot be solved raises `HardpointError`."""
        array = np.ascontiguousarray(x, dtype=np.float64)
        key = array.tobytes()
        if self._last is None or self._last[0] != key:
            values, jacobian = self._residuals.value_and_jacobian(array)
            self._last = (key, values, jacobian)
        return self._last[1].copy(), self._last[2].copy()

    def __call__(self, x: ArrayLike) -> Floats:
        return self.value_and_jacobian(x)[0]

    def jacobian(self, x: ArrayLike) -> Floats:
        """Derivatives (m, k)."""
        return self.value_and_jacobian(x)[1]
