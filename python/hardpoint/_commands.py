"""What the program does beyond curves, functions, sweeps and tunings, by running its commands in a process of their
own: their results are read back from the directory that they write."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _hardpoint
from ._hardpoint import HardpointError
from ._runs import Run
from ._study import Study, load

Place = str | os.PathLike[str]
Source = Study | Run | str | os.PathLike[str]


def _program(*arguments: Any, quiet: bool = True) -> tuple[str, str]:
    """Runs a command; its standard output and standard error. Exit code 1, that something could not be solved, is no
    exception: the rest is there."""
    words = ["--quiet"] * quiet + [str(a) for a in arguments]
    # -P: a folder called hardpoint where the caller stands is not the module.
    command = [sys.executable, "-P", "-m", "hardpoint", *words]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="replace", check=False)
    if done.returncode not in (0, 1):
        raise HardpointError(done.stderr.strip().removeprefix("error: ") or f"exit code {done.returncode}")
    return done.stdout, done.stderr


def _options(**values: Any) -> list[str]:
    """Options of the command line; those that are None are left out."""
    given = {name.rstrip("_").replace("_", "-"): value for name, value in values.items() if value is not None}
    return [f"--{name}={value}" for name, value in given.items()]


class _Folder:
    """A temporary directory, in which studies are put as files."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="hardpoint-")
        self.path = Path(self._folder.name)

    def file(self, source: Source) -> Path:
        """A study as a file, under its own name; runs and paths as they are."""
        match source:
            case Study():
                # Two studies of one name may be compared.
                place = Path(tempfile.mkdtemp(dir=self.path)) / f"{source.name}.toml"
                place.write_text(source.text, encoding="utf-8")
                return place
            case Run():
                return source.path
            case _:
                return Path(source)

    def result(self, out: Place | None) -> Path:
        """Where results go: there, or below this directory."""
        return self.path / "run" if out is None else Path(out)


def _run(command: str, study: Study, out: Place | None, threads: int | None) -> Run:
    folder = _Folder()
    to = folder.result(out)
    _, said = _program(command, folder.file(study), "--out", to, *_options(threads=threads))
    if not to.is_dir():
        raise HardpointError(said.strip().removeprefix("error: "))
    return Run(to, keep=folder)


def setup(study: Study, out: Place | None = None) -> Run:
    """Solves for the adjustments that give the static values that [setup] wants.

    Tables: "setup" (the instructions and the static values after each step), "effects" (effect of each adjustment) and
    "curves". `summary["met"]` says whether every wanted value is met but for half steps of shims and turns. Each of
    `summary["statics"]` has its value and error with the computed amounts (`set`, `miss`) and with those rounded to what
    a mechanic can make (`set_rounded`, `miss_rounded`). `ride_height_change` is positive where the car becomes higher."""
    return _run("setup", study, out, None)


def tolerance(study: Study, out: Place | None = None, threads: int | None = None) -> Run:
    """What the scatter of [tolerance] does: tables "tolerance", "contributors", "curves" and percentiles of them."""
    return _run("tolerance", study, out, threads)


def assemblies(study: Study, travel: float = 0.0, rack: float = 0.0) -> list[dict[str, Any]]:
    """Every way to assemble the design's lengths at a travel and rack displacement, a mapping of columns for each."""
    folder = _Folder()
    place = _options(travel=float(travel), rack=float(rack))
    written, _ = _program("assemblies", folder.file(study), "--format=json", *place)
    found: list[dict[str, Any]] = json.loads(written)["assemblies"]
    return found


def bench(kind: str, study: Study | None = None, out: Place | None = None) -> Run:
    """Measures this module's program on this machine: kind is "throughput", "accuracy" or "effects"."""
    folder = _Folder()
    to = folder.result(out)
    _program("bench", kind, *([folder.file(study)] if study else []), "--out", to)
    return Run(to, keep=folder)


def compare(*sources: Source, out: Place | None = None) -> Run:
    """Curves and points of two or more studies or runs side by side; the table "comparison" has every value and
    difference, `path / "report.html"` the curves over each other."""
    folder = _Folder()
    to = folder.result(out)
    _program("compare", *(folder.file(source) for source in sources), "--out", to)
    return Run(to, keep=folder)


def merge(parts: Sequence[Place], out: Place) -> Run:
    """Joins the directories of parts of a sweep to one, for those who want one file."""
    _program("merge", *parts, "--out", out)
    return Run(out)


def report(run: Run | Place, plots: Place | None = None, force: bool = False) -> Path:
    """Makes one self-contained page of a run, and pictures of its curves in the directory `plots`; the page's path."""
    path = run.path if isinstance(run, Run) else Path(run)
    _program("report", path, *_options(plots=plots), *["--force"] * force)
    return path / "report.html"


def _plain(value: Any) -> Any:
    """Mappings, lists and numbers as JSON has them, from arrays and the like."""
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
    """A study of points, and what was guessed, assumed and left over, a line each. `source` is a table (CSV, XLSX), a map
    in JSON or an Adams/Car subsystem, or a mapping from names to (x, y, z), nested as it likes; `names` are those in it by
    hardpoint."""
    folder = _Folder()
    if isinstance(source, Mapping):
        file = folder.path / "points.json"
        file.write_text(json.dumps(_plain(source)), encoding="utf-8")
    else:
        file = Path(source)
    to = folder.path / f"{file.stem}.toml"
    map_ = None
    if names is not None:
        map_ = folder.path / "names.toml"
        map_.write_text("".join(f"{k} = {json.dumps(v)}\n" for k, v in names.items()), encoding="utf-8")
    options = _options(topology=topology, map=map_, unit=unit, frame=frame, side=side, sheet=sheet, out=to)
    _, said = _program("import", file, *options, quiet=False)
    return load(to), [line.strip() for line in said.splitlines()[1:]]


def export(
    source: Source,
    out: Place,
    *,
    to: str | None = None,
    into: Place | None = None,
    design: int | None = None,
    unit: str | None = None,
    frame: str | None = None,
    round: float | None = None,
    round_all: bool = False,
    curves: bool = False,
    names: str | None = None,
    travel: str | None = None,
    rack: str | None = None,
    grow: float | None = None,
    force: bool = False,
) -> list[str]:
    """Writes a study or run to the file `out` for other tools, in a `unit` and a `frame`. Returns a line for each thing that
    this cost or left out. `to` is "csv", "xlsx", "adams", "optimumk", "assetto", "dxf" or "stl", by default as the file's
    name ends (`.sub` is Adams/Car's, `.ini` Assetto Corsa's). `into` is a subsystem whose copy takes the points,
    `design` a number in a sweep, `round` a length. `curves` and `names` ("adams", "altair") are for "csv", `travel` and
    `rack` (as "-30..30") and `grow` for "stl"."""
    folder = _Folder()
    kinds = {".csv": "csv", ".xlsx": "xlsx", ".sub": "adams", ".ini": "assetto", ".dxf": "dxf", ".stl": "stl"}
    kind = to or kinds.get(Path(out).suffix)
    options = _options(to=kind, into=into, design=design, unit=unit, frame=frame, round=round, names=names, travel=travel)
    options += _options(rack=rack, grow=grow, out=out)
    flags = ["--round-all"] * round_all + ["--curves"] * curves + ["--force"] * force
    _, said = _program("export", folder.file(source), *options, *flags, quiet=False)
    return said.splitlines()


def schema() -> dict[str, Any]:
    """The JSON schema of studies."""
    found: dict[str, Any] = json.loads(_hardpoint.schema())
    return found


def template(topology: str, parts: Sequence[str] = ()) -> str:
    """A commented study of a topology that runs as it is, with parts such as "pushrod", "sweep", "optimise"."""
    if not parts:
        return _hardpoint.template(topology)
    return _program("new", topology, *_options(with_=",".join(parts)))[0]


def completions(shell: str) -> str:
    """What makes a shell ("bash", "zsh", "fish") complete the program's commands and options."""
    return _program("completions", shell)[0]


def man() -> str:
    """The program's manual page, for man."""
    return _program("man")[0]
