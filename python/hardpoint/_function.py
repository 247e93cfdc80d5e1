"""Curves and targets as functions of the design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hardpoint
from ._hardpoint import HardpointError

if TYPE_CHECKING:
    from ._study import Study

Floats = NDArray[np.float64]
Designs = ArrayLike | Mapping[str, Any]


def names_of(names: Any, what: str) -> list[str]:
    """List of names. Text would be read letter by letter, so it is refused."""
    if isinstance(names, str):
        raise HardpointError(f"{what} is the text {names!r}; expected a list of names, as in [{names!r}]")
    return list(names)


def rows_of(x: Designs, names: list[str], units: str | Sequence[str] = "") -> tuple[Floats, bool]:
    """Designs as an array (n, k), and true if x was a single design. Tables and mappings are read by column names, without
    or with the unit. `units` is the length unit, or the columns with their units. A masked number is NaN."""
    k = len(names)
    if isinstance(x, Mapping) or hasattr(x, "columns"):
        x = _by_name(x, names, [f"{name}_{units}" for name in names] if isinstance(units, str) else units)
    if isinstance(x, (list, tuple)) and any(isinstance(row, np.ma.MaskedArray) for row in x):
        x = np.ma.stack(x)
    if isinstance(x, np.ma.MaskedArray):
        x = np.ma.filled(x.astype(np.float64), np.nan)
    try:
        array = np.asarray(x)
        if array.dtype.kind not in "biuf" and array.size:
            kind = "complex numbers" if array.dtype.kind == "c" else f"dtype {array.dtype}"
            raise TypeError(kind)
        array = np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise HardpointError(f"x is not an array of real numbers ({error}); expected float64") from None
    if array.ndim not in (1, 2) or array.shape[-1] != k or np.ndim(x) == 0:
        raise HardpointError(f"x has shape {np.shape(x)}; expected ({k},) or (n, {k}), a column for each of {names}")
    return np.atleast_2d(array), array.ndim == 1


def _by_name(table: Any, names: list[str], with_units: Sequence[str]) -> Floats:
    """Columns of these names, side by side."""
    there = set(table.columns if hasattr(table, "columns") else table)
    chosen = [name if name in there else column for name, column in zip(names, with_units, strict=True)]
    missing = [name for name, column in zip(names, chosen, strict=True) if column not in there]
    if missing:
        raise HardpointError(f"x has no column {', '.join(missing)}; expected a column for each of {names}")
    columns = [_numbers(table[column], column) for column in chosen]
    shapes = {column.shape for column in columns}
    if len(shapes) > 1:
        lengths = ", ".join(f"{name} {column.shape}" for name, column in zip(chosen, columns, strict=True))
        raise HardpointError(f"the columns of x have different lengths: {lengths}")
    return np.stack(columns, axis=-1)


def _numbers(column: Any, name: str) -> Floats:
    """Column of a table as real numbers; NaN for a masked one."""
    mask = np.ma.getmaskarray(column) if isinstance(column, np.ma.MaskedArray) else None
    array = np.asarray(column)
    # A column of objects may contain numbers and missing values (None, or NA of pandas).
    missing = [v is None or type(v).__name__ == "NAType" for v in array.flat] if array.dtype.kind == "O" else []
    if missing and all(gone or isinstance(v, (int, float)) for v, gone in zip(array.flat, missing, strict=True)):
        found = [np.nan if gone else float(v) for v, gone in zip(array.flat, missing, strict=True)]
        array = np.array(found).reshape(array.shape)
    if array.dtype.kind not in "biuf" and array.size:
        raise HardpointError(f"column {name} of x does not contain real numbers (dtype {array.dtype}); expected float64")
    if array.ndim > 1:
        raise HardpointError(f"x has {array.shape[-1]} columns named {name}; expected one")
    numbers: Floats = array.astype(np.float64)
    if mask is not None:
        numbers[mask] = np.nan
    return numbers


def _single(read: tuple[Floats, bool]) -> Floats:
    """Single design of an array, with finite numbers."""
    rows, single = read
    if not single:
        raise HardpointError(f"x has shape {rows.shape}; expected ({rows.shape[1]},), one design")
    if not np.isfinite(rows).all():
        raise HardpointError("x has a number that is not finite")
    design: Floats = rows[0]
    return design


class _Constrained:
    """Constraints of [optimise] as functions of variables, for optimisers."""

    _study: Study
    _constraints: _hardpoint.Residuals | None
    variables: list[str]
    on_failure: Literal["nan", "raise"]
    constraint_rows: tuple[str, ...]
    """Constraint and limit of each row (c) of `constraints`; the first `equalities` rows are equalities."""
    equalities: int
    _last: dict[str, tuple[bytes, Floats, Floats]]

    def _constrain(self, constraints: _hardpoint.Residuals | None) -> None:
        self._constraints = constraints
        names, self.equalities = ([], 0) if constraints is None else constraints.constraint_rows
        self.constraint_rows = tuple(names)
        self._last = {}

    def _found(self, kind: Literal["residuals", "constraints"], x: Designs, rows: int) -> tuple[Floats, Floats]:
        """Values and derivatives at x. SciPy requests the two separately, so the function keeps them for the last x."""
        if self._constraints is None:
            raise HardpointError("this function has no constraints; make it with study.function(..., constraints=True)")
        designs, single = rows_of(x, self.variables, self._study.length_unit)
        if not single:
            k = len(self.variables)
            raise HardpointError(f"x has shape {designs.shape}; expected ({k},), one design")
        key = designs.tobytes()
        last = self._last.get(kind)
        if last is None or last[0] != key:
            work = self._constraints.value_and_jacobian if kind == "residuals" else self._constraints.constraints
            found = work(designs[0]) if np.isfinite(designs).all() else "x has a number that is not finite"
            if isinstance(found, str):
                if self.on_failure == "raise":
                    raise HardpointError(found)
                last = key, np.full(rows, np.nan), np.full((rows, len(self.variables)), np.nan)
            else:
                last = key, found[0], found[1]
            self._last[kind] = last
        return last[1].copy(), last[2].copy()

    def constraints(self, x: Designs) -> Floats:
        """Constraints of [optimise] (c,) for one design. A limit is satisfied at 0 or above, an equality at 0. A violation
        of 1 matters in practice: it is a millimetre or a degree, for example."""
        return self._kept(self._found("constraints", x, len(self.constraint_rows))[0])

    def constraint_jacobian(self, x: Designs) -> Floats:
        """Derivatives (c, k) of `constraints` with respect to the variables."""
        return self._kept(self._found("constraints", x, len(self.constraint_rows))[1])

    def _kept(self, rows: Floats) -> Floats:
        """Rows of limits, with the sign that SciPy expects."""
        rows[self.equalities :] *= -1.0
        return rows

    def scipy_constraints(self) -> list[dict[str, Any]]:
        """Constraints in the form for `scipy.optimize.minimize(method="SLSQP", constraints=...)`."""
        parts = [("eq", slice(self.equalities)), ("ineq", slice(self.equalities, None))]
        return [
            {
                "type": kind,
                "fun": lambda x, part=part: self.constraints(x)[part],
                "jac": lambda x, part=part: self.constraint_jacobian(x)[part],
            }
            for kind, part in parts
            if len(self.constraint_rows[part])
        ]


class Function(_Constrained):
    """Curves as a pure function of the design.

    `f(x)` takes offsets (k,) and returns (A, S), or takes (n, k) and returns (n, A, S): A outputs at S stations. A variable
    such as "tie_rod_inner_z" is a coordinate, not an offset. A table with columns of these names can replace x. The methods
    for constraints need a function made with `constraints=True`.
    """

    on_failure: Literal["nan", "raise"] = "nan"

    def __init__(self, study: Study, variables: list[str] | None = None, constraints: bool = False) -> None:
        self._study = study
        self._function = _hardpoint.Function(study._study, variables)
        self.variables: list[str] = self._function.variables
        """Names of the variables (k)."""
        self.bounds: Floats = self._function.bounds
        """Lowest and highest value (k, 2), in the length unit; in degrees for rotations."""
        self.outputs: list[str] = self._function.outputs
        """Column names (A)."""
        self._motion: Mapping[str, Floats] | None = None
        self._constrain(_hardpoint.Residuals(study._study, self.variables) if constraints else None)

    @property
    def motion(self) -> Mapping[str, Floats]:
        """Motion at the stations, each column (S,), as in `Curves.motion`."""
        if self._motion is None:
            from ._study import solve

            self._motion = solve(self._study).motion
        return self._motion

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of outputs and stations, (A, S)."""
        return len(self.outputs), self._function.stations

    def _rows(self, x: Designs) -> tuple[Floats, bool]:
        return rows_of(x, self.variables, self._study.length_unit)

    def __call__(self, x: Designs, threads: int | None = None) -> Floats:
        """Values (A, S) or (n, A, S), in the units of `outputs`; NaN for values that a design does not have."""
        rows, single = self._rows(x)
        values, _ = self._function.values(rows, threads)
        return values[0] if single else values

    def value_and_jacobian(self, x: Designs, threads: int | None = None) -> tuple[Floats, Floats]:
        """Values with their exact derivatives with respect to the variables: (A, S, k) or (n, A, S, k), per length unit or per
        degree."""
        rows, single = self._rows(x)
        values, jacobian, _ = self._function.value_and_jacobian(rows, threads)
        return (values[0], jacobian[0]) if single else (values, jacobian)

    def status(self, x: Designs, threads: int | None = None) -> NDArray[np.uint8]:
        """Code of each design (n,), an index into `hardpoint.STATUS`: "ok" if every station has a pose, "incomplete" if
        some have none, "degenerate" if the design cannot be solved or x is not finite."""
        rows, _ = self._rows(x)
        return self._function.values(rows, threads)[1]

    def study(self, x: Designs) -> Study:
        """Study of the design at x (k,)."""
        from ._study import Study

        return Study(self._function.moved(_single(self._rows(x)).tolist()))

    def __repr__(self) -> str:
        return repr(self._function)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Function, (self._study, self.variables, self._constraints is not None))


class Residuals(_Constrained):
    """Targets of [optimise] as least squares: r(x) (m,) are deviations divided by tolerances. Weights make the misfit the
    root mean square of r. SciPy requests r and its Jacobian separately, so the results for the last x are kept."""

    def __init__(self, study: Study, on_failure: Literal["nan", "raise"] = "nan") -> None:
        if on_failure not in ("nan", "raise"):
            raise HardpointError(f'on_failure is {on_failure!r}; expected "nan" or "raise"')
        self._study = study
        residuals = _hardpoint.Residuals(study._study)
        self._residuals = residuals
        self.on_failure: Literal["nan", "raise"] = on_failure
        """Result for a design without residuals: "nan", so that an optimiser shortens its step, or "raise"."""
        self.variables: list[str] = residuals.variables
        """Names of the variables (k)."""
        self.bounds: Floats = residuals.bounds
        """Lowest and highest offset (k, 2), in the units of `Tuning.x`."""
        self.rows: tuple[str, ...] = tuple(residuals.rows)
        """Column of the target of each residual (m)."""
        self._constrain(residuals)

    def value_and_jacobian(self, x: Designs) -> tuple[Floats, Floats]:
        """Residuals r (m,) with their derivatives (m, k). A design that cannot be solved gives NaN, or raises
        `HardpointError`."""
        return self._found("residuals", x, len(self.rows))

    def __call__(self, x: Designs) -> Floats:
        """Residuals r (m,)."""
        return self.value_and_jacobian(x)[0]

    def jacobian(self, x: Designs) -> Floats:
        """Derivatives (m, k) of the residuals."""
        return self.value_and_jacobian(x)[1]

    def study(self, x: Designs) -> Study:
        """Study of the design at the offsets x (k,)."""
        from ._study import Study

        return Study(self._residuals.moved(_single(rows_of(x, self.variables, self._study.length_unit)).tolist()))

    def __repr__(self) -> str:
        k, m, c = len(self.variables), len(self.rows), len(self.constraint_rows)
        return f"<hardpoint.Residuals {self._study.name!r}: {k} variables -> {m} residuals, {c} constraints>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Residuals, (self._study, self.on_failure))
