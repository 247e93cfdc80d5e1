"""Study with sliders in a notebook."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from . import _hardpoint
from ._hardpoint import HardpointError
from ._study import Study, solve, study_of


def view(
    study: Study | str | PathLike[str], variables: Sequence[str] | None = None, *, columns: Sequence[str] | None = None
) -> Any:
    """Makes a widget for notebooks: a slider for each variable, curves of the nominal and the changed design, and the
    mechanism. Needs anywidget (`pip install hardpoint[notebook]`).

    `variables` are those of `study.function`. `columns` are the curves; the default is the first four outputs. The widget's
    `offsets` are the values of the variables (offsets or coordinates), which can also be set. Its `study` is the changed study."""
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise HardpointError("hp.view needs anywidget: pip install hardpoint[notebook]") from None
    nominal_study = study_of(study)
    f = nominal_study.function(variables)
    shown = list(columns) if columns is not None else f.outputs[:4]
    for name in shown:
        if name not in f.outputs:
            raise HardpointError(f"there is no output {name!r}; there are {', '.join(f.outputs)}")
    start = [_at_design(nominal_study, name) for name in f.variables]

    def drawn(of: Study) -> tuple[dict[str, Any], str]:
        curves = solve(of)
        over = next(iter(curves.motion.items()), ("station", np.arange(curves.rows)))
        listed = {name: [v if np.isfinite(v) else None for v in curves[name].tolist()] for name in shown}
        return {"over": over[0], "x": over[1].tolist(), "y": listed}, _hardpoint.drawing(of._study)

    class View(anywidget.AnyWidget):  # type: ignore[misc, unused-ignore]
        """Sliders, curves and mechanism of a study."""

        _esm = Path(__file__).with_name("_view.js")
        variables = traitlets.List(f.variables).tag(sync=True)
        bounds = traitlets.List(f.bounds.tolist()).tag(sync=True)
        offsets = traitlets.List(start).tag(sync=True)
        nominal = traitlets.Dict().tag(sync=True)
        curves = traitlets.Dict().tag(sync=True)
        drawing = traitlets.Dict().tag(sync=True)
        error = traitlets.Unicode("").tag(sync=True)
        study: Study = nominal_study

        def __init__(self) -> None:
            curves, drawing = drawn(nominal_study)
            super().__init__(nominal=curves, curves=curves, drawing=json.loads(drawing))
            self.observe(self._move, "offsets")

        def _move(self, _: Any) -> None:
            try:
                moved = f.study(self.offsets)
                curves, drawing = drawn(moved)
            except HardpointError as error:
                self.error = str(error)
                return
            self.study, self.curves, self.drawing, self.error = moved, curves, json.loads(drawing), ""

    return View()


def _at_design(study: Study, variable: str) -> float:
    """Value of a variable at the study's design: a coordinate, or 0 for an offset and a rotation."""
    try:
        [(_, value)] = _hardpoint.sweep_columns(study._study, [variable])
    except HardpointError:  # A rotation cannot be a column of designs.
        return 0.0
    return value
