"""Studies, and functions that solve one design."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, TypeGuard, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hardpoint
from ._curves import Curves
from ._frame import Frame, html_of
from ._function import Function, Residuals, names_of
from ._hardpoint import HardpointError

if TYPE_CHECKING:
    from ._car import Car, Cases

Overrides = Mapping[str, Any]
Floats = NDArray[np.float64]
_BARE = re.compile("[A-Za-z0-9_-]+")


def _quoted(text: str) -> str:
    """Text in quotes. JSON writes characters above U+FFFF as two escapes, which TOML refuses. So they stay as they are."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml(value: Any) -> str:
    """Value in TOML. Numbers and booleans of JSON are valid TOML."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_quoted(k)} = {_toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, float) and not np.isfinite(value):
        raise HardpointError(f"a value is {value}; expected finite numbers")
    if not isinstance(value, (bool, int, float)):
        raise HardpointError(f"a value is {value!r}; expected text, a number, a truth value, a list or a mapping")
    return json.dumps(value)


def _is_tables(value: Any) -> bool:
    """True for a list of mappings."""
    return isinstance(value, (list, tuple)) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _lines(section: Mapping[str, Any], path: str = "") -> Iterator[str]:
    """Mapping as lines of TOML: a header for each table and a line for each value, so errors have useful positions."""
    tables: list[tuple[str, str, Any]] = []
    for key, value in section.items():
        name = key if _BARE.fullmatch(key) else _quoted(key)
        whole = f"{path}.{name}" if path else name
        if isinstance(value, Mapping):
            tables.append(("[{}]", whole, value))
        elif _is_tables(value):
            tables.extend(("[[{}]]", whole, inner) for inner in value)
        else:
            yield f"{name} = {_toml(value)}"
    for head, whole, inner in tables:
        yield ""
        yield head.format(whole)
        yield from _lines(inner, whole)


def text_of(sections: Mapping[str, Any]) -> str:
    """Sections as TOML."""
    return "\n".join(_lines(sections)).lstrip("\n") + "\n"


def written(overrides: Overrides | None) -> list[str]:
    """Overrides in the form of the program: `motion.rack=5.0`."""
    return [f"{path}={_toml(v)}" for path, v in (overrides or {}).items()]


def _positions(values: ArrayLike, name: str) -> Floats:
    """Coordinates as an array of numbers."""
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise HardpointError(f"{name} is not an array of real numbers (dtype {array.dtype}); expected float64")
    if np.ma.is_masked(values):
        raise HardpointError(f"{name} has masked numbers; expected finite coordinates")
    if name == "design" and array.ndim != 2:
        raise HardpointError(f"design has shape {array.shape}; expected (P, 3), a row for each of points")
    return np.ascontiguousarray(array, dtype=np.float64)


def load(path: str | PathLike[str], overrides: Overrides | None = None) -> Study:
    """Reads the study in a file. `overrides`, such as {"motion.rack": 5.0}, act like the program's `--set`."""
    return Study(_hardpoint.Study.load(path, written(overrides)))


def loads(
    text: str, overrides: Overrides | None = None, *, name: str = "study.toml", directory: str | PathLike[str] | None = None
) -> Study:
    """Reads a study from a text. `directory` contains the files that the study names."""
    study = Study(_hardpoint.Study.loads(text, name, directory))
    return study.replace(overrides) if overrides else study


class Study:
    """Validated study. It is immutable. Two studies are equal if their names and texts are equal. Pickling stores name, text and
    the directory of the files that the text names."""

    __slots__ = ("_study",)

    def __init__(self, study: _hardpoint.Study) -> None:
        if not isinstance(study, _hardpoint.Study):
            raise HardpointError(
                f"Study() does not accept {type(study).__name__}; hp.load(path) reads a file, hp.loads(text) a text, "
                "hp.Study.from_dict(sections) a mapping"
            )
        self._study = study

    @property
    def name(self) -> str:
        """Name from the file name."""
        return self._study.name

    @property
    def text(self) -> str:
        """TOML text with overrides applied and target curves from files written out."""
        return self._study.text

    @property
    def topology(self) -> str:
        """Topology, such as "macpherson"."""
        return self._study.topology

    @property
    def length_unit(self) -> str:
        """Unit of all lengths, in the study and its results."""
        return self._study.length_unit

    @property
    def variables(self) -> list[str]:
        """Names of the default variables: those of [optimise], otherwise of [sweep], otherwise all coordinates, such as
        "tie_rod_inner_dz" for an offset."""
        return self._study.variables

    @property
    def sweep_variables(self) -> list[str]:
        """Names of the variables of [sweep]; empty without [sweep]."""
        return self._study.sweep_variables

    @property
    def motions(self) -> list[str]:
        """Names of the motions in [motions] that have curves."""
        return self._study.motions

    @property
    def points(self) -> list[str]:
        """Names of the P points."""
        return self._study.points

    @property
    def design(self) -> Floats:
        """Copy of the design positions (P, 3), in the study's axes and unit."""
        return self._study.design

    def __getitem__(self, name: str) -> Any:
        """Copy of the position (3,) of a point, or the value of a key such as "motion.rack". Raises KeyError for other names."""
        points = self._study.points
        if name in points:
            return self._study.design[points.index(name)].copy()
        found: Any = self.to_dict()
        for key in name.split("."):
            if not isinstance(found, Mapping) or key not in found:
                raise KeyError(f"{name}: neither a point nor a key of the study; points are {', '.join(points)}")
            found = found[key]
        return found

    def replace(
        self,
        values: Overrides | None = None,
        /,
        *,
        points: Mapping[str, ArrayLike] | None = None,
        design: ArrayLike | None = None,
    ) -> Study:
        """Study with other values, as in {"motion.rack": 5.0}, and with other positions: `points` by name, or the whole
        `design` (P, 3), in the study's axes and unit. If only positions change, the text is usually not read again."""
        study = self._study
        if values:
            study = study.with_overrides(written(values))
        if design is None and points is None:
            return Study(study)
        place = study.design if design is None else _positions(design, "design")
        if points is not None:
            names = study.points
            place = place.copy()
            for name, position in points.items():
                if name not in names:
                    raise HardpointError(f"there is no point {name!r}; points are {', '.join(names)}")
                row = _positions(position, name)
                if row.shape != (3,):
                    raise HardpointError(f"{name} has shape {row.shape}; expected (3,): x, y, z")
                place[names.index(name)] = row
        return Study(study.with_design(place))

    def to_dict(self) -> dict[str, Any]:
        """Sections of the study as nested dicts and lists, for `Study.from_dict`."""
        return tomllib.loads(self.text)

    @classmethod
    def from_dict(cls, sections: Mapping[str, Any], name: str = "study.toml") -> Study:
        """Makes a study from a mapping like that of a TOML reader: {"suspension": {...}, "motion": {...}}."""
        return loads(text_of(sections), name=name)

    def function(self, variables: Sequence[str] | None = None, *, constraints: bool = False) -> Function:
        """Curves as a pure function of the design. `variables` are names such as "tie_rod_inner_dz" for offsets and
        "tie_rod_inner_z" for coordinates. The default is those of [optimise], otherwise of [sweep], otherwise all
        coordinates of all hardpoints. With `constraints`, the function also has the constraints of [optimise], by the same
        variables."""
        return Function(self, None if variables is None else names_of(variables, "variables"), constraints)

    def residuals(self, on_failure: Literal["nan", "raise"] = "nan") -> Residuals:
        """Deviations from the targets of [optimise], divided by their tolerances, as a function of the variables. A
        design without residuals gives NaN, so that an optimiser shortens its step, or raises an exception."""
        return Residuals(self, on_failure)

    def swept(self, number: int) -> Study:
        """Study of one design of [sweep], by its number from 0."""
        return Study(_hardpoint.swept_design(self._study, number))

    def built(self, number: int) -> Study:
        """Study of one build of [tolerance], by its number from 0. Its design is the assembly of the build's parts at rest."""
        return Study(_hardpoint.build(self._study, number))

    def _ipython_key_completions_(self) -> list[str]:
        return self.points

    def _repr_html_(self) -> str:
        """Hardpoints, for notebooks."""
        rows = [[name, *position] for name, position in zip(self.points, self.design.tolist(), strict=True)]
        return html_of(repr(self), ["hardpoint", *(f"{axis}_{self.length_unit}" for axis in "xyz")], rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Study) and self.text == other.text and self.name == other.name

    def __hash__(self) -> int:
        return hash((self.name, self.text))

    def __repr__(self) -> str:
        return repr(self._study)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Study, (self._study,))


def is_car(source: object) -> TypeGuard[Car]:
    """True for a `Car`."""
    from ._car import Car

    return isinstance(source, Car)


def study_of(source: Study | Car | str | PathLike[str]) -> Study:
    """Returns a study as it is, or reads the study in a file."""
    if isinstance(source, Study):
        return source
    if isinstance(source, (str, PathLike)):
        return load(source)
    if is_car(source):
        raise HardpointError("this call needs the study of a suspension; a Car contains two: car.front and car.rear")
    raise HardpointError(f"expected a Study or the path of a study file, found {type(source).__name__}")


@overload
def solve(study: Study | str | PathLike[str], *, motion: str | None = None, threads: int | None = None) -> Curves: ...
@overload
def solve(study: Car, *, threads: int | None = None) -> Cases: ...
def solve(
    study: Study | Car | str | PathLike[str], *, motion: str | None = None, threads: int | None = None
) -> Curves | Cases:
    """Solves the curves of the study's design over its motion; for an axle, of both wheels. Results equal those of
    `hardpoint solve` bit for bit. `motion` names one of [motions]. A `Car` gives its load cases. One design uses one
    CPU thread, so more `threads` do not save time. The parameter exists because other calls have it, too."""
    if is_car(study):
        if motion is not None:
            raise HardpointError("a car has load cases and no motions; leave out motion")
        return study.solve()
    study = study_of(study)
    return Curves(_hardpoint.solve(study._study, motion, threads), study, motion)


@dataclass(frozen=True)
class End:
    """End of a range."""

    value: float
    """Value of the limit. The name of the range ends with the unit of this value. If the name has no unit, the value is a length
    in the study's unit. NaN for an unknown or missing limit."""
    cause: str
    """Reason for the limit."""
    build: int | None = None
    """Number of the build with this limit; None for the nominal design, and if no build has limits."""


@dataclass(frozen=True)
class Extent:
    """Range of a motion from the design position."""

    low: End
    high: End


class Limits(Mapping[str, Extent | None]):
    """Ranges of motions by name: `travel`, `rack` and `arm_angle_deg` for a wheel; `left_travel`, `right_travel`, `rack`
    and `roll_deg` for an axle; `heave` and `travel_difference` for a solid axle. None if the study has no such motion. With
    `[compliance]` they end where there is no equilibrium, and loads have ranges, too (`lateral_N`). Further rows of a quantity
    name the held positions: `limits["travel, rack 10"]`. Ranges are also attributes: `limits.travel.low.value`."""

    rejected: int | None
    """Number of builds that cannot be assembled, cannot move or have no equilibrium; None for the nominal design."""

    def __init__(self, found: Mapping[str, Any], rejected: int | None = None) -> None:
        ends = {name: both and Extent(*(End(*end) for end in both)) for name, both in found.items()}
        self._ends: dict[str, Extent | None] = ends
        self.rejected = rejected

    def __getitem__(self, name: str) -> Extent | None:
        return self._ends[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._ends)

    def __len__(self) -> int:
        return len(self._ends)

    def __getattr__(self, name: str) -> Extent:
        if name.startswith("_"):  # A copy asks for such names before its ranges exist.
            raise AttributeError(name)
        if self._ends.get(name) is None:
            raise AttributeError(f"there is no range {name!r}; there are {', '.join(self)}")
        return cast(Extent, self._ends[name])

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._ends]

    def __repr__(self) -> str:
        ranges = [f"{n} {e.low.value:.6g} to {e.high.value:.6g}" for n, e in self._ends.items() if e]
        return f"<hardpoint.Limits: {'; '.join(ranges)}>"

    def _repr_html_(self) -> str:
        """Row for each end, for notebooks."""
        rows = [
            [name, end.value, end.cause, "" if end.build is None else end.build]
            for name, extent in self._ends.items()
            for end in ((extent.low, extent.high) if extent else ())
        ]
        return html_of("hardpoint.Limits", ["quantity", "limit", "cause", "build"], rows)


@overload
def limits(
    study: Study | str | PathLike[str],
    builds: int | None = None,
    *,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Limits: ...
@overload
def limits(study: Car) -> Frame: ...
def limits(
    study: Study | Car | str | PathLike[str],
    builds: int | None = None,
    *,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Limits | Frame:
    """Limits of travel, rack and arm, with their reasons. `builds` gives the closest limits of the first builds of
    [tolerance], each with the number of its build. `progress(done, all)` is called about twenty times a second.

    For a `Car` the result is a frame: the acceleration at which the first wheel lifts, and the end of equilibrium, by
    direction and case."""
    if is_car(study):
        if builds is not None:
            raise HardpointError("limits of builds are not available for a car; leave out builds")
        return Frame(_hardpoint.parse_table(_hardpoint.car_limits(study._car)))
    study = study_of(study)
    if builds is None:
        return Limits(_hardpoint.limits(study._study))
    return Limits(*_hardpoint.limits_of_builds(study._study, builds, threads, progress))


def check(study: Study | Car | str | PathLike[str]) -> list[str]:
    """Solves the study like `hardpoint check`. Returns a line for each warning and remark, and for each part of the motion
    without a pose. A line for a missing pose begins with "not solved" (for a named motion "motion NAME: not solved"). For
    a `Car` it solves the position at rest. A wrong study raises an error when it is loaded."""
    if is_car(study):
        remarks, failures = _hardpoint.car_check(study._car)
        return [*remarks, *(f"not solved: {failure}" for failure in failures)]
    remarks, failures = _hardpoint.check(study_of(study)._study)
    return [*remarks, *failures]
