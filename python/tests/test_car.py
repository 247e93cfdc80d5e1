"""Cars in this process: cases, sweeps, derivatives and tunings."""

import pickle

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES

CAR = STUDIES / "car.toml"


def short(tmp_path, more=""):
    """Study of the road car with few results, and with `more` as further sections."""
    for end in ("front", "rear"):
        name = f"car_{end}.toml"
        (tmp_path / name).write_bytes((STUDIES / name).read_bytes())
    text = CAR.read_text(encoding="utf-8")
    head, optimise = text[: text.index("[gg_map]")], text[text.index("[optimise]") :]
    results = (
        '[outputs]\ncharacteristics = ["roll", "wheel_load", "roll_gradient", "lateral_load_transfer_distribution"]\n'
    )
    path = tmp_path / "car.toml"
    path.write_text(head + results + more + optimise, encoding="utf-8")
    return path


def test_cases_are_those_of_the_program(tmp_path):
    car = hp.Car(CAR)
    cases = car.solve()
    assert cases.cases == car.cases
    assert cases.cases[0] == "static"
    hp.run(["solve", str(CAR), "--out", str(tmp_path / "run")])
    table = hp._hardpoint.read_tables([tmp_path / "run" / "cases.csv"])
    assert list(table["case"]) == list(cases.cases)
    for name in car.results:
        np.testing.assert_array_equal(cases[name], table[name])
    assert cases.of("turn")["ay_g"] == 0.8
    with pytest.raises(TypeError):
        cases["roll_deg"] = cases["roll_deg"]


def test_derivatives_are_those_of_differences(tmp_path):
    path = short(tmp_path)
    car = hp.Car(path)
    exact = car.derivatives()
    assert exact.shape == (len(car.cases), len(car.results), len(car.variables))
    bar = car.variables.index("front_anti_roll_bar_rate_N_mm_per_rad")
    step = 60.0

    def of(rate):
        cases = hp.Car(path, {"front.anti_roll_bar.rate": rate}).solve()
        return np.stack([cases[name] for name in car.results], axis=1)

    slope = (of(600_000.0 + step) - of(600_000.0 - step)) / (2 * step)
    undefined = np.isnan(exact[:, :, bar])
    # The distribution of load transfer is 0/0 if the car does not turn.
    assert undefined.sum() == 2
    scale = np.nanmax(np.abs(slope), axis=0)
    error = np.abs(slope - exact[:, :, bar]) / scale
    # The tolerance allows for central differences of loads of a few thousand newtons.
    assert np.nanmax(error) < 1e-5


def test_sweeps_are_those_of_the_program(tmp_path):
    sweep = (
        '[sweep]\nmethod = "sobol"\nsamples = 3\nvariables = [{ car = "cg_z", range = [540.0, 580.0] }, '
        '{ axle = "rear", hardpoint = "toe_link_inner", axis = "z", range = [-5.0, 5.0] }]\n'
    )
    path = short(tmp_path, sweep)
    seen = []
    swept = hp.Car(path).sweep(threads=1, progress=lambda done, all: seen.append((done, all)))
    assert swept.variables == ("car_cg_z_mm", "rear_toe_link_inner_dz_mm")
    assert seen[-1] == (3, 3)
    hp.run(["sweep", str(path), "--out", str(tmp_path / "run")])
    table = hp._hardpoint.read_tables([tmp_path / "run" / "designs.csv"])
    for name, values in swept.items():
        np.testing.assert_array_equal(values, table[name])


def test_tuned_cars_are_studies(tmp_path):
    path = short(tmp_path)
    car = hp.Car(path)
    tuned = car.optimise()
    assert tuned.success, tuned.message
    assert tuned.misfit < 0.1
    assert tuned.x.shape == (len(car.variables),)
    again = hp.Car(tuned.save(tmp_path / "tuned")).solve()
    assert again.of("turn")["lateral_load_transfer_distribution_percent"] == pytest.approx(48.0, abs=0.05)
    assert len(tuned.targets["output"]) == 3
    # The module and the program give the same side effects.
    assert hp.run(["--quiet", "optimise", str(path), "--out", str(tmp_path / "run")]) == 0
    effects = hp.read_run(tmp_path / "run").summary["side_effects"]
    frame = tuned.side_effects
    assert frame.rows == len(effects) > 10
    assert list(frame["output"]) == [effect["output"] for effect in effects]
    np.testing.assert_array_equal(frame["largest_change"], [effect["largest_change"] for effect in effects])
    assert set(frame["case"]) <= {*car.cases, ""}
    flagged = [name for name, is_flagged in zip(frame["output"], frame["flagged"], strict=True) if is_flagged]
    # A target for the roll gradient counts as a target for the roll, too. So neither of them is a side effect.
    assert "camber_to_road" in flagged and not {"roll", "roll_gradient"} & set(flagged)


def test_mistakes_have_their_place(tmp_path):
    path = short(tmp_path)
    path.write_text(path.read_text().replace("wheelbase = ", "wheelbas = "), encoding="utf-8")
    with pytest.raises(hp.StudyError) as caught:
        hp.Car(path)
    assert caught.value.line is not None
    with pytest.raises(hp.HardpointError, match=r"\[sweep\]"):
        hp.Car(STUDIES / "formula_student_car.toml").sweep()
    with pytest.raises(hp.StudyError, match="study of a car"):
        hp.load(CAR)


def test_cars_without_equilibrium_have_a_status(tmp_path):
    path = short(tmp_path)
    path.write_text(path.read_text().replace("ay = 0.8", "ay = 3.5"), encoding="utf-8")
    cases = hp.Car(path).solve()
    turn = cases.cases.index("turn")
    assert hp.STATUS[cases.status[turn]] in ("no_equilibrium", "unstable")
    assert cases.reasons[turn]
    assert np.isnan(cases["roll_deg"][turn])


def test_cars_are_pickled_with_their_overrides():
    car = hp.Car(CAR, {"car.wheelbase": 2700.0})
    again = pickle.loads(pickle.dumps(car))
    np.testing.assert_array_equal(again.solve()["roll_deg"], car.solve()["roll_deg"])
    assert repr(car) == "<hardpoint.Car 'car': 5 cases>"


def test_a_car_is_taken_by_the_functions_of_studies(tmp_path):
    path = short(tmp_path, '[tolerance]\nbuilds = 64\nscatter = [{ car = "cg_z", sigma = 5.0 }]\n')
    car = hp.Car(path)
    np.testing.assert_array_equal(hp.solve(car)["roll_deg"], car.solve()["roll_deg"])
    np.testing.assert_array_equal(hp.optimise(car).x, car.optimise().x)
    assert isinstance(hp.check(car), list)
    assert hp.limits(car).rows > 0
    scattered = hp.tolerance(car)
    assert set(scattered) == {"tolerance", "contributors"} and scattered.summary["builds"] == 64
    compared = hp.compare(before=car, after=hp.Car(path, {"front.anti_roll_bar.rate": 500_000.0}))
    assert set(compared) == {"comparison", "changes"}
    for wrong in (lambda: hp.solve(car, motion="x"), lambda: hp.sweep(car, [[1.0]]), lambda: hp.setup(car)):
        with pytest.raises((hp.HardpointError, TypeError)):
            wrong()


def test_a_car_from_numbers_is_that_of_its_file(tmp_path):
    import tomllib

    of_file = hp.Car(CAR)
    sections = tomllib.loads(of_file.text)
    own = {key: value for key, value in sections.pop("car").items() if key not in ("front", "rear")}
    made = hp.Car.of(of_file.front, of_file.rear, own, **sections)
    assert made.cases == of_file.cases and made.results == of_file.results
    again = pickle.loads(pickle.dumps(made))
    for car in (made, again):
        solved, expected = hp.solve(car), of_file.solve()
        for name in expected:
            np.testing.assert_array_equal(solved[name], expected[name])
    with pytest.raises(hp.StudyError, match="wheelbas"):
        hp.Car.of(of_file.front, of_file.rear, {**own, "wheelbas": 1.0})
    with pytest.raises(hp.HardpointError, match="car.front"):
        hp.limits(hp.Study.from_dict(made.front.to_dict())) and hp.setup(made)
