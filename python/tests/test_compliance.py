"""Studies with elastic parts."""

import csv
import math

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES

STUDY = STUDIES / "double_wishbone_compliance.toml"


def of(frame, quantity, column="value"):
    """Result of the rig test whose force has no trail."""
    rows = (frame["quantity"] == quantity) & ~(frame["trail_mm"] > 0.0)
    (value,) = frame[column][rows]
    return value


def test_tests_of_a_rig_are_frames():
    found = hp.kc(STUDY)
    assert set(found) == {"kc", "levels", "compliance_matrix"}
    assert found.summary["design_load_N"] == pytest.approx(4682.0, abs=1.0)
    assert not found.summary["is_rigid"]
    # The secant at the station is the slope between the smallest and the largest load level.
    levels = found["levels"]
    rows = (levels["load"] == "lateral") & (levels["trail_mm"] == 0.0)
    toe, force = levels["toe_deg"][rows], levels["force_N"][rows]
    secant = (toe[-1] - toe[0]) / (force[-1] - force[0]) * 1000.0
    assert of(found["kc"], "toe_by_lateral_force", "secant") == pytest.approx(secant, rel=1e-9)
    assert of(found["kc"], "toe_by_lateral_force") == pytest.approx(secant, rel=0.05)
    matrix = np.array([found["compliance_matrix"][f] for f in ("fx", "fy", "fz", "mx", "my", "mz")])
    np.testing.assert_allclose(matrix, matrix.T, rtol=1e-9, atol=1e-15)


def test_an_elastic_axle_is_tested(tmp_path):
    path = STUDIES / "subframe_axle_compliance.toml"
    found = hp.kc(path)
    kc = found["kc"]
    rows = (kc["quantity"] == "toe_by_lateral_force") & (kc["mode"] == "opposed")
    left, right = (kc["value"][rows & (kc["wheel"] == side)] for side in ("left", "right"))
    np.testing.assert_allclose(left, right, rtol=1e-9)
    # If a subframe mount is ten times as soft, the toe of both wheels changes, by the same amount.
    soft = hp.kc(path, {"bushings.subframe_rear.stiffness": [300.0, 400.0, 250.0, 2e4, 3e4, 2e4]})["kc"]["value"]
    softer = [soft[rows & (kc["wheel"] == side)] for side in ("left", "right")]
    np.testing.assert_allclose(*softer, rtol=1e-9)
    assert (np.abs(softer[0] - left) > 1e-3 * np.abs(left)).all()
    saved = found.save(tmp_path / "kc")
    assert (saved / "study.toml").read_text() == path.read_text()
    assert found.report(tmp_path / "page.html").stat().st_size > 10_000


AXLE = """
[outputs]
characteristics = ["toe", "toe_by_lateral_force_trail_30"]

[sweep]
method = "sobol"
samples = 5
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-3.0, 3.0] },
  { bushing = "subframe_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
]

[optimise]
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
]
targets = [
  { characteristic = "toe", over = "heave", at = 30.0, value = 0.15, tolerance = 0.01 },
  { figure = "toe_by_lateral_force_trail_30", value = -0.01, tolerance = 0.001 },
]
"""


def test_every_function_takes_an_elastic_axle():
    study = hp.loads((STUDIES / "subframe_axle_compliance.toml").read_text() + AXLE)
    figure = "left_toe_by_lateral_force_trail_30_deg_per_kN"
    kc = hp.kc(study)["kc"]
    rows = (kc["quantity"] == "toe_by_lateral_force") & (kc["mode"] == "parallel") & (kc["wheel"] == "left")
    curves = hp.solve(study)
    np.testing.assert_allclose(curves[figure][curves.drive == 0.0], kc["value"][rows & (kc["travel_left_mm"] == 0.0)], rtol=1e-12)
    swept = hp.sweep(study)
    alone = hp.solve(study.swept(3))
    name = figure.replace("_deg_per_kN", "_design_deg_per_kN")
    np.testing.assert_allclose(swept[name][3], alone[figure][alone.drive == 0.0], rtol=1e-9)
    tuned = hp.optimise(study)
    assert tuned.success
    figures = hp.solve(tuned.study)[figure]
    # The tuned design meets the targets within the tolerances.
    np.testing.assert_allclose(figures[1], -0.01, atol=0.001)


RATES = """
[outputs]
characteristics = ["toe_by_lateral_force"]

[sweep]
method = "sobol"
samples = 3
variables = [
  { bushing = "lower_arm_rear", stiffness = "y", range = [0.5, 2.0], relative = true },
  { bushing = "upper_arm_front", stiffness = "tx", range = [3.0e4, 9.0e4] },
]
"""


def test_given_rows_may_have_several_rates():
    study = hp.loads(STUDY.read_text() + RATES)
    swept = hp.sweep(study)
    x = np.column_stack([swept[name] for name in swept.variables])
    again = hp.sweep(study, x, variables=study.sweep_variables)
    for name in swept:
        np.testing.assert_array_equal(again[name], swept[name], err_msg=name)


def test_names_of_other_programs_stand_beside_ours():
    table = hp.kc(STUDY, names="altair")["kc"]
    rows = table["other_name"] == "Aligning Torque Steer"
    assert rows.sum() == 1
    assert np.sign(table["other_value"][rows]) == -np.sign(table["value"][rows])
    with pytest.raises(hp.HardpointError, match="adams"):
        hp.kc(STUDY, names="lotus")


def test_curves_are_those_of_equilibria():
    asked = '\n[outputs]\ncharacteristics = ["toe", "toe_by_lateral_force"]\n'
    curves = hp.solve(hp.loads(STUDY.read_text() + asked))
    assert curves.outputs == ("toe_deg", "toe_by_lateral_force_deg_per_kN")
    middle = np.flatnonzero(curves.drive == 0.0)[0]
    assert curves["toe_by_lateral_force_deg_per_kN"][middle] == pytest.approx(of(hp.kc(STUDY)["kc"], "toe_by_lateral_force"))


def limits_of_the_program(capfd, *arguments):
    """Rows of `hardpoint limits`, by quantity and the fixed positions of the other quantities."""
    capfd.readouterr()
    assert hp.run(["limits", *arguments, "--format", "csv"]) == 0
    rows = [row[1:] for row in csv.reader(capfd.readouterr().out.splitlines()) if row[:1] == ["limits"]]
    return {tuple(row[:2]): row[2:] for row in rows}


@pytest.mark.parametrize(
    "name, travel, load",
    [("double_wishbone_compliance", "travel", "lateral_N"), ("subframe_axle_compliance", "heave", "aligning_N_m")],
)
def test_limits_of_elastic_parts_are_those_of_the_program(name, travel, load, capfd):
    path = STUDIES / f"{name}.toml"
    limits, table = hp.limits(hp.load(path)), limits_of_the_program(capfd, path)
    for quantity, row in (travel, f"{travel}_mm"), (load, load):
        low, cause, high, its_cause = next(row_ for (of, at), row_ in table.items() if of == row and "rigid" not in at)
        extent = limits[quantity]
        assert (extent.low.cause, extent.high.cause) == (cause, its_cause)
        for end, cell in (extent.low, low), (extent.high, high):
            assert math.isnan(end.value) == (cell == "")
            assert cell == "" or end.value == pytest.approx(float(cell), abs=1e-3)
    assert any("gives way" in end.cause or "unstable" in end.cause for e in limits.values() if e for end in (e.low, e.high))


def test_limits_of_builds_with_elastic_parts(capfd, tmp_path):
    text = STUDY.read_text() + '\n[tolerance]\nscatter = [{ hardpoint = "lower_ball_joint", axis = "z", limits = [-2.0, 2.0] }]\n'
    study, count = hp.loads(text), 4
    nearest, each = hp.limits(study, builds=count), [hp.limits(study.built(k)) for k in range(count)]
    assert nearest.rejected == 0
    lows, highs = [e.travel.low.value for e in each], [e.travel.high.value for e in each]
    assert (nearest.travel.low.value, nearest.travel.high.value) == pytest.approx((max(lows), min(highs)), abs=1e-6)
    assert nearest.travel.low.build == lows.index(max(lows)) and nearest.travel.high.build == highs.index(min(highs))


@pytest.mark.parametrize("call", [hp.assemblies, lambda study: study.function()])
def test_what_is_of_the_rigid_mechanism_is_refused(call):
    with pytest.raises(hp.HardpointError, match="compliance"):
        call(hp.load(STUDY))
