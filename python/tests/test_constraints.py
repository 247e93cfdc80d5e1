"""Constraints for other optimisers, studies of moved designs, and limits of builds."""

import csv
import pickle

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES


@pytest.fixture(scope="module")
def steering():
    return hp.load(STUDIES / "macpherson_steering.toml")


def test_constraints_are_margins_with_exact_derivatives(steering):
    r = steering.residuals()
    x = 0.1 * r.bounds[:, 1] * np.resize([1.0, -1.0, 0.5], len(r.variables))
    moved = r.study(x)
    length = np.linalg.norm(moved["tie_rod_inner"] - moved["tie_rod_outer"])
    margins = dict(zip(r.constraint_rows, r.constraints(x), strict=True))
    rod = {name: margin for name, margin in margins.items() if name.startswith("length tie_rod ")}
    assert sorted(rod.values()) == pytest.approx(sorted([length - 345.0, 375.0 - length]), abs=1e-9)
    jacobian = r.constraint_jacobian(x)
    h = 1e-3
    for k, e in enumerate(h * np.eye(len(x))):
        difference = (8 * (r.constraints(x + e) - r.constraints(x - e)) - (r.constraints(x + 2 * e) - r.constraints(x - 2 * e))) / (
            12 * h
        )
        np.testing.assert_allclose(jacobian[:, k], difference, atol=1e-7 * np.abs(jacobian).max(), err_msg=r.variables[k])
    copy = pickle.loads(pickle.dumps(r))
    np.testing.assert_array_equal(copy.constraints(x), r.constraints(x))
    plain = hp.load(STUDIES / "macpherson_front.toml").residuals()
    assert plain.constraints(np.zeros(len(plain.variables))).shape == (0,) and plain.scipy_constraints() == []


def test_equalities_come_first_and_have_both_signs(steering):
    kept = {"length": ["lower_ball_joint", "tie_rod_outer"], "kept": True}
    r = steering.replace({"optimise.constraints": [{"length": "tie_rod", "at_most": 375.0}, kept]}).residuals()
    assert r.equalities == 1 and "upper limit" in r.constraint_rows[1]
    k = r.variables.index("tie_rod_outer_dx")
    ends = []
    for sign in (-1.0, 1.0):
        x = np.zeros(len(r.variables))
        x[k] = sign * 2.0
        ends.append(r.constraints(x)[0])
    assert ends[0] * ends[1] < 0.0 and abs(r.constraints(np.zeros(len(r.variables)))[0]) < 1e-9
    assert [part["type"] for part in r.scipy_constraints()] == ["eq", "ineq"]


def test_slsqp_finds_no_less_than_the_constrained_tuning(steering):
    """With good_enough = 0, the tuning of the study searches for the same minimum as SciPy."""
    scipy = pytest.importorskip("scipy.optimize")
    tight = {"length": "tie_rod", "between": [362.0, 375.0]}
    study = steering.replace({"optimise.constraints": [tight], "optimise.good_enough": 0.0, "optimise.starts": 1})
    r = study.residuals()

    def cost(x):
        value, jacobian = r.value_and_jacobian(x)
        return 0.5 * value @ value, value @ jacobian

    x0 = np.zeros(len(r.variables))
    constraints, options = r.scipy_constraints(), {"maxiter": 300, "ftol": 1e-12}
    found = scipy.minimize(cost, x0, jac=True, method="SLSQP", bounds=r.bounds, constraints=constraints, options=options)
    assert r.constraints(found.x).min() > -1e-6
    misfit = np.sqrt(np.mean(r(found.x) ** 2))
    assert misfit == pytest.approx(hp.optimise(study, front=False).misfit, rel=1e-3, abs=1e-3)


@pytest.mark.parametrize("name", ["macpherson_front", "macpherson_axle_front", "five_link_axle_rear"])
def test_the_study_of_a_design_is_that_of_its_offsets(name):
    study = hp.load(STUDIES / f"{name}.toml")
    r, f = study.residuals(), study.function()
    x = 0.05 * np.ptp(r.bounds, axis=1)
    moved = r.study(x)
    np.testing.assert_allclose(moved.residuals()(np.zeros(len(x))), r(x), atol=1e-9)
    curves = hp.solve(f.study(x))
    np.testing.assert_allclose(f(x), [curves[name] for name in f.outputs], rtol=1e-9, atol=1e-9)
    again = hp.loads(moved.text, name=f"{moved.name}.toml", directory=STUDIES)
    np.testing.assert_array_equal(again.design, moved.design)
    for wrong in (np.zeros(len(x) + 1), np.full(len(x), np.nan), np.zeros((2, len(x)))):
        with pytest.raises(hp.HardpointError):
            f.study(wrong)
        with pytest.raises(hp.HardpointError):
            r.study(wrong)


@pytest.mark.parametrize("name, quantity", [("macpherson_tolerance", "travel"), ("five_link_axle_tolerance", "left_travel")])
def test_limits_of_builds_are_those_of_each_build(name, quantity):
    path = STUDIES / f"{name}.toml"
    study, count = hp.load(path), 12
    nearest = hp.limits(study, builds=count)
    assert nearest.rejected == 0
    each = [hp.limits(study.built(number))[quantity] for number in range(count)]
    lows, highs = [e.low.value for e in each], [e.high.value for e in each]
    extent = nearest[quantity]
    assert extent.low.build == int(np.argmax(lows)) and extent.high.build == int(np.argmin(highs))
    assert extent.low.value == pytest.approx(max(lows), abs=1e-6) and extent.high.value == pytest.approx(min(highs), abs=1e-6)
    one = hp.limits(study, builds=count, threads=1)
    assert {name: one[name] for name in one} == {name: nearest[name] for name in nearest}
    seen = []
    hp.limits(study, 5, progress=lambda done, of: seen.append((done, of)))
    assert seen[-1] == (5, 5)
    with pytest.raises(hp.HardpointError, match="builds is 0"):
        hp.limits(study, 0)


def test_limits_of_builds_are_those_of_the_program(tmp_path, capfd):
    path = STUDIES / "macpherson_tolerance.toml"
    assert hp.run(["limits", path, "--builds", "40", "--format", "csv"]) == 0
    lines = capfd.readouterr().out.splitlines()
    row = next(row for row in csv.reader(lines) if row[:1] == ["limits"] and "travel" in row[1])
    found = hp.limits(path, builds=40).travel
    numbers = [float(cell) for cell in row[3:] if cell]
    assert any(abs(number - found.low.value) < 1e-3 for number in numbers), (row, found)
    assert any(abs(number - found.high.value) < 1e-3 for number in numbers), (row, found)
    assert str(found.low.build) in row and str(found.high.build) in row


def test_limits_need_a_tolerance(front):
    with pytest.raises(hp.HardpointError, match="tolerance"):
        hp.limits(front, builds=3)
