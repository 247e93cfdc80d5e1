"""Every command of the program from Python, and results read back."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES

FUNCTIONS = {
    "new": hp.template,
    "check": hp.check,
    "solve": hp.solve,
    "sweep": hp.sweep,
    "merge": hp.merge,
    "optimise": hp.optimise,
    "setup": hp.setup,
    "tolerance": hp.tolerance,
    "limits": hp.limits,
    "assemblies": hp.assemblies,
    "report": hp.report,
    "import": hp.import_points,
    "export": hp.export,
    "compare": hp.compare,
    "schema": hp.schema,
}
# Commands for shells, terminals and files. Python runs them with hp.run, as in hp.run(["studio", ...]).
TYPED = {"studio", "bench", "kc", "convert", "completions", "man", "help"}


def test_every_command_has_its_function():
    command = [sys.executable, "-P", "-m", "hardpoint", "--help"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    listed = text.split("Commands:\n")[1].split("\n\n")[0].splitlines()
    commands = {line.split()[0] for line in listed if line.startswith("  ") and not line.startswith("   ")}
    assert commands - TYPED == set(FUNCTIONS)
    assert all(f.__name__ in hp.__all__ and f.__doc__ for f in FUNCTIONS.values())


def test_no_function_starts_a_process_but_export_and_import_use_files(front, tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("a child process")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    monkeypatch.setattr(sys, "executable", "")
    hp.export(front, tmp_path / "points.csv")
    hp.import_points(tmp_path / "points.csv", "macpherson")
    monkeypatch.setattr("tempfile.TemporaryDirectory", refuse)
    hp.compare(before=front, after=front)
    hp.assemblies(front)
    hp.template("macpherson", ["sweep"])


def test_a_run_is_read_back(tmp_path):
    study = hp.load(STUDIES / "double_wishbone_solve.toml", {"motion.rack": 5.0})
    path = tmp_path / "mine.toml"
    path.write_text(study.text)
    assert hp.run(["--quiet", "solve", path, "--out", tmp_path / "run"]) == 0
    run = hp.read_run(tmp_path / "run")
    assert run.command == "solve" and "curves.csv" in run.files
    assert run.study.text == study.text
    curves = hp.solve(run.study)
    table = run["curves"]
    assert table.rows == curves.rows and list(table) == [*curves, "status"]
    for name in curves:
        np.testing.assert_array_equal(table[name], curves[name])
    with pytest.raises(KeyError):
        run["nothing"]
    for wrong in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(hp.HardpointError):
            hp.read_run(wrong) if wrong != tmp_path else hp.read_run(path.parent / "run" / "..")


def test_a_sweep_is_read_back_and_merged(sweep_study, tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(sweep_study.text)
    assert hp.run(["--quiet", "sweep", path, "--out", tmp_path / "run"]) == 0
    rows = hp.sweep(sweep_study)
    for run in (hp.read_run(tmp_path / "run"), hp.merge([tmp_path / "run"], tmp_path / "one")):
        assert run.command == "sweep"
        assert run.study.text == sweep_study.text
        for name in rows:
            np.testing.assert_array_equal(run["designs"][name], rows[name])
    page = hp.report(tmp_path / "run")
    assert page.read_text().startswith("<!")


def test_tolerances_and_set_up(tmp_path):
    study = hp.load(STUDIES / "macpherson_tolerance.toml", {"tolerance.builds": 256})
    found = hp.tolerance(study)
    assert {"tolerance", "contributors", "curves"} <= set(found) and found["tolerance"].rows > 0
    assert found.summary and pickle.loads(pickle.dumps(found))["curves"].rows == found["curves"].rows
    directory = found.save(tmp_path / "run")
    assert hp.read_run(directory)["tolerance"].rows == found["tolerance"].rows
    assert hp.report(directory).is_file()
    with pytest.raises(hp.HardpointError, match="not empty"):
        found.save(directory)
    steps = hp.setup(study)
    assert steps["setup"].rows > 0 and steps.summary["met"] is True
    wanted = [value for value in steps.summary["statics"] if value["wanted"] is not None]
    assert {value["column"] for value in wanted} == {"camber_deg", "toe_deg"}
    for value in wanted:
        assert abs(value["miss"]) < 1e-9 and abs(value["miss_rounded"]) <= value["allowed_rounded"]
    pushrod = hp.load(
        STUDIES / "double_wishbone_tolerance.toml",
        {"setup": {"adjust": [{"length": "pushrod", "per_turn": 2.5}], "ride_height_change": 4.0}},
    )
    raised = hp.setup(pushrod).summary
    assert raised["adjustments"][0]["instruction"].startswith("lengthen")
    height = raised["statics"][-1]
    assert height["column"] == "ride_height_change_mm" and abs(height["set"] - 4.0) < 1e-9
    with pytest.raises(hp.HardpointError, match="tolerance"):
        hp.tolerance(hp.loads(hp.template("macpherson")))


def test_assemblies_and_limits(front):
    ways = hp.assemblies(front)
    assert (ways["connected"] == "true").sum() == 1 and ways.rows > 1
    assert hp.limits(front).travel.low.value < 0.0


def test_designs_side_by_side(front, tmp_path):
    moved = front.design
    moved[front.points.index("tie_rod_inner"), 2] += 3.0
    found = hp.compare(before=front, after=front.replace(design=moved))
    assert found["comparison"].rows == hp.solve(front).rows
    np.testing.assert_array_equal(found["comparison"]["toe_deg [before]"], hp.solve(front)["toe_deg"])
    assert found["moved"].rows == 1
    assert (found.save(tmp_path / "compared") / "report.html").is_file()
    with pytest.raises(hp.HardpointError):
        hp.compare(before=front)


def test_points_go_out_and_come_back(front, tmp_path):
    for name in ("points.csv", "points.xlsx", "points.sub"):
        assert isinstance(hp.export(front, tmp_path / name), list)
        back, notes = hp.import_points(tmp_path / name, "macpherson")
        assert back.points == front.points and isinstance(notes, list)
        np.testing.assert_array_equal(hp.solve(back)["camber_deg"].shape, hp.solve(front)["camber_deg"].shape)
        if name != "points.sub":
            np.testing.assert_array_equal(back.design, front.design)
    back, _ = hp.import_points({"points": dict(zip(front.points, front.design))}, "macpherson")
    np.testing.assert_array_equal(back.design, front.design)
    said = hp.export(front, tmp_path / "rounded.csv", round=0.5)
    assert any("misfit" in line for line in said)
    with pytest.raises(hp.HardpointError, match="already exists.*force=True"):
        hp.export(front, tmp_path / "rounded.csv")
    with pytest.raises(hp.HardpointError):
        hp.import_points(tmp_path / "points.csv", "five_link")


def test_texts_for_editors_and_shells():
    suspension, car = hp.schema()["anyOf"]
    assert "suspension" in suspension["properties"]
    assert "car" in car["properties"]
    study = hp.loads(hp.template("double_wishbone", ["pushrod", "sweep"]))
    assert "rocker_axis" in " ".join(study.points) or len(study.points) > 11
    with pytest.raises(hp.HardpointError):
        hp.template("macpherson", ["nothing"])


def test_pictures_and_a_page(front, tmp_path):
    path = tmp_path / "front.toml"
    path.write_text(front.text)
    assert hp.run(["--quiet", "optimise", path, "--out", tmp_path / "run"]) == 0
    run = hp.read_run(tmp_path / "run")
    tuned = hp.optimise(front)
    # A tuning by the program and a tuning by the module give exactly equal numbers.
    np.testing.assert_array_equal(run.tuned.design, tuned.study.design)
    assert run.tuned.text == tuned.study.text
    curves = hp.solve(tuned.study)
    for name in curves:
        np.testing.assert_array_equal(run["curves"][name], curves[name])
    assert hp.report(run, plots=tmp_path / "plots").is_file()
    assert list((tmp_path / "plots").glob("*.svg"))


def test_a_tuning_towards_the_yield_says_what_it_expects():
    study = hp.load(STUDIES / "double_wishbone_robust.toml")
    assert hp.optimise(study).expected_yield is None
    tuning = hp.optimise(study.replace({"optimise.robust": "yield", "optimise.scatter": 128}))
    expected = tuning.expected_yield
    assert expected is not None
    assert 0.99 < expected["without_scatter"] <= expected["tuned"] <= 1.0
