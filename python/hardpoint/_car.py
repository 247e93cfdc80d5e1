"""Cars: load cases, sweeps, tunings and derivatives."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._frame import Column, Frame
from ._function import names_of
from ._study import Overrides, Study, study_of, text_of, written
from ._sweep import Sweep
from ._tuning import effect_row

Floats = NDArray[np.float64]


class Cases(Frame):
    """Results of load cases: the columns of `cases.csv`, with a row for each case."""

    cases: tuple[str, ...]
    """Names of the cases, `static` first."""

    def __init__(self, found: dict[str, Any], cases: tuple[str, ...]) -> None:
        super().__init__(
            found["columns"],
            info={name: Column(name, *info) for name, info in found["info"].items()},
            status=found["status"],
            reasons=found["reasons"],
        )
        self.cases = cases

    def of(self, case: str) -> dict[str, float]:
        """Results of one case, by column. Raises ValueError if there is no such case."""
        row = self.cases.index(case)
        return {name: float(values[row]) for name, values in self.items()}

    def __repr__(self) -> str:
        solved = int(np.count_nonzero(self.status == 0))
        return f"<hardpoint.Cases: {solved} of {self.rows} cases ok; {', '.join(self.cases)}>"


@dataclass(frozen=True, eq=False)
class CarTuning:
    """Result of a tuning of a car. Names follow SciPy's OptimizeResult if it has the same quantity."""

    x: Floats
    """Values of the variables (k): offsets of hardpoints, values of rates and parameters of the car."""
    success: bool
    """True if the tuning ended at a minimum, all constraints are satisfied, and no target is missed for lack of a variable."""
    message: str
    """Outcome in words."""
    misfit: float
    """Root of the weighted mean of squared deviations. Each deviation is divided by its tolerance."""
    variables: tuple[str, ...]
    """Columns of the variables (k)."""
    targets: Frame
    """A row for each target: output, case, tolerance, deviation of the tuned car divided by the tolerance, target value, and
    values before and after."""
    side_effects: Frame
    """Changes of quantities that have no target. Changes beyond a customary tolerance come first. Columns: output, unit,
    before_min, before_max, after_min, after_max, largest_change, case, wheel, at, tolerance, flagged, lost. Empty with
    side_effects = false in [optimise]."""
    studies: dict[str, str]
    """Texts of the tuned studies by file name: optimised.toml, optimised_front.toml, optimised_rear.toml."""

    def save(self, directory: str | PathLike[str]) -> Path:
        """Writes the three studies into a directory. Returns the path of the car's study."""
        place = Path(directory)
        place.mkdir(parents=True, exist_ok=True)
        for name, text in self.studies.items():
            (place / name).write_text(text, encoding="utf-8", newline="")
        return place / "optimised.toml"

    def __repr__(self) -> str:
        return f"<hardpoint.CarTuning: {'success' if self.success else 'NO SUCCESS'}: {self.message}>"


class Car:
    """Validated study of a car. It is immutable. Pickling stores its text and the texts of both axles."""

    __slots__ = ("_car",)

    def __init__(self, path: str | PathLike[str], overrides: Overrides | None = None) -> None:
        """Reads the car of a file with [car], which names the files of both axles. `overrides`, such as {"car.wheelbase":
        2700.0, "front.spring.rate": 32.0}, act like the program's `--set`; "front." and "rear." begin keys of the axles."""
        self._car = _hardpoint.Car.load(path, written(overrides))

    @classmethod
    def of(
        cls,
        front: Study | str | PathLike[str],
        rear: Study | str | PathLike[str],
        car: Mapping[str, Any],
        cases: Sequence[Mapping[str, Any]] = (),
        outputs: Sequence[str] | Mapping[str, Any] | None = None,
        *,
        name: str = "car",
        **sections: Any,
    ) -> Car:
        """Makes a car from two axles and numbers, without TOML. `car` is the section [car] without file names, as in
        {"wheelbase": 2650.0, "mass": 1500.0, "cg": [-1290.0, 0.0, 550.0]}. `cases` are mappings, as in {"name": "turn",
        "ay": 0.8}. `outputs` are names of results, or the section [outputs]. Give other sections by name, as in
        `optimise={"variables": [...], "targets": [...]}`; docs/car.md explains them."""
        own: dict[str, Any] = {"car": {"front": "front.toml", "rear": "rear.toml", **car}}
        if cases:
            own["cases"] = list(cases)
        if outputs is not None:
            own["outputs"] = outputs if isinstance(outputs, Mapping) else {"characteristics": names_of(outputs, "outputs")}
        axles = study_of(front)._study, study_of(rear)._study
        return _restored(_hardpoint.Car.of(name, text_of({**own, **sections}), *axles))

    @property
    def text(self) -> str:
        """TOML text with overrides applied."""
        return self._car.text

    @property
    def front(self) -> Study:
        """Study of the front axle."""
        return Study(self._car.axles[0])

    @property
    def rear(self) -> Study:
        """Study of the rear axle."""
        return Study(self._car.axles[1])

    @property
    def name(self) -> str:
        """Name from the file name."""
        return self._car.name

    @property
    def length_unit(self) -> str:
        """Unit of all lengths."""
        return self._car.length_unit

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of the load cases, `static` first."""
        return tuple(self._car.cases)

    @property
    def results(self) -> tuple[str, ...]:
        """Columns of the results in the study's outputs."""
        return tuple(self._car.results)

    @property
    def variables(self) -> tuple[str, ...]:
        """Columns of the variables of [optimise], otherwise of [sweep]."""
        return tuple(self._car.variables)

    def solve(self) -> Cases:
        """Results of all load cases, equal bit for bit to those of `hardpoint solve`. A case without equilibrium has NaN, a
        status and a reason."""
        return Cases(_hardpoint.car_solve(self._car), self.cases)

    def derivatives(self) -> Floats:
        """Exact derivatives (cases, results, variables) of `results` by `variables`, in the units of both columns. NaN if a
        result is not defined in a case."""
        found: Floats = _hardpoint.car_derivatives(self._car)
        return found

    def sweep(
        self, *, threads: int | None = None, progress: Callable[[int, int], object] | None = None
    ) -> Sweep:
        """Solves the designs of the study's [sweep]. Results equal those of `hardpoint sweep` bit for bit. `progress(done,
        all)` is called about twenty times a second."""
        found = _hardpoint.car_sweep(self._car, threads, progress)
        return Sweep(found["columns"], found)

    def optimise(self, *, threads: int | None = None) -> CarTuning:
        """Tunes the car as the study's [optimise] requests. Results equal those of `hardpoint optimise`."""
        found = _hardpoint.car_optimise(self._car, threads)
        names = ("optimised.toml", "optimised_front.toml", "optimised_rear.toml")
        return CarTuning(
            x=found["x"],
            success=found["success"],
            message=found["message"],
            misfit=found["misfit"],
            variables=self.variables,
            targets=Frame.of_records(json.loads(found["targets"])),
            side_effects=Frame.of_records(map(_effect, json.loads(found["side_effects"]))),
            studies=dict(zip(names, found["studies"], strict=True)),
        )

    def __repr__(self) -> str:
        return f"<hardpoint.Car {self.name!r}: {len(self.cases)} cases>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (_restored, (self._car,))


def _effect(record: dict[str, Any]) -> dict[str, Any]:
    """Row of `CarTuning.side_effects`."""
    return {"case": "", **effect_row(record)}


def _restored(car: _hardpoint.Car) -> Car:
    made = Car.__new__(Car)
    made._car = car
    return made
