"""Sweeps into arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hardpoint
from ._function import rows_of
from ._hardpoint import HardpointError
from ._study import Study

Floats = NDArray[np.float64]


class Sweep(Mapping[str, Floats]):
    """Rows of a sweep: a mapping from the columns of `designs.csv` to arrays (n,)."""

    def __init__(self, found: dict[str, Any]) -> None:
        self._columns: dict[str, Floats] = found["columns"]
        self.failed: NDArray[np.int64] = found["failed"]
        """Numbers of the designs that were not solved at every station."""
        self.reasons: list[str] = found["reasons"]
        """Why, one for each of them."""

    def __getitem__(self, name: str) -> Floats:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def to_pandas(self) -> Any:
        """A pandas DataFrame that shares the columns' memory."""
        import pandas

        return pandas.DataFrame(self._columns, copy=False)

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """The columns for whoever speaks Arrow (polars, DuckDB, pyarrow); takes pyarrow."""
        import pyarrow

        return pyarrow.table(dict(self._columns)).__arrow_c_stream__(requested_schema)

    def to_parquet(self, path: str | PathLike[str]) -> None:
        """Writes the columns as Apache Parquet (zstd), a row group for each 131,072 designs; takes pyarrow."""
        import pyarrow
        import pyarrow.parquet

        table = pyarrow.table(dict(self._columns))
        pyarrow.parquet.write_table(table, path, compression="zstd", row_group_size=131_072)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<hardpoint.Sweep: {rows} designs, {len(self.failed)} failed; {len(self)} columns>"


def sweep(
    study: Study, x: ArrayLike | None = None, *, variables: Sequence[str] | None = None, threads: int | None = None
) -> Sweep:
    """The designs of the study's [sweep], in arrays; the numbers of `hardpoint sweep`, to the bit. Ctrl-C is heard.

    With `x` (n, k) the designs are its rows, a column for each of `variables` (as in `Study.function`; by default those
    of the study), and no [sweep] is needed.
    """
    if x is None:
        if variables is not None:
            raise HardpointError("variables are the columns of x, and there is no x")
        return Sweep(_hardpoint.sweep(study._study, None, None, threads))
    names = list(variables) if variables is not None else study.variables
    rows, _ = rows_of(x, names)
    return Sweep(_hardpoint.sweep(study._study, rows, names, threads))
