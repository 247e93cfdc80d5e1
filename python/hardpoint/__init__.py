"""Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints.

Units are those of the column names (degrees, the study's length unit). Axes are those of the study. Arrays are float64 in C
order. NaN means "no value"; batch functions return it and raise no exception. A wrong study raises `StudyError`, with
`line`, `column`, `key` and `help`.

>>> import hardpoint as hp
>>> study = hp.loads(hp.template("macpherson"))
>>> curves = hp.solve(study)
>>> curves["camber_deg"].shape == curves.drive.shape
True
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from os import PathLike

from . import _hardpoint
from ._car import Car, CarTuning, Cases
from ._commands import assemblies, compare, export, import_points, kc, merge, report, schema, setup, template, tolerance
from ._curves import Curves
from ._frame import Column, Frame
from ._function import Function, Residuals
from ._hardpoint import STATUS as _STATUS
from ._hardpoint import HardpointError, StudyError, __version__, topologies
from ._runs import Results, Run, read_run
from ._sections import Adjustment, Band, Constraint, Scatter, SweepVariable, Target, Variable, vehicle
from ._study import Limits, Study, check, limits, load, loads, solve
from ._sweep import Sweep, sweep
from ._tuning import Tuning, optimise
from ._view import view

STATUS: tuple[str, ...] = tuple(_STATUS)
"""Names of the status codes: `STATUS[code]` is the name of a code. Later versions add new codes at the end only."""

__all__ = [
    "STATUS",
    "Adjustment",
    "Band",
    "Car",
    "CarTuning",
    "Cases",
    "Column",
    "Constraint",
    "Curves",
    "Frame",
    "Function",
    "HardpointError",
    "Limits",
    "Residuals",
    "Results",
    "Run",
    "Scatter",
    "Study",
    "StudyError",
    "Sweep",
    "SweepVariable",
    "Target",
    "Tuning",
    "Variable",
    "__version__",
    "assemblies",
    "check",
    "compare",
    "export",
    "import_points",
    "kc",
    "limits",
    "load",
    "loads",
    "merge",
    "optimise",
    "read_run",
    "report",
    "run",
    "schema",
    "setup",
    "solve",
    "sweep",
    "template",
    "tolerance",
    "topologies",
    "vehicle",
    "view",
]


def run(arguments: Sequence[str | PathLike[str]]) -> int:
    """Runs a command of the program in this process, as in run(["report", "out/front"]), and prints its messages. Returns
    the exit code: 0 done, 1 something could not be solved, 2 wrong input. Ctrl-C stops the command."""
    return _hardpoint.command([str(a) for a in arguments])


def _main() -> None:
    """Runs the program `hardpoint`, which is installed with the module."""
    sys.exit(_hardpoint.command(sys.argv[1:], is_program=True))
