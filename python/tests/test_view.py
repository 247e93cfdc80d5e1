"""Effects of the sliders of hp.view, tested without a browser."""

import json

import numpy as np
import pytest

import hardpoint as hp
from hardpoint import _hardpoint


def test_sliders_move_the_study_and_its_curves(front):
    pytest.importorskip("anywidget")
    view = hp.view(front, ["tie_rod_inner_dz", "strut_top_y"], columns=["toe_deg"])
    assert view.offsets == [0.0, front["strut_top"][1]] and view.curves == view.nominal
    json.dumps([view.bounds, view.curves, view.drawing], allow_nan=False)
    place = front["strut_top"][1] + 2.0
    view.offsets = [3.0, place]
    moved = front.replace(
        points={
            "tie_rod_inner": front["tie_rod_inner"] + [0.0, 0.0, 3.0],
            "strut_top": front["strut_top"] + [0.0, 2.0, 0.0],
        }
    )
    np.testing.assert_allclose(view.study.design, moved.design, atol=1e-12)
    np.testing.assert_allclose(view.curves["y"]["toe_deg"], hp.solve(moved)["toe_deg"], atol=1e-9)
    assert view.error == "" and view.nominal["y"]["toe_deg"] != view.curves["y"]["toe_deg"]
    before = view.curves
    view.offsets = [1e6, place]
    assert view.error or view.curves != before
    with pytest.raises(hp.HardpointError, match="no output"):
        hp.view(front, columns=["toe"])


def test_the_drawing_is_the_mechanism_along_its_motion(front):
    drawing = json.loads(_hardpoint.drawing(front._study))
    assert drawing["scene"]["points"] == front.points and len(drawing["frames"]) > 5
    at_design = min(drawing["frames"], key=lambda frame: abs(frame["drive"]))
    assert at_design["drive"] == 0.0
    np.testing.assert_allclose(at_design["pose"]["Ok"]["points"], front.design, atol=1e-9)
    ends = [frame["pose"]["Ok"]["points"][front.points.index("wheel_centre")][2] for frame in drawing["frames"]]
    np.testing.assert_allclose(np.array(ends) - front["wheel_centre"][2], [f["drive"] for f in drawing["frames"]], atol=1e-9)


def test_a_named_coordinate_starts_at_the_design(front):
    pytest.importorskip("anywidget")
    z = front["tie_rod_inner"][2]
    variable = {"hardpoint": "tie_rod_inner", "axis": "z", "range": [z - 5.0, z + 5.0], "absolute": True, "name": "height"}
    study = hp.Study.from_dict({**front.to_dict(), "sweep": {"method": "sobol", "samples": 4, "variables": [variable]}})
    assert hp.view(study, ["height"], columns=["toe_deg"]).offsets == [z]
