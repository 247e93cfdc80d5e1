"""Results of runs, in memory or read back from their directories."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from . import _hardpoint
from ._frame import Frame, html_of
from ._hardpoint import HardpointError
from ._study import Study, load


_PART = re.compile(r"(part|curves)-\d{9,}")
"""Names of the files of a sweep's parts, without their endings."""


def write_pictures(pictures: Mapping[str, bytes], place: str | os.PathLike[str]) -> None:
    """Writes pictures into a directory, under their names."""
    Path(place).mkdir(parents=True, exist_ok=True)
    for name, contents in pictures.items():
        (Path(place) / name).write_bytes(contents)


class Results(Mapping[str, Frame]):
    """Results of a command in memory: a mapping from tables, such as "tolerance", to their columns."""

    def __init__(self, files: Mapping[str, bytes], study: Study | None = None) -> None:
        self.files: dict[str, bytes] = dict(files)
        """Contents of the files that the command writes, by name."""
        self.study = study
        """Study of the command; None for several studies."""
        self._tables: dict[str, Frame] = {}

    @property
    def summary(self) -> Any:
        """Contents of `summary.json`."""
        return json.loads(self.files.get("summary.json", b"{}"))

    def save(self, directory: str | os.PathLike[str]) -> Path:
        """Writes the files into a new or empty directory. Returns the directory."""
        path = Path(directory)
        path.mkdir(parents=True, exist_ok=True)
        if any(path.iterdir()):
            raise HardpointError(f"{path}: the directory is not empty; give another one")
        for name, contents in self.files.items():
            (path / name).write_bytes(contents)
        if self.study is not None:
            (path / "study.toml").write_text(self.study.text, encoding="utf-8", newline="")
        return path

    def report(self, path: str | os.PathLike[str], plots: str | os.PathLike[str] | None = None) -> Path:
        """Writes one self-contained page to the file `path`, which is replaced, and pictures of the curves into the
        directory `plots`. Returns the path."""
        page: str | bytes | None = self.files.get("report.html")
        pictures: dict[str, bytes] = {}
        if "report.json" in self.files:
            page, pictures = _hardpoint.page_of_files(self.files, plots is not None)
        if page is None:
            raise HardpointError(f"these results have no page; their tables are {', '.join(self)}")
        if plots is not None:
            if not pictures:
                raise HardpointError("these results have no pictures of curves; leave out plots")
            write_pictures(pictures, plots)
        place = Path(path)
        place.write_bytes(page if isinstance(page, bytes) else page.encode())
        return place

    def __getitem__(self, name: str) -> Frame:
        if name not in self._tables:
            self._tables[name] = Frame(_hardpoint.parse_table(self.files[f"{name}.csv"]))
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return (name[:-4] for name in self.files if name.endswith(".csv"))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        return f"<hardpoint.Results: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        """Tables, for notebooks."""
        rows = [[name, self[name].rows, ", ".join(self[name])] for name in self]
        return html_of("hardpoint.Results", ["table", "rows", "columns"], rows)


class Run(Mapping[str, Frame]):
    """Results of a run: a mapping from the tables of its directory, such as "curves", to their columns.

    The table "designs" has the rows of a sweep, from one file or from several parts.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        """Directory of the run."""
        if not self.path.is_dir():
            raise HardpointError(f"{self.path}: there is no such directory")
        self.files: list[str] = sorted(p.name for p in self.path.iterdir() if p.is_file() and not p.name.startswith("."))
        """Names of the files."""
        names = [name for name in self.files if name.endswith((".csv", ".parquet"))]
        self._tables: dict[str, list[Path]] = {}
        for name in names:
            stem = name.rsplit(".", 1)[0]
            # part-000000000.csv contains rows of designs, curves-000000000.csv contains their curves. Other names may end with a
            # number, too: curves_bump-2.csv has the curves of the motion "bump-2".
            part = _PART.fullmatch(stem)
            stem = {"part": "designs", "curves": "curves"}[part[1]] if part else stem
            self._tables.setdefault(stem, []).append(self.path / name)
        self._read: dict[str, Frame] = {}
        if not self._tables:
            raise HardpointError(f"{self.path}: not the directory of a run: there is no table in it")

    @property
    def command(self) -> str | None:
        """Command of the run, such as "solve"."""
        found = self.summary.get("command")
        if found is None and (self.path / "run.json").is_file():
            runs = json.loads((self.path / "run.json").read_text(encoding="utf-8"))["runs"]
            found = runs[0]["command"] if runs else None
        return found

    @property
    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json`."""
        path = self.path / "summary.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}

    @property
    def study(self) -> Study:
        """Study of the run, from study.toml."""
        return load(self.path / "study.toml")

    @property
    def tuned(self) -> Study:
        """Tuned study of a tuning, from optimised.toml."""
        return load(self.path / "optimised.toml")

    def scan(self) -> Any:
        """Rows of a sweep as a pyarrow dataset, which can be larger than memory. Needs pyarrow."""
        import pyarrow.dataset

        files = [str(path) for path in self._tables["designs"]]
        found = pyarrow.dataset.dataset(files, format=files[0].rsplit(".", 1)[1])
        self._check_designs(found.count_rows())
        return found

    def _check_designs(self, rows: int) -> None:
        """Raises an error if rows of a finished sweep are missing."""
        designs = self.summary.get("designs") if self.command == "sweep" else None
        if isinstance(designs, int) and designs != rows:
            raise HardpointError(f"{self.path}: the directory has only {rows} of {designs} designs: parts are missing or cut off")

    def __getitem__(self, name: str) -> Frame:
        if name not in self._read:
            files = self._tables[name]
            frame = Frame(_parquet(files) if files[0].suffix == ".parquet" else _hardpoint.read_tables(files))
            if name == "designs":
                self._check_designs(frame.rows)
            self._read[name] = frame
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def __repr__(self) -> str:
        return f"<hardpoint.Run {str(self.path)!r}: {self.command}; {', '.join(self._tables)}>"


def _parquet(files: list[Path]) -> dict[str, Any]:
    import pyarrow.dataset

    table = pyarrow.dataset.dataset([str(f) for f in files], format="parquet").to_table()
    return {name: table[name].to_numpy() for name in table.column_names}


def read_run(directory: str | os.PathLike[str]) -> Run:
    """Results in a run's directory."""
    return Run(directory)
