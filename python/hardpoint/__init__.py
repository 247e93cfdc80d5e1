"""Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints.

Units are those of the column names (degrees, the study's length unit), axes the study's. Arrays are float64 in C
order. NaN is "no value", never an exception in a batch; a study that is wrong raises `StudyError`, with `line`,
`column`, `key` and `help`.

>>> import hardpoint as hp
>>> study = hp.loads(hp.template("macpherson"))
>>> curves = hp.solve(study)
>>> curves["camber_deg"].shape == curves.drive.shape
True
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hardpoint
from ._hardpoint import HardpointError, StudyError, __version__, template, topologies

__all__ = [
    "Column",
    "Curves",
    "Function",
    "HardpointError",
    "Residuals",
    "Study",
    "StudyError",
    "Sweep",
    "Tuning",
    "__version__",
    "check",
    "limits",
    "load",
    "loads",
    "optimise",
    "run",
    "solve",
    "sweep",
    "template",
    "topologies",
]

Overrides = Mapping[str, Any]
Floats = NDArray[np.float64]


def _written(overrides: Overrides | None) -> list[str]:
    """Overrides as the program writes them: `motion.rack=5.0`. JSON's strings, numbers, lists and booleans are TOML's."""

    def value(v: Any) -> str:
        if isinstance(v, Mapping):
            return "{" + ", ".join(f"{k} = {value(x)}" for k, x in v.items()) + "}"
        if isinstance(v, (list, tuple, np.ndarray)):
            return "[" + ", ".join(value(x) for x in v) + "]"
        if isinstance(v, np.generic):
            v = v.item()
        if isinstance(v, float) and not np.isfinite(v):
            raise HardpointError(f"an override is {v}; expected finite numbers")
        return json.dumps(v)

    return [f"{path}={value(v)}" for path, v in (overrides or {}).items()]


def load(path: str | PathLike[str], overrides: Overrides | None = None) -> Study:
    """The study in a file; `overrides` such as {"motion.rack": 5.0} as the program's `--set`."""
    return Study(_hardpoint.Study.load(path, _written(overrides)))


def loads(
    text: str, overrides: Overrides | None = None, *, name: str = "study.toml", directory: str | PathLike[str] | None = None
) -> Study:
    """The study of a text; `directory` is where the files that it names are."""
    study = Study(_hardpoint.Study.loads(text, name, directory))
    return study.replace(set=overrides) if overrides else study


class Study:
    """A study, validated: immutable, hashable by its text, pickled as it."""

    __slots__ = ("_study",)

    def __init__(self, study: _hardpoint.Study) -> None:
        self._study = study

    @property
    def name(self) -> str:
        """The name, from the file's."""
        return self._study.name

    @property
    def text(self) -> str:
        """The TOML text, with overrides applied and target curves from files written out."""
        return self._study.text

    @property
    def topology(self) -> str:
        """Such as "macpherson"."""
        return self._study.topology

    @property
    def length_unit(self) -> str:
        """The unit of every length, of the study and its results."""
        return self._study.length_unit

    @property
    def points(self) -> list[str]:
        """Names of the P points."""
        return self._study.points

    @property
    def design(self) -> Floats:
        """Design positions (P, 3) in the study's axes and unit: a copy."""
        return self._study.design

    def replace(self, design: ArrayLike | None = None, set: Overrides | None = None) -> Study:
        """The study with other design positions (P, 3), or with fields overridden."""
        study = self._study
        if set:
            study = study.with_overrides(_written(set))
        if design is not None:
            study = study.with_design(np.ascontiguousarray(design, dtype=np.float64).reshape(-1, 3))
        return Study(study)

    def function(self, variables: Sequence[str] | None = None) -> Function:
        """The curves as a pure function of the design: by `variables` such as "tie_rod_inner_dz"; by default those of
        [optimise], else of [sweep], else every coordinate of every hardpoint."""
        return Function(_hardpoint.Function(self._study, None if variables is None else list(variables)))

    @property
    def residuals(self) -> Residuals:
        """The targets of [optimise] as a function of its variables, in tolerances."""
        return Residuals(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Study) and self.text == other.text and self.name == other.name

    def __hash__(self) -> int:
        return hash((self.name, self.text))

    def __repr__(self) -> str:
        return repr(self._study)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Study, (self._study,))


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
        self.drive: Floats = found["drive"]
        """Drive value of each station (S,): travel in the length unit, angles in degrees."""
        self.travel: Floats = found["travel"]
        """Wheel travel (S,), also where another drive is used."""
        self.rack: Floats = found["rack"]
        """Rack displacement (S,)."""
        self.status: list[str] = found["status"]
        """What came of each station: "ok", "unreachable", ..."""
        self.sensitivities: Floats | None = found["sensitivities"]
        """Derivatives (S, C, P, 3) by the hardpoints that the study names, in the column's unit per length unit."""
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


def solve(study: Study) -> Curves:
    """The curves of the study's design over its motion; the numbers of `hardpoint solve`, to the bit."""
    return Curves(_hardpoint.solve(study._study))


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
        """Lowest and highest value (k, 2), in the length unit."""
        self.outputs: list[str] = function.outputs
        """Column names (A)."""
        self.stations: Floats = function.stations
        """Drive value and rack displacement (S, 2)."""

    def _rows(self, x: ArrayLike) -> tuple[Floats, bool]:
        array = np.ascontiguousarray(x, dtype=np.float64)
        if array.ndim not in (1, 2) or array.shape[-1] != len(self.variables):
            k = len(self.variables)
            raise HardpointError(f"x has shape {array.shape}; expected ({k},) or (n, {k}), a column for each of variables")
        return np.atleast_2d(array), array.ndim == 1

    def __call__(self, x: ArrayLike, threads: int | None = None) -> Floats:
        """Values (A, S) or (n, A, S); NaN where a design has none."""
        rows, single = self._rows(x)
        values, _ = self._function.values(rows, threads)
        return values[0] if single else values

    def value_and_jacobian(self, x: ArrayLike, threads: int | None = None) -> tuple[Floats, Floats]:
        """Values, and their exact derivatives by the variables: (A, S, k) or (n, A, S, k)."""
        rows, single = self._rows(x)
        values, jacobian, _ = self._function.value_and_jacobian(rows, threads)
        return (values[0], jacobian[0]) if single else (values, jacobian)

    def status(self, x: ArrayLike, threads: int | None = None) -> NDArray[np.uint8]:
        """What came of each design (n,), a place in `words`."""
        rows, _ = self._rows(x)
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


class Sweep(Mapping[str, Floats]):
    """Rows of a sweep: a mapping from the columns of `designs.csv` to arrays (n,)."""

    def __init__(self, found: dict[str, Any]) -> None:
        self._columns: dict[str, Floats] = found["columns"]
        self.failed: NDArray[np.int64] = found["failed"]
        """Numbers of the designs that were not solved at every station."""
        self.reasons: list[str] = found["reasons"]
        """Why, one for each of them."""

    def __getitem__(self, name: str) -> Floats:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def to_pandas(self) -> Any:
        """A pandas DataFrame that shares the columns' memory."""
        import pandas

        return pandas.DataFrame(self._columns, copy=False)

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """The columns for whoever speaks Arrow (polars, DuckDB, pyarrow); takes pyarrow."""
        import pyarrow

        return pyarrow.table(dict(self._columns)).__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<hardpoint.Sweep: {rows} designs, {len(self.failed)} failed; {len(self)} columns>"


def sweep(study: Study, threads: int | None = None) -> Sweep:
    """The designs of the study's [sweep], in arrays; the numbers of `hardpoint sweep`, to the bit. Ctrl-C is heard."""
    return Sweep(_hardpoint.sweep(study._study, threads))


def limits(study: Study) -> dict[str, Any]:
    """How far travel, rack and arm go: for each ((value, cause), (value, cause)), the lower end first; None where there
    is nothing to move."""
    return _hardpoint.limits(study._study)


def check(study: Study) -> list[str]:
    """Solves the design position; what is doubtful about it, in words. A study that is wrong was refused before."""
    return _hardpoint.check(study._study)


def run(arguments: Sequence[str | PathLike[str]]) -> int:
    """Runs a command of the program in this process, as in run(["report", "out/front"]), printing as it does; its exit
    code: 0 done, 1 something could not be solved, 2 wrong input."""
    return _hardpoint.command([str(a) for a in arguments])


def _main() -> None:
    """The program `hardpoint`, installed with the module."""
    import sys

    sys.exit(_hardpoint.command(sys.argv[1:], is_program=True))
