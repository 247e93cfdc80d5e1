"""Results in memory, written as directories and pages, equal the results of the program."""

import json
import pickle
import re

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES


def written(command, study, tmp_path, *more):
    """Directory that the program writes for a run of a study."""
    path = tmp_path / f"{study.name}.toml"
    path.write_text(study.text, encoding="utf-8")
    assert hp.run(["--quiet", command, path, "--out", tmp_path / "run", "--report", *more]) in (0, 1)
    return tmp_path / "run"


def same_files(directory, by_program, names):
    for name in names:
        assert (directory / name).read_bytes() == (by_program / name).read_bytes(), name


def test_curves_are_saved_and_shown_as_by_the_program(front, tmp_path):
    by_program = written("solve", front, tmp_path)
    curves = pickle.loads(pickle.dumps(hp.solve(front)))
    page = curves.report(tmp_path / "page.html", plots=tmp_path / "plots")
    assert page.read_bytes() == (by_program / "report.html").read_bytes()
    assert {"overview.svg", "camber_deg.svg"} <= {path.name for path in (tmp_path / "plots").iterdir()}
    directory = curves.save(tmp_path / "saved")
    same_files(directory, by_program, ["curves.csv", "report.json"])
    summaries = [json.loads((place / "summary.json").read_text()) for place in (directory, by_program)]
    assert summaries[0] == {key: value for key, value in summaries[1].items() if key not in ("finished", "interrupted")}
    np.testing.assert_array_equal(hp.read_run(directory)["curves"]["camber_deg"], curves["camber_deg"])
    assert hp.report(directory).read_bytes() == page.read_bytes()
    with pytest.raises(hp.HardpointError, match=r"Curves\.report\(path\)"):
        hp.report(curves)


@pytest.mark.parametrize("name", ["macpherson_front", "macpherson_axle_front"])
def test_tunings_are_saved_and_shown_as_by_the_program(name, tmp_path):
    study = hp.load(STUDIES / f"{name}.toml", {"optimise.starts": 1, "optimise.max_iterations": 4})
    by_program = written("optimise", study, tmp_path)
    tuned = hp.optimise(study, prices=True)
    page = tuned.report(tmp_path / "page.html")
    assert page.read_bytes() == (by_program / "report.html").read_bytes()
    directory = tuned.save(tmp_path / "saved")
    names = ["curves.csv", "curves_before.csv", "history.csv", "optimised.toml", "side_effects.csv", "report.json"]
    same_files(directory, by_program, names)
    assert hp.read_run(directory).tuned.text == tuned.study.text


def test_a_tuning_with_a_front_has_it_on_its_page(tmp_path):
    study = hp.load(STUDIES / "macpherson_steering.toml")
    tuned = hp.optimise(study, front=["toe", "bump_steer"])
    assert "front.csv" in {path.name for path in tuned.save(tmp_path / "saved").iterdir()}
    record = json.loads((tmp_path / "saved" / "report.json").read_text())
    assert len(record["front"]["points"]) == tuned.front.rows
    assert "Trade-off" in tuned.report(tmp_path / "page.html").read_text()


def data(page):
    """Data that the script of a page reads."""
    found = re.search(r'<script type="application/json" id="run">(.*?)</script>', page.read_text(), re.DOTALL)
    return json.loads(found[1])


def test_sweeps_are_saved_and_shown_as_by_the_program(sweep_study, tmp_path):
    by_program = written("sweep", sweep_study, tmp_path)
    rows = hp.sweep(sweep_study)
    assert data(rows.report(tmp_path / "page.html")) == data(by_program / "report.html")
    assert "without files" in (tmp_path / "page.html").read_text()
    directory = rows.save(tmp_path / "saved")
    same_files(directory, by_program, ["designs.csv", "summary.json", "pareto.csv"])
    # Pass the same designs as an array.
    x = np.column_stack([rows[name] for name in rows.variables])
    given = hp.sweep(sweep_study, x)
    np.testing.assert_array_equal(hp.read_run(given.save(tmp_path / "given"))["designs"]["misfit"], rows["misfit"])
    assert "<svg" in given.report(tmp_path / "given.html").read_text() or data(tmp_path / "given.html")
    x[0, 0] = np.nan
    with pytest.raises(hp.HardpointError, match="not finite"):
        hp.sweep(sweep_study, x).save(tmp_path / "bad")


def test_sweeps_have_their_curves(tmp_path):
    study = hp.load(STUDIES / "macpherson_sweep.toml", {"sweep.samples": 30, "sweep.curves": True})
    by_program = written("sweep", study, tmp_path)
    rows = hp.sweep(study)
    table = hp.read_run(by_program)["curves"]
    assert list(rows.curves) == list(table) and rows.curves.rows == 30 * hp.solve(study).rows
    for name in table:
        np.testing.assert_array_equal(rows.curves[name], table[name])
    x = np.column_stack([rows[name] for name in rows.variables])
    x[4] = np.nan
    given = hp.sweep(study, x)
    others = table["design"] != 4
    np.testing.assert_array_equal(given.curves["camber_deg"], table["camber_deg"][others])
    assert hp.sweep(study, x[:0]).curves.rows == 0
    assert hp.sweep(hp.load(STUDIES / "macpherson_sweep.toml", {"sweep.samples": 30})).curves is None


def test_other_results_have_pages_or_say_that_they_have_none(front, tmp_path):
    study = hp.load(STUDIES / "macpherson_tolerance.toml", {"tolerance.builds": 256})
    page = hp.tolerance(study).report(tmp_path / "tolerance.html")
    assert data(page)["record"]["command"] == "tolerance"
    assert hp.setup(study).report(tmp_path / "setup.html").read_text().startswith("<!")
    assert hp.compare(a=front, b=front).report(tmp_path / "compare.html").read_text().startswith("<!")
    found = hp.kc(STUDIES / "double_wishbone_compliance.toml")
    assert "by lateral force" in found.report(tmp_path / "kc.html").read_text()
    car = hp.Car(STUDIES / "car.toml")
    with pytest.raises(hp.HardpointError, match="no page"):
        hp.compare(a=car, b=car).report(tmp_path / "cars.html")


def test_columns_say_what_they_are(front):
    info = hp.solve(front).info
    assert info["camber_deg"].formula and info["camber_deg"].unit == "deg"
    axle = hp.solve(STUDIES / "macpherson_axle.toml").info
    assert axle["left_camber_deg"].formula == info["camber_deg"].formula
    stiffness = axle["roll_stiffness_N_m_per_deg"]
    assert "roll_moment" in stiffness.formula and stiffness.source
    assert info["travel_mm"].formula == ""


def test_functions_have_the_constraints_of_the_study():
    study = hp.load(STUDIES / "macpherson_steering.toml")
    r, f = study.residuals(), study.function(constraints=True)
    assert f.variables == r.variables and f.constraint_rows == r.constraint_rows and len(f.constraint_rows) > 0
    x = 0.3 * r.bounds[:, 1]
    np.testing.assert_array_equal(f.constraints(x), r.constraints(x))
    np.testing.assert_array_equal(f.constraint_jacobian(x), r.constraint_jacobian(x))
    # Use other variables, one of which is a coordinate.
    names = ["tie_rod_inner_z", "tie_rod_inner_dy"]
    g = study.function(names, constraints=True)
    z = study["tie_rod_inner"][2]
    h = study.function(["tie_rod_inner_dz", "tie_rod_inner_dy"], constraints=True)
    np.testing.assert_allclose(g.constraints([z + 1.5, -1.0]), h.constraints([1.5, -1.0]), atol=1e-10)
    exact, step = g.constraint_jacobian([z + 1.5, -1.0]), 1e-3
    for k, e in enumerate(step * np.eye(2)):
        at = np.array([z + 1.5, -1.0])
        difference = (8 * (g.constraints(at + e) - g.constraints(at - e)) - (g.constraints(at + 2 * e) - g.constraints(at - 2 * e)))
        np.testing.assert_allclose(exact[:, k], difference / (12 * step), atol=1e-7)
    assert pickle.loads(pickle.dumps(g)).constraint_rows == g.constraint_rows
    assert [part["type"] for part in g.scipy_constraints()]
    with pytest.raises(hp.HardpointError, match="constraints=True"):
        study.function().constraints(x)
    with pytest.raises(hp.HardpointError, match=r"\[optimise\]"):
        hp.loads(hp.template("macpherson")).function(constraints=True)


def test_no_call_writes_temporary_files(front, tmp_path, monkeypatch):
    """A folder for temporary files that cannot be written."""
    monkeypatch.setenv("TMPDIR", str(tmp_path / "nowhere"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nowhere"))
    for name in ("points.csv", "points.xlsx"):
        hp.export(front, tmp_path / name)
        back, _ = hp.import_points(tmp_path / name, "macpherson")
        np.testing.assert_array_equal(back.design, front.design)
    points = {"points": dict(zip(front.points, front.design.tolist()))}
    back, notes = hp.import_points(points, "macpherson")
    np.testing.assert_array_equal(back.design, front.design)
    assert not any(str(tmp_path) in note or "studio" in note for note in notes)
    renamed = {name.upper() + "_X": position for name, position in zip(front.points, front.design.tolist())}
    names = {name: name.upper() + "_X" for name in front.points}
    back, _ = hp.import_points(renamed, "macpherson", names=names)
    np.testing.assert_array_equal(back.design, front.design)
    with pytest.raises(hp.HardpointError, match="strut_top"):
        hp.import_points({"strut_topp": [0.0, 0.0, 0.0]}, "macpherson", names={"strut_top": "nothing"})
