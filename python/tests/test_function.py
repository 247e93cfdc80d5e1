"""Curves as a pure function of the design, residuals, tunings, sweeps."""

import multiprocessing
import pickle
import threading
import time

import numpy as np
import pytest

import hardpoint as hp


def designs(f, n, seed=1):
    return np.random.default_rng(seed).uniform(*(0.3 * f.bounds.T), (n, len(f.variables)))


def test_values_are_the_curves_and_do_not_depend_on_company(front):
    f = front.function()
    curves = hp.solve(front)
    zero = np.zeros(len(f.variables))
    assert f.outputs == list(curves)
    for k, name in enumerate(f.outputs):
        np.testing.assert_allclose(f(zero)[k], curves[name], atol=1e-12)
    x = designs(f, 40)
    many = f(x, threads=1)
    np.testing.assert_array_equal(many, f(x, threads=2))
    np.testing.assert_array_equal(many[7], f(x[7]))
    np.testing.assert_array_equal(f.stations[:, 0], curves.drive)


@pytest.mark.parametrize("name", ["macpherson", "double_wishbone", "five_link", "semi_trailing_arm"])
def test_jacobians_are_derivatives(name):
    """Against differences of sixth order, of every characteristic that the template asks for."""
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
    for bad in (np.zeros(k + 1), np.zeros((2, 2, k)), np.zeros((0,)), np.float64(1.0)):
        with pytest.raises(hp.HardpointError, match="expected"):
            f(bad)
    with pytest.raises((TypeError, ValueError)):
        f(np.array(["a"] * k))
    with pytest.raises(hp.HardpointError, match="threads"):
        f(np.zeros(k), threads=0)
    with pytest.raises(hp.HardpointError, match="no variable"):
        front.function(["tie_rod_inner_dq"])
    for bad in (np.nan, np.inf, 1e300):
        x = np.full((2, k), bad)
        x[1] = 0.0
        values, status = f(x), f.status(x)
        assert np.isnan(values[0]).all() and not np.isnan(values[1]).any()
        assert f.words[status[0]] != "ok" and f.words[status[1]] == "ok"
    read_only = np.zeros((3, k))
    read_only.flags.writeable = False
    assert f(read_only).shape == (3, len(f.outputs), len(f.stations))
    assert f(np.asfortranarray(designs(f, 5))).shape[0] == 5
    assert f(np.zeros((0, k))).shape[0] == 0


def test_residuals_and_tuning_meet_in_one_minimum(front):
    scipy = pytest.importorskip("scipy.optimize")
    r = front.residuals
    x = np.zeros(len(r.names))
    values, jacobian = r.value_and_jacobian(x)
    assert jacobian.shape == (len(values), len(x))
    fit = scipy.least_squares(r, x, jac=r.jacobian, bounds=r.bounds.T, x_scale=np.ptp(r.bounds, axis=1))
    tuned = hp.optimise(front, threads=1)
    assert abs(np.sqrt(np.mean(fit.fun**2)) - tuned.misfit) < 1e-6 or tuned.misfit < 0.11
    again = hp.solve(tuned.study)
    assert again.status == ["ok"] * len(again.status)
    np.testing.assert_array_equal(tuned.x, hp.optimise(front, threads=2).x)
    with pytest.raises(hp.HardpointError):
        r(np.full(len(x), 1e6))


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
