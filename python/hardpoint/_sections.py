"""Vehicles from numbers: studies without TOML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict

from numpy.typing import ArrayLike

from ._function import names_of
from ._hardpoint import HardpointError
from ._study import Study

Side = Literal["left", "right"]
Axis = Literal["x", "y", "z"]
Numbers = float | ArrayLike
"""A number or an array of numbers."""
Member = str | Sequence[str]
"""The name of a member such as "tie_rod", or its two ends."""


class Variable(TypedDict, total=False):
    """Variable of [optimise], as in `Variable(hardpoint="tie_rod_inner", axis="z", range=(-5.0, 5.0))`. It is a dict with
    the keys of the study, which docs/study.md explains."""

    hardpoint: str
    hardpoints: Sequence[str]
    rigid: Sequence[str]
    bushing: str
    stiffness: Literal["x", "y", "z", "tx", "ty", "tz"]
    link: str
    rate: Literal["spring", "anti_roll_bar", "rack", "column"]
    relative: bool
    factors: ArrayLike
    axis: Axis
    direction: ArrayLike
    range: ArrayLike
    shift: float
    turn: float
    cost: float


class SweepVariable(TypedDict, total=False):
    """Variable of [sweep]."""

    hardpoint: str
    hardpoints: Sequence[str]
    bushing: str
    stiffness: Literal["x", "y", "z", "tx", "ty", "tz"]
    link: str
    rate: Literal["spring", "anti_roll_bar", "rack", "column"]
    relative: bool
    factors: ArrayLike
    axis: Axis
    range: ArrayLike
    steps: int
    absolute: bool
    name: str


class Target(TypedDict, total=False):
    """Target of [optimise], as in `Target(characteristic="toe", points=curve, tolerance=0.01)`."""

    characteristic: str
    point: str
    axis: Axis
    length: Member
    load: str
    figure: str
    points: ArrayLike
    file: str
    column: str
    at: float
    value: float
    between: Any
    at_least: Numbers
    at_most: Numbers
    over: str
    side: Side
    roll: Numbers
    heave: Numbers
    travel_left: Numbers
    travel_right: Numbers
    steering_wheel_angle: Numbers
    rack: Numbers
    motion: str
    tolerance: float
    weight: float
    interpolation: Literal["monotone_cubic", "linear"]


class Constraint(TypedDict, total=False):
    """Constraint of [optimise], as in `Constraint(length="tie_rod", between=(345.0, 375.0))`."""

    name: str
    length: Member
    point: str
    members: Sequence[str]
    articulation: str
    plunge: Member
    characteristic: str
    load: str
    coplanar: Sequence[str]
    line: Sequence[str]
    between: ArrayLike
    at_least: float
    at_most: float
    kept: bool
    inside: Mapping[str, Any]
    outside: Mapping[str, Any]
    clearance: float
    radii: ArrayLike
    motion: str
    side: Side
    rack: Numbers
    at: Literal["design"]


class Scatter(TypedDict, total=False):
    """Parts of [tolerance] that scatter, as in `Scatter(hardpoint="tie_rod_inner", sigma=0.5)`."""

    hardpoint: str
    hardpoints: Sequence[str]
    length: Member
    jig: Sequence[str]
    bushing: str
    stiffness: Literal["x", "y", "z", "tx", "ty", "tz"]
    link: str
    rate: Literal["spring", "anti_roll_bar", "rack", "column"]
    relative: bool
    side: Side
    axis: Axis
    sigma: float
    limits: ArrayLike
    shift: float
    turn: float


class Band(TypedDict, total=False):
    """Limits of [tolerance] for the yield, as in `Band(characteristic="toe", at=0.0, between=(-0.1, 0.1))`."""

    characteristic: str
    at: float
    over: str
    side: Side
    motion: str
    roll: Numbers
    heave: Numbers
    travel_left: Numbers
    travel_right: Numbers
    steering_wheel_angle: Numbers
    rack: Numbers
    between: ArrayLike
    at_least: float
    at_most: float


class Adjustment(TypedDict, total=False):
    """Adjustment of [setup], as in `Adjustment(length="tie_rod", per_turn=1.5)`."""

    length: Member
    shim: str
    axis: Axis
    per_turn: float
    step: float
    side: Side


def vehicle(
    topology: str,
    points: Mapping[str, ArrayLike],
    motion: Mapping[str, Any],
    outputs: Sequence[str] | Mapping[str, Any] | None = None,
    *,
    side: Side = "left",
    length_unit: Literal["mm", "m", "in"] = "mm",
    frame: Literal["iso8855", "sae_j670", "x_rear"] = "iso8855",
    right: Literal["mirrored"] | Mapping[str, ArrayLike] | None = None,
    name: str = "study.toml",
    **sections: Any,
) -> Study:
    """Makes a study from numbers, without TOML.

    `points` are the hardpoints of the topology. `motion` is a mapping, as in `{"travel": numpy.linspace(-80, 80, 41)}`.
    `outputs` are names of characteristics, or the section [outputs]. `right` makes the study an axle: "mirrored", or the
    points of the right wheel that differ from mirror images, with their actual y. Give other sections by name, as in
    `wheel={"radius": 300.0}` or `optimise={"variables": [Variable(...)], "targets": [Target(...)]}`. docs/study.md explains
    the sections.

    Raises `StudyError` if the study is wrong. `study.text` is the TOML of a correct study.
    """
    suspension: dict[str, Any] = {"topology": topology, "side": side, "length_unit": length_unit, "frame": frame}
    more = sections.pop("suspension", {})
    if not isinstance(more, Mapping):
        raise HardpointError(f"suspension is {more!r}; expected a mapping, such as {{'bodies': {{...}}}}")
    made: dict[str, Any] = {"suspension": {**suspension, **more, "hardpoints": points}, "motion": motion}
    if outputs is not None:
        made["outputs"] = outputs if isinstance(outputs, Mapping) else {"characteristics": names_of(outputs, "outputs")}
    if right is not None:
        if isinstance(right, str) and right != "mirrored":
            raise HardpointError(f'right is {right!r}; expected "mirrored", or the points of the right wheel')
        if "axle" in sections:
            raise HardpointError("axle and right both describe the right wheel; leave out right and give axle.right")
        made["axle"] = {"right": right if isinstance(right, str) else {"hardpoints": right}}
    return Study.from_dict({**made, **sections}, name=name)
