"""All results are the same kind of mapping, whichever call made them."""

import pickle

import numpy as np
import pytest

import hardpoint as hp
from conftest import STUDIES


@pytest.fixture
def frames(front, sweep_study):
    tuned = hp.optimise(front)
    return [hp.solve(front), hp.sweep(sweep_study), tuned.targets, tuned.moves, tuned.history, hp.assemblies(front)]


def test_frames_are_dicts_of_read_only_arrays_of_one_length(frames):
    for frame in frames:
        assert isinstance(frame, hp.Frame) and isinstance(frame, dict) and frame.rows > 0
        assert {len(values) for values in frame.values()} == {frame.rows} == {len(frame.status)} == {len(frame.reasons)}
        assert set(frame.info) == set(frame) and all(name.startswith(c.output) for name, c in frame.info.items())
        name = next(iter(frame))
        for change in (
            lambda: frame.update(a=1),
            lambda: frame.__setitem__(name, 1),
            lambda: frame.__delitem__(name),
            lambda: frame.clear(),
            lambda: frame.pop(name),
            lambda: frame.setdefault("a", 1),
        ):
            with pytest.raises(TypeError, match="cannot be changed"):
                change()
        with pytest.raises(ValueError, match="read-only"):
            frame[name][0] = frame[name][0]
        assert frame == frame and len({frame, frame}) == 1
        copy = pickle.loads(pickle.dumps(frame))
        assert copy != frame and type(copy) is type(frame) and list(copy) == list(frame)
        for column in frame:
            np.testing.assert_array_equal(copy[column], frame[column])
        assert copy.reasons == frame.reasons and not copy.status.flags.writeable
        assert frame._ipython_key_completions_() == list(frame)
        assert frame._repr_html_().count("<th>") == len(frame) and repr(frame).startswith("<hardpoint.")


def test_frames_go_to_pandas_xarray_polars_and_parquet(frames, tmp_path):
    pandas = pytest.importorskip("pandas")
    for frame in frames:
        table = pandas.DataFrame(frame)
        assert list(table.columns) == list(frame) and len(table) == frame.rows
    curves = frames[0]
    assert curves.to_pandas().index.name == "travel_mm" and curves.to_pandas(index=None).shape == (curves.rows, len(curves))
    parquet = pytest.importorskip("pyarrow.parquet")
    for frame in frames:
        frame.to_parquet(tmp_path / "rows.parquet")
        back = parquet.read_table(tmp_path / "rows.parquet")
        for name in frame:
            if frame[name].dtype.kind == "f":
                np.testing.assert_array_equal(back[name].to_numpy(), frame[name])
    xarray = pytest.importorskip("xarray")
    data = curves.to_xarray()
    assert isinstance(data, xarray.Dataset) and data["camber_deg"].attrs["units"] == "deg"
    np.testing.assert_array_equal(data["travel_mm"], curves.drive)


def test_a_plot_has_a_line_for_each_column(front):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    ax = hp.solve(front).plot("camber_deg", "toe_deg", ax=Figure().subplots())
    assert [line.get_label() for line in ax.lines] == ["camber_deg", "toe_deg"] and ax.get_xlabel() == "travel_mm"
    with pytest.raises(hp.HardpointError, match="no column"):
        hp.solve(front).plot("cambr_deg")


def test_named_motions_have_curves():
    study = hp.load(STUDIES / "macpherson_front.toml", {"motions.steer": {"travel": 0.0, "rack": [-10.0, 0.0, 10.0]}})
    assert study.motions == ["steer"]
    curves = hp.solve(study, motion="steer")
    assert curves.rows == 3 and list(curves.motion) == ["travel_mm", "rack_mm"]
    with pytest.raises(hp.HardpointError, match="no motion 'bump'|no motion \"bump\""):
        hp.solve(study, motion="bump")


def test_every_word_of_a_status_has_a_code():
    codes = (STUDIES.parent / "docs" / "formats.md").read_text(encoding="utf-8")
    for code, word in enumerate(hp.STATUS):
        assert f"| {code} | `{word}` |" in codes


def test_results_are_tables_in_notebooks(front):
    tuned = hp.optimise(front)
    study = hp.load(STUDIES / "macpherson_tolerance.toml", {"tolerance.builds": 256})
    shown = {
        "study": (front, front.points),
        "limits": (hp.limits(front), ["travel", hp.limits(front).travel.low.cause]),
        "tuning": (tuned, ["success", *tuned.variables]),
        "setup": (hp.setup(study), ["setup", "effects"]),
    }
    for name, (result, words) in shown.items():
        html = result._repr_html_()
        assert html.count("<table>") >= 1 and html.count("<table>") == html.count("</table>"), name
        assert all(word in html for word in words), name
