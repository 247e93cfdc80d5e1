"""Studies, and what is asked of one design."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hardpoint
from ._curves import Curves
from ._function import Function, Residuals
from ._hardpoint import HardpointError

Overrides = Mapping[str, Any]
Floats = NDArray[np.float64]


def _toml(value: Any) -> str:
    """A value in TOML: JSON's strings, numbers, lists and booleans are TOML's."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(k)} = {_toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        raise HardpointError(f"a value is {value}; expected finite numbers")
    if not isinstance(value, (str, bool, int, float)):
        raise HardpointError(f"a value is {value!r}; expected text, a number, a truth value, a list or a mapping")
    return json.dumps(value)


def _written(overrides: Overrides | None) -> list[str]:
    """Overrides as the program writes them: `motion.rack=5.0`."""
    return [f"{path}={_toml(v)}" for path, v in (overrides or {}).items()]


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
    def variables(self) -> list[str]:
        """Names of what moves by default: in [optimise], else in [sweep], else every coordinate, such as
        "tie_rod_inner_dz" for an offset."""
        return self._study.variables

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

    @classmethod
    def from_dict(cls, sections: Mapping[str, Any], name: str = "study.toml") -> Study:
        """The study of a mapping as a TOML reader would give it: {"suspension": {...}, "motion": {...}}."""
        return loads("".join(f"{key} = {_toml(value)}\n" for key, value in sections.items()), name=name)

    def function(self, variables: Sequence[str] | None = None) -> Function:
        """The curves as a pure function of the design: by `variables` such as "tie_rod_inner_dz" for offsets,
        "tie_rod_inner_z" for coordinates; by default those of [optimise], else of [sweep], else every coordinate of
        every hardpoint."""
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


def solve(study: Study) -> Curves:
    """The curves of the study's design over its motion, of both wheels where it is of an axle; the numbers of
    `hardpoint solve`, to the bit."""
    return Curves(_hardpoint.solve(study._study))


def limits(study: Study) -> dict[str, Any]:
    """How far travel, rack and arm go: for each ((value, cause), (value, cause)), the lower end first; None where there
    is nothing to move."""
    return _hardpoint.limits(study._study)


def check(study: Study) -> list[str]:
    """Solves the design position; what is doubtful about it, in words. A study that is wrong was refused before."""
    return _hardpoint.check(study._study)
