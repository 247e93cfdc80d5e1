"""Requests about one design: studies, curves and limits."""

import csv
import pickle

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES


def test_curves_are_those_of_the_program_to_the_bit(tmp_path):
    for path in sorted(STUDIES.glob("*_solve.toml")):
        study = hp.load(path)
        out = tmp_path / path.stem
        code = hp.run(["--quiet", "solve", path, "--out", out])
        curves = hp.solve(study)
        with open(out / "curves.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert code in (0, 1)
        assert len(rows) == len(curves.status)
        for name in curves:
            written = [float(row[name]) if row[name] else np.nan for row in rows]
            np.testing.assert_array_equal(curves[name], written, err_msg=f"{path.stem} {name}")
        assert list(rows[0]) == [*curves, "status"]
        assert [row["status"] for row in rows] == [hp.STATUS[code] for code in curves.status]


def test_a_template_of_each_topology_is_a_study():
    for topology in hp.topologies():
        study = hp.loads(hp.template(topology))
        assert study.topology == topology
        assert study.design.shape == (len(study.points), 3)
        assert isinstance(hp.check(study), list)


def test_a_study_is_replaced_pickled_compared(front):
    design = front.design
    design[0, 2] += 1.5
    moved = front.replace(design=design)
    np.testing.assert_array_equal(moved.design, design)
    assert moved != front and front == hp.loads(front.text, name="macpherson_front.toml")
    assert pickle.loads(pickle.dumps(moved)) == moved
    assert {front: 1}[pickle.loads(pickle.dumps(front))] == 1
    shorter = front.replace({"motion.travel": [-10.0, 0.0, 10.0]})
    np.testing.assert_array_equal(hp.solve(shorter).drive, [-10.0, 0.0, 10.0])


def test_changed_studies_find_the_files_of_their_directory(tmp_path):
    text = (STUDIES / "macpherson_solve.toml").read_text() + '\n[sweep]\ndesigns = "rows.csv"\n'
    (tmp_path / "study.toml").write_text(text)
    (tmp_path / "rows.csv").write_text("tie_rod_inner_dz\n0\n1\n")
    study = hp.load(tmp_path / "study.toml")
    for changed in (study.replace({"motion.travel": [-10.0, 0.0, 10.0]}), study.swept(1), pickle.loads(pickle.dumps(study))):
        assert hp.sweep(changed).rows == 2


def test_sensitivities_are_derivatives_of_the_curves(front):
    study = front.replace({"outputs.sensitivities": ["tie_rod_outer"], "motion.travel": [0.0, 20.0]})
    curves = hp.solve(study)
    assert curves.sensitivities.shape == (2, len(curves.outputs), 1, 3)
    k, h = curves.outputs.index("toe_deg"), 1e-4
    point = study.points.index("tie_rod_outer")
    for axis in range(3):
        ends = []
        for sign in (1.0, -1.0):
            design = study.design
            design[point, axis] += sign * h
            ends.append(hp.solve(study.replace(design=design))["toe_deg"])
        difference = (ends[0] - ends[1]) / (2 * h)
        np.testing.assert_allclose(curves.sensitivities[:, k, 0, axis], difference, atol=1e-9)


def test_a_wrong_study_says_where():
    with pytest.raises(hp.StudyError) as wrong:
        hp.loads('[suspension]\ntopology = "macphersn"\n')
    assert wrong.value.line is not None
    assert "study.toml" in str(wrong.value)
    with pytest.raises(hp.StudyError, match="cannot be read"):
        hp.load("nowhere.toml")
    with pytest.raises(hp.HardpointError, match="no topology"):
        hp.template("macphersn")


def test_what_cannot_be_reached_has_no_value(front):
    curves = hp.solve(front.replace({"motion.travel": [0.0, 5000.0]}))
    assert [hp.STATUS[code] for code in curves.status] == ["ok", "unreachable"]
    assert curves.reasons[0] == "" and "travel ends" in curves.reasons[1]
    assert list(curves.failed) == [1]
    assert np.isnan(curves["camber_deg"][1]) and not np.isnan(curves["camber_deg"][0])


@pytest.mark.parametrize("design", [np.zeros((3, 3)), np.full((9, 3), np.nan), np.zeros((9, 3))])
def test_a_hostile_design_is_an_exception(front, design):
    with pytest.raises(hp.HardpointError):
        front.replace(design=design)


def test_limits(front):
    travel = hp.limits(front).travel
    assert travel.low.value < 0.0 < travel.high.value and travel.low.cause
    assert hp.limits(hp.loads(hp.template("semi_trailing_arm")))["rack"] is None


@pytest.mark.parametrize("name", ["macpherson_axle", "five_link_axle"])
def test_curves_of_an_axle_are_those_of_the_program_to_the_bit(name, tmp_path):
    path = STUDIES / f"{name}.toml"
    study = hp.load(path)
    assert hp.run(["--quiet", "solve", path, "--out", tmp_path / "run"]) in (0, 1)
    table, curves = hp.read_run(tmp_path / "run")["curves"], hp.solve(study)
    assert list(table) == [*curves, "status"]
    for column, values in curves.items():
        np.testing.assert_array_equal(table[column], values, err_msg=column)
    assert table["status"].tolist() == [hp.STATUS[code] for code in curves.status]


def test_an_axle_is_a_function_and_swept_and_limited(tmp_path):
    fields = {"motion": {"roll": [-1.0, 0.0, 2.0]}, "outputs.characteristics": ["camber", "roll_centre_height"]}
    variable = {"hardpoint": "tie_rod_inner", "axis": "z", "range": [-5.0, 5.0]}
    fields["sweep"] = {"method": "sobol", "samples": 12, "variables": [variable]}
    study = hp.load(STUDIES / "macpherson_axle.toml", fields)
    f, curves = study.function(["tie_rod_inner_dz", "strut_top_dy"]), hp.solve(study)
    assert f.outputs == list(curves.outputs)
    np.testing.assert_allclose(f([0.0, 0.0]), np.array([curves[name] for name in curves.outputs]), rtol=1e-9, atol=1e-9)
    x = np.array([[1.0, -2.0], [0.5, 3.0]])
    y, jacobian = f.value_and_jacobian(x)
    np.testing.assert_allclose(y, f(x), rtol=1e-9, atol=1e-9)
    h = 1e-3
    for k, e in enumerate(h * np.eye(2)):
        difference = (8 * (f(x + e) - f(x - e)) - (f(x + 2 * e) - f(x - 2 * e))) / (12 * h)
        np.testing.assert_allclose(jacobian[..., k], difference, rtol=1e-5, atol=1e-6)
    # A sweep by the module gives exactly the rows of a sweep by the program. A sweep of an array gives the rows of the
    # same designs.
    path = tmp_path / "axle.toml"
    path.write_text(study.text)
    assert hp.run(["--quiet", "sweep", path, "--out", tmp_path / "run"]) in (0, 1)
    table, rows = hp.read_run(tmp_path / "run")["designs"], hp.sweep(study)
    for name in rows:
        np.testing.assert_array_equal(table[name], rows[name])
    again = hp.sweep(study, np.c_[rows["tie_rod_inner_dz_mm"]], variables=["tie_rod_inner_dz"])
    np.testing.assert_array_equal(again["left_camber_max_deg"], rows["left_camber_max_deg"])
    limits = hp.limits(study)
    assert {"left_travel", "right_travel", "rack", "roll_deg"} <= set(limits)
    for both in limits.values():
        assert both.low.value < 0.0 < both.high.value and both.low.cause
    assert limits.left_travel.low.value == limits.right_travel.low.value


def test_doubts_are_about_both_wheels():
    study = hp.load(STUDIES / "macpherson_axle.toml")
    assert not any("right wheel" in doubt for doubt in hp.check(study))
    points = dict(zip(study.points, study.design * [1.0, -1.0, 1.0]))
    swapped = {"lower_arm_front": points["lower_arm_rear"].tolist(), "lower_arm_rear": points["lower_arm_front"].tolist()}
    doubts = hp.check(study.replace({"axle.right": {"hardpoints": swapped}}))
    assert any("right wheel" in doubt for doubt in doubts), doubts


def test_a_study_of_a_mapping_is_that_of_its_text(front):
    import tomllib

    sections = tomllib.loads(front.text)
    assert front.to_dict() == sections and front["motion.travel"] == sections["motion"]["travel"]
    again = hp.Study.from_dict(sections)
    np.testing.assert_array_equal(again.design, front.design)
    np.testing.assert_array_equal(hp.solve(again)["camber_deg"], hp.solve(front)["camber_deg"])
    for wrong in ({"suspension": {"topology": None}}, {"motion": {"travel": float("nan")}}, {"motion": object()}):
        with pytest.raises(hp.HardpointError, match="expected"):
            hp.Study.from_dict(wrong)


@pytest.mark.parametrize("name", ["macpherson_axle_front", "five_link_axle_rear"])
def test_tuning_of_an_axle_is_that_of_the_program(name, tmp_path):
    path = STUDIES / f"{name}.toml"
    study = hp.load(path, {"optimise.starts": 1, "optimise.max_iterations": 3})
    written = tmp_path / path.name
    written.write_text(study.text)
    assert hp.run(["--quiet", "optimise", written, "--out", tmp_path / "run"]) in (0, 1)
    run, tuned = hp.read_run(tmp_path / "run"), hp.optimise(study)
    assert run.tuned.text == tuned.study.text
    assert run.summary["misfit_after"] == tuned.misfit <= tuned.before
    effects = run.summary["side_effects"]
    frame = tuned.side_effects
    assert frame.rows == len(effects) > 0
    for row, written in enumerate(effects):
        for key in ("output", "unit", "before_min", "after_max", "largest_change", "tolerance", "flagged", "lost"):
            missing = written[key] is None
            assert np.isnan(frame[key][row]) if missing else frame[key][row] == written[key]
        assert frame["wheel"][row] == (written["wheel"] or "")
        assert all(f"{place['name']} {place['value']:g}" in frame["at"][row] for place in written["at"])
    # The residuals that a tuning minimises, with their derivatives.
    r = study.residuals()
    x = 0.05 * np.ptp(r.bounds, axis=1)
    values, jacobian = r.value_and_jacobian(x)
    h = 1e-3
    for k in range(len(x)):
        e = np.eye(len(x))[k] * h
        difference = (8 * (r(x + e) - r(x - e)) - (r(x + 2 * e) - r(x - 2 * e))) / (12 * h)
        np.testing.assert_allclose(jacobian[:, k], difference, atol=1e-5 * np.abs(jacobian).max())
