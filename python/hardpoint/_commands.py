"""Set-up, builds, assemblies, comparisons, and exchange of files with other tools."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from . import _hardpoint
from ._car import Car
from ._frame import Frame
from ._function import names_of
from ._hardpoint import HardpointError, StudyError
from ._runs import Results, Run, write_pictures
from ._study import Overrides, Study, is_car, loads, study_of, written

Place = str | os.PathLike[str]
Source = Study | Run | str | os.PathLike[str]


def _program(*arguments: Any) -> str:
    """Runs a command in this process and returns its text for standard error. Exit code 1 means that something could not be
    solved. Then the function raises no exception, because all other results exist."""
    code, said = _hardpoint.command_captured([str(a) for a in arguments])
    if code not in (0, 1):
        raise HardpointError(said_here(said) or f"exit code {code}")
    return said


def said_here(text: str) -> str:
    """Converts a message of the program: the names of command-line options become names of Python parameters."""
    text = text.replace("in a file for --map", "in names")
    text = re.sub(r"--force\b", "force=True", text.strip().removeprefix("error: "))
    return re.sub(r"(?<![\w-])--([a-z][a-z-]*)", lambda option: option[1].replace("-", "_"), text)


@contextmanager
def _in_words_of_python() -> Iterator[None]:
    """Converts errors of the program to the names of this module."""
    try:
        yield
    except StudyError:
        raise
    except HardpointError as error:
        raise HardpointError(said_here(str(error))) from None


def _options(**values: Any) -> list[str]:
    """Options of the command line, without those that are None."""
    given = {name.rstrip("_").replace("_", "-"): value for name, value in values.items() if value is not None}
    return [f"--{name}={value}" for name, value in given.items()]


def kc(study: Study | Place, values: Overrides | None = None, /, *, names: str | None = None) -> Results:
    """Runs the tests of a kinematics and compliance rig on a wheel or an axle. The elastic parts of [compliance] are
    optional. `values` replace fields of the study.

    Tables: "kc" has a row for each station, test and result, with value, secant and unit. "levels" has the equilibria at
    each level of a load, with the forces of bushings and links. "compliance_matrix" has displacement and rotation of the
    wheel centre per force and moment there. "sensitivities" has exact derivatives of the results, if [outputs] requests
    them. `names` ("adams", "altair") adds names and values by the definitions of these programs. `summary["design_load_N"]`
    is the wheel load of the design position, for an axle a list of both wheel loads. `summary["without_equilibrium"]` lists
    loads at which the wheel has no equilibrium."""
    study = study_of(study).replace(values)
    return Results(_hardpoint.kc(study._study, names), study)


def setup(study: Study | Place) -> Results:
    """Finds the adjustments that give the static values of [setup].

    Tables: "setup" (instructions, and static values after each step), "effects" (effect of each adjustment) and "curves".
    `summary["met"]` is true if all target values are reached within half a step of a shim or turn. Each of `summary["statics"]`
    has value and error for the computed amounts (`set`, `miss`), and for amounts rounded to available steps (`set_rounded`,
    `miss_rounded`). `ride_height_change` is positive if the car becomes higher."""
    study = study_of(study)
    return Results(_hardpoint.setup(study._study), study)


def tolerance(
    study: Study | Car | Place, *, threads: int | None = None, progress: Callable[[int, int], object] | None = None
) -> Results:
    """Computes the effect of the scatter of [tolerance]. Tables: "tolerance", "contributors", "curves" of the nominal
    design, and percentile curves of the builds: "curves_p1", "curves_p5", "curves_p95", "curves_p99". For a `Car` the
    tables are "tolerance" and "contributors". `progress(done, all)` is called about twenty times a second.
    `study.built(number)` is the study of one build."""
    if is_car(study):
        return Results(_hardpoint.car_tolerance(study._car, threads, progress))
    study = study_of(study)
    return Results(_hardpoint.tolerance(study._study, threads, progress), study)


def assemblies(study: Study | Place, travel: float = 0.0, rack: float = 0.0) -> Frame:
    """Finds all assemblies of the design's lengths at a travel and a rack displacement, in the study's length unit, with a row for
    each assembly. Raises `HardpointError` if the search cannot decide whether there are more."""
    csv, undecided = _hardpoint.assemblies(study_of(study)._study, float(travel), float(rack))
    if undecided:
        raise HardpointError("undecided: " + "; ".join(undecided))
    return Frame(_hardpoint.parse_table(csv))


def compare(**studies: Study | Car | Place) -> Results:
    """Compares curves and points of two or more studies, as in `compare(before=a, after=b)`. Columns carry these names.
    Tables: "comparison" has all values and differences, "moved" has the points that differ. `files["report.html"]` is a
    page with overlaid curves. Cars compare with cars: "comparison" has the results of all cases, "changes" has their
    largest changes."""
    if len(studies) < 2:
        raise HardpointError(f"compare needs two or more studies by name, as in compare(before=a, after=b); found {len(studies)}")
    cars = [(label, study._car) for label, study in studies.items() if is_car(study)]
    if len(cars) == len(studies):
        return Results(_hardpoint.car_compare(cars))
    return Results(_hardpoint.compare([(label, study_of(study)._study) for label, study in studies.items()]))


def merge(parts: Sequence[Place], out: Place) -> Run:
    """Joins the directories of a sweep's parts to one directory with one file."""
    _program("merge", *parts, "--out", out)
    return Run(out)


def report(run: Run | Place, plots: Place | None = None, force: bool = False) -> Path:
    """Makes one self-contained page of a run's directory, and pictures of its curves in the directory `plots`. Replaces
    existing pictures. Returns the path of the page. Results in memory have a method `report(path)`."""
    if not isinstance(run, (str, os.PathLike, Run)):
        raise HardpointError(f"report needs a Run or its directory; for results in memory use {type(run).__name__}.report(path)")
    path = run.path if isinstance(run, Run) else Path(run)
    pictures = _hardpoint.report(path, plots is not None, force)
    if plots is not None:
        write_pictures(pictures, plots)
    return path / "report.html"


def _plain(value: Any) -> Any:
    """Converts arrays and similar objects to mappings, lists and numbers for JSON."""
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, (str, bool, int, float)) or value is None:
        return value
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Iterable):
        return [_plain(inner) for inner in value]
    raise HardpointError(f"a value is {value!r}; expected names with three numbers each")


def import_points(
    source: Place | Mapping[str, Any],
    topology: str,
    *,
    names: Mapping[str, str] | None = None,
    unit: str | None = None,
    frame: str | None = None,
    side: str | None = None,
    sheet: str | None = None,
) -> tuple[Study, list[str]]:
    """Makes a study from points. Also returns remarks, one per line: guesses, assumptions and unused points. `source` is a
    table (CSV, XLSX), a map in JSON, an Adams/Car subsystem, or a mapping from names to (x, y, z) with any nesting. `names`
    gives the name in the source for a hardpoint."""
    if isinstance(source, Mapping):
        file, points = Path("points.json"), json.dumps(_plain(source))
    else:
        file, points = Path(source), None
    options = _options(topology=topology, unit=unit, frame=frame, side=side, sheet=sheet)
    with _in_words_of_python():
        text, said = _hardpoint.import_study(["import", str(file), *options], points, dict(names or {}))
    return loads(text, name=f"{file.stem}.toml"), [line.strip() for line in said.splitlines()]


def export(
    source: Source,
    out: Place,
    *,
    to: str | None = None,
    into: Place | None = None,
    design: int | None = None,
    unit: str | None = None,
    frame: str | None = None,
    round: float | str | None = None,
    round_all: bool = False,
    curves: bool = False,
    names: str | None = None,
    travel: str | None = None,
    rack: str | None = None,
    grow: float | None = None,
    bushing: str | None = None,
    force: bool = False,
) -> list[str]:
    """Writes a study or a run to the file `out` for other tools, in a `unit` and a `frame`. Returns a line for each loss or
    omission. `to` is "csv", "xlsx", "adams", "optimumk", "assetto", "dxf", "stl", "bus" or "toml"; the default follows the
    ending of the file name (`.sub` is Adams/Car, `.ini` is Assetto Corsa, `.bus` is a bushing's property file). `into` is a
    subsystem file; its copy receives the points. `design` is the number of a design of a sweep (from 0). `round` is a length in
    the unit of the file, or with its unit ("0.5mm"). `curves` and `names` ("adams", "altair") apply to "csv". `travel`, `rack`
    (as "-30..30") and `grow` apply to "stl", and `bushing` (its hardpoint) to "bus"."""
    ending = Path(out).suffix.lower().removeprefix(".")
    kind = to or {"sub": "adams", "ini": "assetto"}.get(ending, ending)
    if not kind:
        raise HardpointError(f'the file name {out} has no ending; give the format as `to`, as in to="csv"')
    options = _options(to=kind, into=into, design=design, unit=unit, frame=frame, round=round, names=names, travel=travel)
    options += _options(rack=rack, grow=grow, bushing=bushing, out=out)
    flags = ["--round-all"] * round_all + ["--curves"] * curves + ["--force"] * force
    if is_car(source):
        raise HardpointError("export needs the path of the study file of a car")
    if not isinstance(source, Study):
        place = source.path if isinstance(source, Run) else Path(source)
        return _program("export", place, *options, *flags).splitlines()
    with _in_words_of_python():
        said = _hardpoint.export_study(source._study, ["export", f"{source.name}.toml", *options, *flags])
    return said.splitlines()


def schema() -> dict[str, Any]:
    """JSON schema of studies."""
    found: dict[str, Any] = json.loads(_hardpoint.schema())
    return found


def template(topology: str, parts: Sequence[str] = ()) -> str:
    """Commented study of a topology, ready to run, with parts such as "pushrod", "sweep", "optimise"."""
    return _hardpoint.template(topology, names_of(parts, "parts"))
