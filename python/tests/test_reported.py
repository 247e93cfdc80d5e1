"""Columns, statuses and arguments that were once read wrongly or ignored."""

import copy
import pickle

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES

ELASTIC = {"motion.travel": [-20.0, 0.0, 20.0]}
SWEPT = {"method": "sobol", "samples": 4, "seed": 1, "variables": [{"rate": "spring", "range": [20.0, 40.0]}]}


def elastic():
    study = hp.load(STUDIES / "macpherson_compliance.toml", ELASTIC)
    return study, hp.Study.from_dict({**study.to_dict(), "sweep": SWEPT})


def test_given_rates_are_solved():
    study, swept = elastic()
    rows = hp.sweep(swept, [[20.0], [40.0], [-5.0]], threads=1)
    assert list(rows)[0] == "spring_rate_N_per_mm"
    for row, rate in enumerate((20.0, 40.0)):
        camber = hp.solve(study.replace({"spring.rate": rate}))["camber_deg"]
        assert rows["camber_min_deg"][row] == pytest.approx(camber.min(), abs=1e-9)
    assert rows.failed.tolist() == [2] and "above 0" in rows.reasons[2]
    again = hp.sweep(swept, hp.sweep(swept, threads=1), threads=1)
    np.testing.assert_array_equal(again["camber_min_deg"], hp.sweep(swept, threads=1)["camber_min_deg"])


def test_elastic_rows_that_are_not_finite_have_a_status():
    study, _ = elastic()
    names = ["tie_rod_inner_dz", "tie_rod_inner_dy"]
    rows = hp.sweep(study, [[np.nan, 0.0], [0.1, 0.1]], variables=names, threads=1)
    assert [hp.STATUS[code] for code in rows.status] == ["not_finite", "ok"]
    assert hp.sweep(study, np.zeros((0, 2)), variables=names, threads=1).rows == 0


def test_status_of_tables_that_are_read(tmp_path):
    study = hp.load(STUDIES / "macpherson_sweep.toml", {"motion.travel": [-20.0, 0.0, 20.0], "sweep.curves": True})
    rows = hp.sweep(study, [[0, 0, 0, 0], [1e6, 0, 0, 0]], threads=1)
    assert rows.failed.tolist() == [1] and rows.curves.failed.tolist() == [3, 4, 5]
    rows.save(tmp_path / "run")
    read = hp.read_run(tmp_path / "run")["designs"]
    assert read.failed.tolist() == [1] and read.reasons == rows.reasons


def test_a_car_without_variables_has_no_derivatives():
    car = hp.Car(STUDIES / "off_road_car.toml")
    assert car.derivatives().shape == (len(car.cases), len(car.results), 0)


def test_limits_are_copied_and_pickled():
    limits = hp.limits(STUDIES / "macpherson_front.toml")
    for made in copy.copy(limits), copy.deepcopy(limits), pickle.loads(pickle.dumps(limits)):
        assert made.travel == limits.travel


def test_units_of_swept_columns():
    rows = hp.sweep(STUDIES / "double_wishbone_monoshock.toml", [[0.1]], variables=["tie_rod_inner_dz"], threads=1)
    info = rows.info["t_bar_torque_min_N_m"]
    assert (info.output, info.unit) == ("t_bar_torque_min", "N_m")
    assert hp.Frame({"front_anti_roll_bar_rate_N_mm_per_rad": [1.0]}).info.popitem()[1].unit == "N_mm_per_rad"


def test_columns_of_tables_are_real_numbers():
    study = hp.load(STUDIES / "macpherson_sweep.toml")
    good = {name: [1.0, 2.0] for name in study.sweep_variables}
    first = study.sweep_variables[0]
    for bad in ([1 + 2j, 3], ["1", "2"], ["a", "b"], [1.0], np.array(["2020-01-01"] * 2, "datetime64[D]")):
        with pytest.raises(hp.HardpointError, match=rf"{first}|lengths"):
            hp.sweep(study, {**good, first: bad}, threads=1)
    row = np.ma.array([1.0, 2, 3, 4], mask=[0, 1, 0, 0])
    assert hp.sweep(study, [row], threads=1).status.tolist() == [hp.STATUS.index("not_finite")]
    assert hp.sweep(study, {**good, first: [1.0, None]}, threads=1).failed.tolist() == [1]


def test_tables_from_files_go_to_xarray():
    pytest.importorskip("xarray")
    data = hp.Frame({"travel_mm": [0.0, 1.0], "status": ["ok", "unreachable"]}).to_xarray()
    assert data["status"].values.tolist() == ["ok", "unreachable"]


def test_text_is_no_list_of_names():
    with pytest.raises(hp.HardpointError, match="list of names"):
        hp.template("macpherson", "sweep")
    with pytest.raises(hp.HardpointError, match="list of names"):
        hp.optimise(STUDIES / "macpherson_steering.toml", front="toe")
    with pytest.raises(hp.HardpointError, match="list of names"):
        hp.sweep(STUDIES / "macpherson_sweep.toml", [[0.0]], variables="tie_rod_inner_dz")


def test_the_right_wheel_is_mirrored_or_given():
    axle = hp.load(STUDIES / "double_wishbone_axle.toml").to_dict()["suspension"]
    arguments = ("double_wishbone", axle["hardpoints"], {"heave": [0.0]}, ["camber"])
    with pytest.raises(hp.HardpointError, match="mirrored"):
        hp.vehicle(*arguments, right="Mirored", suspension={"bodies": axle["bodies"]})


def test_a_sweep_with_missing_rows_is_not_read(tmp_path):
    hp.sweep(STUDIES / "macpherson_sweep.toml", [[0, 0, 0, 0], [1, 0, 0, 0]], threads=1).save(tmp_path / "run")
    table = tmp_path / "run" / "designs.csv"
    table.write_text("".join(table.read_text().splitlines(keepends=True)[:2]))
    with pytest.raises(hp.HardpointError, match="only 1 of 2 designs"):
        hp.read_run(tmp_path / "run")["designs"]


def test_numbers_and_texts_of_any_kind_become_toml():
    study = hp.load(STUDIES / "macpherson_front.toml")
    assert study.replace({"motion.rack": np.array(5.0)})["motion.rack"] == 5.0
    # JSON escapes such a character as two surrogates, which TOML refuses.
    name = "rod \U0001f527 \x7f"
    limited = study.replace({"optimise.constraints": [{"name": name, "length": "tie_rod", "at_most": 400.0}]})
    assert limited["optimise.constraints"][0]["name"] == name
    assert hp.Study.from_dict(limited.to_dict())["optimise.constraints"][0]["name"] == name
    with pytest.raises(hp.HardpointError, match="expected"):
        study.replace({"motion.rack": np.ma.masked})


def test_reasons_of_parquet_are_kept():
    words = {"status": np.array(["ok", "incomplete"], object), "reason": np.array([None, "no pose"], object)}
    frame = hp.Frame({"design": [0, 1], **words})
    assert frame.reasons == ("", "no pose") and frame.failed.tolist() == [1]


def test_motions_whose_names_end_with_a_number_are_separate_tables(tmp_path):
    for number in ("bump-1", "bump-2"):
        (tmp_path / f"curves_{number}.csv").write_text(f"travel_mm\n{number[-1]}\n")
    for part in range(2):
        (tmp_path / f"part-{part:09}.csv").write_text(f"design\n{part}\n")
    run = hp.read_run(tmp_path)
    assert set(run) == {"curves_bump-1", "curves_bump-2", "designs"}
    assert run["curves_bump-2"]["travel_mm"].tolist() == [2.0] and run["designs"].rows == 2


def test_limits_of_builds_that_cannot_be_assembled_are_unknown():
    scatter = [{"hardpoint": "tie_rod_inner", "axis": "y", "limits": [5000.0, 6000.0]}]
    found = hp.limits(hp.load(STUDIES / "macpherson_front.toml", {"tolerance": {"scatter": scatter}}), builds=4)
    assert found.rejected == 4
    for end in (found.travel.low, found.travel.high):
        assert np.isnan(end.value) and end.build is None and "no build" in end.cause


def test_signs_of_the_coordinates_of_a_motion():
    info = hp.solve(STUDIES / "macpherson_axle.toml", threads=1).info
    assert info["roll_deg"].positive.startswith("right wheel in jounce")
    assert info["heave_mm"].positive == "in jounce"


def test_endings_give_the_format_of_an_export(tmp_path):
    study = hp.load(STUDIES / "macpherson_front.toml")
    hp.export(study, tmp_path / "POINTS.CSV")
    assert "strut_top" in (tmp_path / "POINTS.CSV").read_text()
    hp.export(study, tmp_path / "study.toml")
    assert hp.load(tmp_path / "study.toml").points == study.points
    with pytest.raises(hp.HardpointError, match="to="):
        hp.export(study, tmp_path / "points")
