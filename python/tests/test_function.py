"""Curves as a pure function of the design, residuals, tunings, sweeps."""

import multiprocessing
import pickle
import threading
import time
import tomllib

import numpy as np
import pytest

import hardpoint as hp


def designs(f, n, seed=1):
    return np.random.default_rng(seed).uniform(*(0.3 * f.bounds.T), (n, len(f.variables)))


def test_values_are_the_curves_and_do_not_depend_on_company(front):
    f = front.function()
    curves = hp.solve(front)
    zero = np.zeros(len(f.variables))
    assert f.outputs == list(curves.outputs)
    for k, name in enumerate(f.outputs):
        np.testing.assert_allclose(f(zero)[k], curves[name], atol=1e-12)
    x = designs(f, 40)
    many = f(x, threads=1)
    np.testing.assert_array_equal(many, f(x, threads=2))
    np.testing.assert_array_equal(many[7], f(x[7]))
    assert f.shape == (len(curves.outputs), curves.rows) and list(f.motion) == list(curves.motion)
    np.testing.assert_array_equal(f.motion["travel_mm"], curves.drive)


@pytest.mark.parametrize("name", ["macpherson", "double_wishbone", "five_link", "semi_trailing_arm"])
def test_jacobians_are_derivatives(name):
    """Jacobians agree with difference quotients of sixth order, for every characteristic that the template requests."""
    study = hp.loads(hp.template(name), {"motion.travel": [-20.0, 0.0, 30.0]})
    names = [f"{study.points[0]}_dz", f"{study.points[-1]}_dy", "wheel_centre_dx"]
    f = study.function(sorted(set(names)))
    x = np.zeros(len(f.variables))
    _, jacobian = f.value_and_jacobian(x)
    h = 0.05
    for k in range(len(x)):
        e = np.eye(len(x))[k] * h
        difference = sum(c * (f(x + m * e) - f(x - m * e)) for m, c in ((1, 45), (2, -9), (3, 1))) / (60 * h)
        scale = np.nanmax(np.abs(jacobian), axis=(1, 2), keepdims=True)[:, :, 0] + 1e-9
        assert np.nanmax(np.abs(jacobian[:, :, k] - difference) / scale) < 1e-8, f.variables[k]


def test_hostile_arrays_are_exceptions(front):
    f = front.function()
    k = len(f.variables)
    words, nested, complex_ = np.array(["a"] * k), [[0.0], [0.0, 1.0]], np.full(k, 1j)
    shapes = np.zeros(k + 1), np.zeros((2, 2, k)), np.zeros((0,)), np.float64(1.0), np.zeros((k, 0)), [], {}
    for bad in (*shapes, words, nested, complex_, "text", None):
        for call in (f, f.value_and_jacobian, f.status):
            with pytest.raises(hp.HardpointError, match="expected"):
                call(bad)
        with pytest.raises(hp.HardpointError, match="expected"):
            hp.sweep(front, bad if bad is not None else words)
    for threads in (0, -1, 2**70):
        with pytest.raises((hp.HardpointError, OverflowError)):
            f(np.zeros(k), threads=threads)
    # The result would be larger than the address space.
    huge = np.broadcast_to(np.zeros(k), (2**40, k))
    with pytest.raises((MemoryError, hp.HardpointError)):
        f(huge)
    for name in ("tie_rod_inner_dq", "", "tie_rod_inner_dz\0", "x" * 10_000):
        with pytest.raises(hp.HardpointError, match="no variable"):
            front.function([name])
    with pytest.raises(hp.HardpointError, match="did you mean tie_rod_inner_dz"):
        front.function(["tie_rod_iner_dz"])
    for bad in (np.nan, np.inf, -np.inf, 1e300, 1e150):
        x = np.full((2, k), bad)
        x[1] = 0.0
        values, status = f(x), f.status(x)
        assert np.isnan(values[0]).all() and not np.isnan(values[1]).any()
        y, jacobian = f.value_and_jacobian(x)
        assert np.isnan(y[0]).all() and np.isnan(jacobian[0]).all() and not np.isnan(jacobian[1]).any()
        assert hp.STATUS[status[0]] == "degenerate" and status[1] == 0
    read_only = np.zeros((3, k))
    read_only.flags.writeable = False
    assert f(read_only).shape == (3, *f.shape)
    assert f(np.asfortranarray(designs(f, 5))).shape[0] == 5
    assert f(np.zeros((0, k))).shape[0] == 0
    # The function accepts every number type, all strides, and both byte orders.
    exact = f(np.ones((4, k)))
    for same in (np.ones((4, k), np.int8), np.ones((4, k), ">f8"), np.ones((8, 2 * k))[::2, ::2], [[1] * k] * 4):
        np.testing.assert_array_equal(f(same), exact)


def test_values_and_jacobians_are_found_together(front):
    """A design alone has the same results as among other designs. If one station has no pose, the others keep their values."""
    study = front.replace({"motion.travel": [-60.0, 0.0, 60.0, 5000.0]})
    for f in (front.function(), study.function()):
        x = designs(f, 37)
        y, jacobian = f.value_and_jacobian(x)
        np.testing.assert_allclose(y, f(x), atol=1e-11)
        np.testing.assert_array_equal(np.isnan(y), np.isnan(f(x)))
        np.testing.assert_array_equal(y, f.value_and_jacobian(x, threads=1)[0])
        for n in (0, 8, 36):
            one, derivatives = f.value_and_jacobian(x[n])
            np.testing.assert_array_equal(one, y[n])
            np.testing.assert_array_equal(derivatives, jacobian[n])
    assert np.isnan(y[:, :, 3]).all() and not np.isnan(y[:, :, :3]).any()
    assert hp.STATUS[f.status(x)[0]] == "incomplete"


def test_coordinates_offsets_and_turns_are_variables(front):
    k = front.points.index("tie_rod_inner")
    z = front.design[k, 2]
    offset, coordinate = front.function(["tie_rod_inner_dz"]), front.function(["tie_rod_inner_z"])
    a, b = offset.value_and_jacobian([2.5]), coordinate.value_and_jacobian([z + 2.5])
    np.testing.assert_allclose(a[0], b[0], atol=1e-11)
    np.testing.assert_allclose(a[1], b[1], atol=1e-11)
    names = ["lower_arm_front", "lower_arm_rear", "lower_ball_joint"]
    turned = front.replace({"optimise.variables": [{"rigid": names, "turn": 2.0, "shift": 5.0}]})
    f = turned.function()
    assert len(set(f.variables)) == 6 and any("turn" in name for name in f.variables)
    assert turned.residuals().variables == f.variables
    x = np.array([0.3, -0.2, 0.5, 0.4, -0.3, 0.2])
    _, jacobian = f.value_and_jacobian(x)
    h = 1e-2
    for k in range(6):
        e = np.eye(6)[k] * h
        difference = sum(c * (f(x + m * e) - f(x - m * e)) for m, c in ((1, 45), (2, -9), (3, 1))) / (60 * h)
        np.testing.assert_allclose(jacobian[:, :, k], difference, atol=1e-8 * np.nanmax(np.abs(jacobian)))


def test_a_sweep_of_given_designs(sweep_study, front):
    rows = hp.sweep(sweep_study)
    count = len(tomllib.loads(sweep_study.text)["sweep"]["variables"])
    names = [name.removesuffix("_mm") for name in list(rows)[:count]]
    x = np.column_stack([rows[f"{name}_mm"] for name in names])
    again = hp.sweep(sweep_study, x, variables=names)
    for name in rows:
        np.testing.assert_array_equal(again[name], rows[name], err_msg=name)
    # Without [sweep], the study uses the variables of [optimise].
    given = hp.sweep(front, designs(front.function(), 20))
    assert len(given["misfit"]) == 20 and len(given.failed) == 0
    for call in (front.function, lambda names: hp.sweep(front, np.zeros((2, 2)), variables=names)):
        for names in (["strut_top_y", "strut_top_dy"], ["strut_top_dy", "strut_top_y"], ["strut_top_dy"] * 2):
            with pytest.raises(hp.HardpointError, match="same coordinate"):
                call(names)
    with pytest.raises(hp.HardpointError, match="no x"):
        hp.sweep(front, variables=["strut_top_y"])
    impossible = designs(front.function(), 3)
    impossible[1] = 1e6
    found = hp.sweep(front, impossible)
    assert list(found.failed) == [1] and np.isnan(found["misfit"][1]) and found.reasons[1]


def test_tables_go_to_polars_and_parquet(sweep_study, tmp_path):
    rows = hp.sweep(sweep_study)
    parquet = pytest.importorskip("pyarrow.parquet")
    rows.to_parquet(tmp_path / "rows.parquet")
    back = parquet.read_table(tmp_path / "rows.parquet")
    assert back.column_names == list(rows)
    np.testing.assert_array_equal(back["misfit"].to_numpy(), rows["misfit"])
    polars = pytest.importorskip("polars")
    assert polars.DataFrame(rows).shape == (300, len(rows))


def test_residuals_and_tuning_meet_in_one_minimum(front):
    scipy = pytest.importorskip("scipy.optimize")
    front = front.replace({"optimise.good_enough": 0.0})
    r = front.residuals()
    x = np.zeros(len(r.variables))
    values, jacobian = r.value_and_jacobian(x)
    assert jacobian.shape == (len(values), len(x))
    fit = scipy.least_squares(r, x, jac=r.jacobian, bounds=r.bounds.T, x_scale=np.ptp(r.bounds, axis=1))
    tuned = hp.optimise(front, threads=1)
    assert abs(np.sqrt(np.mean(fit.fun**2)) - tuned.misfit) < 1e-7
    again = hp.solve(tuned.study)
    assert tuned.success and not again.status.any()
    np.testing.assert_array_equal(tuned.x, hp.optimise(front, threads=2).x)
    assert np.isnan(r(np.full(len(x), 1e6))).all() and np.isnan(r(np.full(len(x), np.nan))).all()
    with pytest.raises(hp.HardpointError):
        front.residuals("raise")(np.full(len(x), 1e6))


def test_a_sweep_has_the_rows_of_the_program(sweep_study, tmp_path):
    import csv

    path = tmp_path / "study.toml"
    path.write_text(sweep_study.text)
    assert hp.run(["--quiet", "sweep", path, "--out", tmp_path / "out"]) == 0
    rows = hp.sweep(sweep_study)
    with open(tmp_path / "out" / "designs.csv", newline="") as file:
        written = list(csv.DictReader(file))
    assert len(written) == 300 and len(rows.failed) == 0
    for name in rows:
        np.testing.assert_array_equal(rows[name], [float(row[name]) for row in written], err_msg=name)


def test_tables_share_memory(sweep_study):
    pandas = pytest.importorskip("pandas")
    rows = hp.sweep(sweep_study)
    table = rows.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == 300
    name = list(rows)[0]
    assert np.shares_memory(table[name].to_numpy(), rows[name])


def test_functions_travel_and_the_lock_is_let_go(front):
    f = front.function()
    x = designs(f, 2000)
    copy = pickle.loads(pickle.dumps(f))
    np.testing.assert_array_equal(copy(x[:3]), f(x[:3]))
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    f(x, threads=1)
    done.set()
    thread.join()
    assert counted[0] > 10


def _child(text):
    study = hp.loads(text)
    f = study.function()
    return float(np.nansum(f(np.zeros(len(f.variables))))), hp.optimise(study).misfit


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_forked_and_spawned_children_work(front, method):
    mine = _child(front.text)
    with multiprocessing.get_context(method).Pool(1) as pool:
        assert pool.apply_async(_child, (front.text,)).get(timeout=120) == mine
