"""Wrong or hidden results that users reported, each with the correct result."""

import subprocess
import sys

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES


def test_a_violated_constraint_is_no_success(tmp_path):
    steering = hp.load(STUDIES / "macpherson_steering.toml")
    constraints = [
        {"length": "tie_rod", "between": [500.0, 510.0]},
        {"length": ["lower_ball_joint", "tie_rod_outer"], "between": [130.0, 160.0]},
    ]
    study = steering.replace({"optimise.constraints": constraints})
    tuned = hp.optimise(study)
    assert not tuned.success and "tie_rod" in tuned.message and "violated" in tuned.message
    assert tuned.constraints["status"].tolist() == ["violated", "kept"] and tuned.constraints["margin"][0] < 0.0
    ends = (tuned.study["tie_rod_inner"], tuned.study["tie_rod_outer"])
    length = np.linalg.norm(ends[0] - ends[1])
    np.testing.assert_allclose(tuned.constraints["margin"][0], length - 500.0, atol=1e-9)
    file = tmp_path / "study.toml"
    file.write_text(study.text)
    program = [sys.executable, "-P", "-m", "hardpoint", "--quiet", "optimise", file, "--out", tmp_path / "run"]
    assert subprocess.run(program, capture_output=True, check=False).returncode == 1
    assert hp.optimise(steering, front=False).success


def test_fronts_and_prices_are_there_when_asked_for():
    study = hp.load(STUDIES / "macpherson_steering.toml")
    tuned = hp.optimise(study, front=["toe", "bump_steer"], prices=True)
    assert {"misfit_toe", "misfit_bump_steer"} <= set(tuned.front) and tuned.front.rows > 0
    moved = tuned.prices["moved"]
    assert tuned.prices.rows > 1 and np.all(np.diff(moved) >= 0.0)
    plain = hp.optimise(study, front=False)
    assert plain.front is None and plain.prices is None


def test_a_callback_sees_iterations_and_stops(front):
    seen = []
    tuned = hp.optimise(front, callback=lambda *progress: seen.append(progress))
    assert tuned.success and seen[0][:2] == (0, 0) and len(seen) == tuned.history.rows

    def stop(*_):
        raise StopIteration

    slow = hp.load(STUDIES / "double_wishbone_robust.toml", {"optimise.starts": 50})
    stopped = hp.optimise(slow, callback=stop)
    assert not stopped.success and "interrupted" in stopped.message
    with pytest.raises(ZeroDivisionError):
        hp.optimise(slow, callback=lambda *_: 1 / 0)


@pytest.mark.parametrize("reshape", [lambda d: d.T, lambda d: d.reshape(1, -1), lambda d: d.ravel(), lambda d: d + 1j])
def test_a_design_of_another_shape_is_refused(front, reshape):
    with pytest.raises(hp.HardpointError, match="expected"):
        front.replace(design=reshape(front.design))


def test_results_that_do_not_fit_are_memory_errors(front):
    f = front.replace({"motion.travel": np.linspace(-80, 80, 2001)}).function(["tie_rod_inner_dz"])
    x = np.broadcast_to(np.zeros(1), (10_000_000, 1))
    for call in (f, f.value_and_jacobian):
        with pytest.raises(MemoryError):
            call(x)


def test_check_names_what_is_not_reached(front):
    assert not any(line.startswith("not solved") for line in hp.check(front))
    lines = hp.check(front.replace({"motion.travel": [-500.0, 0.0, 500.0]}))
    assert sum(line.startswith("not solved: travel") for line in lines) == 2


def test_a_sweep_and_its_designs_given_back_are_the_same(sweep_study):
    rows = hp.sweep(sweep_study)
    x = np.column_stack([rows[name] for name in rows.variables])
    assert list(rows.variables) == [f"{name}_mm" for name in sweep_study.sweep_variables]
    for again in (hp.sweep(sweep_study, x), hp.sweep(sweep_study, rows)):
        for name in rows:
            np.testing.assert_array_equal(again[name], rows[name])
    design = sweep_study.swept(7).design
    moved = sweep_study.function(sweep_study.sweep_variables)
    y = hp.solve(sweep_study.swept(7))
    np.testing.assert_allclose(moved(x[7]), [y[name] for name in moved.outputs], atol=1e-9)
    assert design.shape == sweep_study.design.shape


def test_rows_that_are_not_finite_have_no_values(sweep_study):
    rows = hp.sweep(sweep_study)
    x = np.column_stack([rows[name] for name in rows.variables])
    x[3, 0], x[5] = np.nan, np.inf
    found = hp.sweep(sweep_study, x)
    assert list(found.failed) == [3, 5] and {hp.STATUS[found.status[n]] for n in (3, 5)} == {"not_finite"}
    assert np.isnan(found["misfit"][[3, 5]]).all() and found[rows.variables[0]][5] == np.inf and found.reasons[3]
    others = np.setdiff1d(np.arange(300), [3, 5])
    np.testing.assert_array_equal(found["misfit"][others], rows["misfit"][others])
    assert hp.sweep(sweep_study, x[3:4]).failed.tolist() == [0] and hp.sweep(sweep_study, x[:0]).rows == 0


def test_tables_are_read_by_the_names_of_their_columns(front):
    pandas = pytest.importorskip("pandas")
    f = front.function(["strut_top_dy", "tie_rod_inner_dz"])
    table = pandas.DataFrame({"tie_rod_inner_dz": [5.0, 1.0], "strut_top_dy": [-5.0, 2.0], "note": ["a", "b"]})
    exact = f([[-5.0, 5.0], [2.0, 1.0]])
    np.testing.assert_array_equal(f(table), exact)
    np.testing.assert_array_equal(f({"tie_rod_inner_dz": 5.0, "strut_top_dy": -5.0}), exact[0])
    np.testing.assert_array_equal(hp.sweep(front, table, variables=f.variables)["strut_top_dy_mm"], [-5.0, 2.0])
    with pytest.raises(hp.HardpointError, match="no column strut_top_dy"):
        f(table[["tie_rod_inner_dz"]])
    masked = np.ma.masked_array([[-5.0, 5.0], [2.0, 1.0]], mask=[[False, False], [True, False]])
    np.testing.assert_array_equal(f(masked)[0], exact[0])
    assert np.isnan(f(masked)[1]).all()


def test_paths_are_taken_and_other_things_refused(front):
    path = STUDIES / "macpherson_front.toml"
    np.testing.assert_array_equal(hp.solve(path)["camber_deg"], hp.solve(front)["camber_deg"])
    assert hp.limits(str(path)).travel.low.value < 0.0
    with pytest.raises(hp.HardpointError, match=r"hp\.load"):
        hp.Study(str(path))
    with pytest.raises(hp.HardpointError, match="expected a Study or the path"):
        hp.solve(hp.solve(front))
    with pytest.raises(hp.StudyError, match="nowhere.toml"):
        hp.solve("nowhere.toml")


def test_residuals_travel_and_shorten_the_steps_of_scipy(front):
    import pickle

    scipy = pytest.importorskip("scipy.optimize")
    r = front.residuals()
    copy = pickle.loads(pickle.dumps(r))
    x = np.zeros(len(r.variables))
    np.testing.assert_array_equal(copy(x), r(x))
    assert len(r.rows) == len(r(x)) and set(r.rows) <= set(hp.solve(front))
    # A design outside the reach of the mechanism gives NaN; SciPy then tries a shorter step.
    far = np.full(len(x), 1e4)
    assert np.isnan(r(far)).all() and np.isnan(r.jacobian(far)).all()
    fit = scipy.least_squares(r, x, jac=r.jacobian, bounds=40 * r.bounds.T, max_nfev=20)
    assert fit.cost <= 0.5 * np.sum(r(x) ** 2)


# Studies of cars and studies with a subframe are left out.
OTHERS = ("\n[car]\n", "\n[subframe]\n")
SUSPENSIONS = [path for path in sorted(STUDIES.glob("*.toml")) if not any(key in path.read_text() for key in OTHERS)]


@pytest.mark.parametrize("path", SUSPENSIONS, ids=lambda path: path.stem)
def test_moved_points_are_those_of_the_text(path):
    """If only points change, the text is not read again. The result equals that of a study read from the new text."""
    study = hp.load(path)
    # The shear centre of a twist beam must stay in the middle of the car, so it is not moved.
    names = [name for name in study.points if name != "shear_centre"][:2]
    moved = study.replace(points={name: study[name] + [0.25, -0.5, 0.125] for name in names})
    read = hp.loads(moved.text, name=f"{moved.name}.toml", directory=path.parent)
    np.testing.assert_array_equal(moved.design, read.design)
    np.testing.assert_array_equal(moved[names[0]], study[names[0]] + [0.25, -0.5, 0.125])
    for motion in (None,):
        a, b = hp.solve(moved, motion=motion), hp.solve(read, motion=motion)
        for name in a:
            np.testing.assert_array_equal(a[name], b[name], err_msg=name)
    if "optimise" in study.to_dict():
        x = np.zeros(len(moved.residuals().variables))
        np.testing.assert_array_equal(moved.residuals()(x), read.residuals()(x))
    again = moved.replace(points={name: study[name] for name in names})
    assert again.text == study.text and (again == study)


def test_stations_of_an_axle_can_be_told_apart():
    study = hp.load(STUDIES / "macpherson_axle.toml")
    f, curves = study.function(["tie_rod_outer_dx"]), hp.solve(study)
    places = np.column_stack(list(f.motion.values()))
    assert len(np.unique(places, axis=0)) == curves.rows == f.shape[1]


def test_parquet_has_no_dictionaries_of_numbers(sweep_study, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    hp.sweep(sweep_study).to_parquet(tmp_path / "rows.parquet")
    columns = parquet.ParquetFile(tmp_path / "rows.parquet").metadata.row_group(0).to_dict()["columns"]
    for column in columns:
        if column["physical_type"] == "DOUBLE":
            assert not column["has_dictionary_page"] and "BYTE_STREAM_SPLIT" in column["encodings"], column


def test_the_lock_is_let_go(front):
    """Another thread keeps running while studies are read, targets prepared, schemas made and designs solved."""
    import threading
    import time

    travel = np.linspace(-80.0, 80.0, 4001).tolist()
    large = hp.load(STUDIES / "macpherson_front.toml", {"motion.travel": travel})
    calls = {
        "replace": lambda: large.replace({"motion.rack": 1.0}),
        "residuals": lambda: large.residuals()(np.zeros(len(large.variables))),
        "solve": lambda: hp.solve(large),
        "tune": lambda: hp.optimise(hp.load(STUDIES / "double_wishbone_robust.toml")),
        "read": lambda: hp.load(STUDIES / "macpherson_front.toml", {"motion.travel": travel}),
    }
    for name, call in calls.items():
        done, gaps = threading.Event(), []

        def tick(done=done, gaps=gaps):
            last = time.perf_counter()
            while not done.is_set():
                time.sleep(0.0005)
                now = time.perf_counter()
                gaps.append(now - last)
                last = now

        thread = threading.Thread(target=tick)
        thread.start()
        begun = time.perf_counter()
        call()
        took = time.perf_counter() - begun
        done.set()
        thread.join()
        # A call that kept the interpreter lock would cause one long gap.
        assert max(gaps) < max(0.7 * took, 0.1), f"{name}: {max(gaps):.3f} of {took:.3f} s"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="counts threads in /proc")
def test_numbers_of_threads_leave_none_behind(sweep_study):
    import os

    def count():
        return len(os.listdir("/proc/self/task"))

    hp.sweep(sweep_study, threads=1)
    before = count()
    for threads in range(2, 30):
        hp.sweep(sweep_study, threads=threads)
    assert count() <= before + (os.cpu_count() or 1)


def test_a_star_import_replaces_no_builtin():
    import builtins

    names = {}
    exec("from hardpoint import *", names)
    assert not set(names) & set(dir(builtins)) - {"__builtins__", "__doc__"}


def test_variables_that_overlap_are_refused(front):
    for pair in (["tie_rod_inner_z", "tie_rod_inner_dz"], ["tie_rod_inner_z"] * 2):
        with pytest.raises(hp.HardpointError, match="same coordinate"):
            front.function(pair)


def test_residuals_of_hostile_starts_let_scipy_end():
    """Starts far outside the ranges: NaN shortens the steps, and no exception ends the run."""
    scipy = pytest.importorskip("scipy.optimize")
    random = np.random.default_rng(0)
    ended = shortened = 0
    for name in ("macpherson_front", "five_link_rear"):
        r = hp.load(STUDIES / f"{name}.toml").residuals()
        bounds = 8 * r.bounds
        for _ in range(6):
            start = random.uniform(*(0.5 * bounds).T)
            if not np.isfinite(r(start)).all():
                continue
            seen = []

            def residuals(x, r=r, seen=seen):
                seen.append(np.isfinite(r(x)).all())
                return r(x)

            scale = np.ptp(r.bounds, axis=1)
            scipy.least_squares(residuals, start, jac=r.jacobian, bounds=bounds.T, x_scale=scale, max_nfev=20)
            ended += 1
            shortened += not all(seen)
    assert ended > 0


def test_a_study_of_its_dict_solves_alike(front):
    again = hp.Study.from_dict(front.to_dict())
    np.testing.assert_array_equal(hp.solve(again)["toe_deg"], hp.solve(front)["toe_deg"])
    with pytest.raises(KeyError, match="tie_rod_iner"):
        front["tie_rod_iner"]
