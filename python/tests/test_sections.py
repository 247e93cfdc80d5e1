"""Vehicles from numbers, without TOML."""

import typing

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES

KINDS = [
    (hp.Variable, ("optimise", "variables")),
    (hp.Target, ("optimise", "targets")),
    (hp.Constraint, ("optimise", "constraints")),
    (hp.Scatter, ("tolerance", "scatter")),
    (hp.Band, ("tolerance", "bands")),
    (hp.Adjustment, ("setup", "adjust")),
    (hp.SweepVariable, ("sweep", "variables")),
]


@pytest.mark.parametrize("kind, path", KINDS, ids=[kind.__name__ for kind, _ in KINDS])
def test_constructors_have_the_keys_of_the_schema(kind, path):
    section, key = path
    schema = hp.schema()["anyOf"][0]["properties"][section]["properties"][key]["items"]["properties"]
    # The keys `case` and `axle` belong to cars. The study of a wheel or an axle refuses these keys by name.
    of_cars = {"case", "axle"} if section == "optimise" and key != "variables" else set()
    assert set(typing.get_type_hints(kind)) - of_cars == set(schema) - of_cars


def made(study, **changes):
    """Makes a study again from its own numbers."""
    sections = {**study.to_dict(), **changes}
    suspension = sections.pop("suspension")
    points, topology = suspension.pop("hardpoints"), suspension.pop("topology")
    motion, axle = sections.pop("motion"), sections.pop("axle", None)
    keys = {k: suspension.pop(k) for k in ("side", "length_unit", "frame") if k in suspension}
    right = axle["right"] if axle else None
    if isinstance(right, dict):
        right = right["hardpoints"]
    return hp.vehicle(topology, points, motion, right=right, suspension=suspension, **keys, **sections)


@pytest.mark.parametrize("name", ["macpherson_front", "macpherson_axle", "double_wishbone_solve", "five_link_solve"])
def test_a_vehicle_of_the_numbers_of_a_study_is_that_study(name):
    study = hp.load(STUDIES / f"{name}.toml")
    again = made(study)
    # A study that is made from numbers states the default keys explicitly.
    expected = study.to_dict()
    expected["suspension"] = {"side": "left", "length_unit": "mm", "frame": "iso8855", **expected["suspension"]}
    assert again.to_dict() == expected
    curves, expected = hp.solve(again), hp.solve(study)
    for column in expected:
        np.testing.assert_array_equal(curves[column], expected[column])


def test_arrays_are_taken_and_errors_have_their_place(front):
    points = {name: front[name] for name in front.points}
    travel = np.linspace(-20.0, 20.0, 5)
    study = hp.vehicle("macpherson", points, {"travel": travel}, ["camber", "toe"], wheel={"radius": np.float64(300.0)})
    np.testing.assert_array_equal(hp.solve(study).drive, travel)
    assert hp.solve(study).outputs == ("camber_deg", "toe_deg")
    with pytest.raises(hp.StudyError) as wrong:
        hp.vehicle("macpherson", {**points, "tie_rod_iner": [0.0, 0.0, 0.0]}, {"travel": travel})
    assert "tie_rod_iner" in str(wrong.value) and wrong.value.line > 1
    with pytest.raises(hp.StudyError, match="tolerence"):
        optimise = {"variables": [hp.Variable(hardpoint="tie_rod_inner", axis="z", range=(-5.0, 5.0))]}
        optimise["targets"] = [{"characteristic": "toe", "at": 0.0, "value": 0.0, "tolerence": 0.1}]
        hp.vehicle("macpherson", points, {"travel": travel}, ["toe"], optimise=optimise)
    with pytest.raises(hp.HardpointError, match="suspension"):
        hp.vehicle("macpherson", points, {"travel": travel}, suspension=3)


def test_a_mapping_is_readable_text():
    study = hp.load(STUDIES / "macpherson_steering.toml")
    text = hp.Study.from_dict(study.to_dict()).text
    assert "[suspension.hardpoints]\n" in text and text.count("[[optimise.constraints]]") == 3
