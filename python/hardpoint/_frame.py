"""Common base of results: a mapping of columns."""

from __future__ import annotations

import html
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from os import PathLike
from typing import TYPE_CHECKING, Any, NoReturn, Self

import numpy as np
from numpy.typing import NDArray

from . import _hardpoint
from ._hardpoint import STATUS, HardpointError

Array = NDArray[Any]
Floats = NDArray[np.float64]

_SHOWN_ROWS = 8


@dataclass(frozen=True)
class Column:
    """Meaning of a column."""

    name: str
    """Name with the unit, as in `camber_deg`."""
    output: str
    """Name without order and unit."""
    unit: str
    """Unit; empty for a plain number."""
    positive: str | None = None
    """Meaning of a positive value, in words; None if it is not known."""

    @property
    def formula(self) -> str:
        """Formula of the output in the symbols of docs/characteristics.md; empty for a column outside the catalogue."""
        return _catalogue().get(self._quantity, ("", ""))[0]

    @property
    def source(self) -> str:
        """Source of the definition; empty without a source."""
        return _catalogue().get(self._quantity, ("", ""))[1]

    @property
    def _quantity(self) -> str:
        for side in ("left_", "right_"):
            if self.output.startswith(side) and self.output not in _catalogue():
                return self.output.removeprefix(side)
        return self.output


@cache
def _catalogue() -> dict[str, tuple[str, str]]:
    return _hardpoint.catalogue()


def column_of(name: str) -> Column:
    """Meaning of a column, from its name."""
    return Column(name, *_hardpoint.split_unit(name))


def _codes(words: Any) -> NDArray[np.uint8] | None:
    """Status codes of a column of words; None if a word is no status."""
    if words is None or not all(word in STATUS for word in np.unique(words)):
        return None
    codes = {word: code for code, word in enumerate(STATUS)}
    return np.fromiter((codes[word] for word in words), np.uint8, len(words))


class Frame(dict[str, Array]):
    """Columns of equal length by name, as in the CSV files. Arrays are read-only, and NaN means "no value".

    A frame is a dict, so `pandas.DataFrame(frame)` works, but it cannot be changed. Two frames are equal only if they are
    the same object.
    """

    info: Mapping[str, Column]
    """Unit and sign of each column."""
    status: NDArray[np.uint8]
    """Code of each row, an index into `hardpoint.STATUS`; 0 is ok."""
    motion: Mapping[str, Floats]
    """Columns that give the station of a row, the drive first; empty if rows are not stations."""

    def __init__(
        self,
        columns: Mapping[str, Any],
        *,
        info: Mapping[str, Column] | None = None,
        status: NDArray[np.uint8] | None = None,
        reasons: Mapping[int, str] | None = None,
        motion: Sequence[str] = (),
    ) -> None:
        arrays = {name: _read_only(values) for name, values in columns.items()}
        super().__init__(arrays)
        rows = len(next(iter(arrays.values()), ()))
        self.info = {name: column_of(name) for name in arrays} if info is None else dict(info)
        # A table that was read from a file gives the status in words. The words are converted to codes.
        codes = _codes(arrays.get("status")) if status is None else status
        self.status = _read_only(np.zeros(rows, np.uint8) if codes is None else codes)
        # Words from a CSV file are texts, words from a Parquet file are objects.
        if status is None and codes is not None and "reason" in arrays and arrays["reason"].dtype.kind in "UO":
            reasons = {int(row): str(arrays["reason"][row] or "") for row in np.flatnonzero(codes)}
        self.motion = {name: arrays[name] for name in motion}
        self._reasons = dict(reasons or {})
        self._all_reasons: tuple[str, ...] | None = None

    @classmethod
    def of_records(cls, records: Iterable[Mapping[str, Any]]) -> Self:
        """Frame of mappings, one for each row. Inner mappings become columns such as "after_rms"."""
        rows = [_flat(record) for record in records]
        names = list(dict.fromkeys(name for row in rows for name in row))
        return cls({name: _cells([row.get(name) for row in rows]) for name in names})

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.status)

    @property
    def failed(self) -> NDArray[np.int64]:
        """Numbers of the rows with a status other than 0."""
        return np.flatnonzero(self.status)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Reason for the status of each row; "" for rows with status 0."""
        if self._all_reasons is None:
            all_reasons = [""] * self.rows
            for row, reason in self._reasons.items():
                all_reasons[row] = reason
            self._all_reasons = tuple(all_reasons)
        return self._all_reasons

    def to_pandas(self, index: str | None = "motion") -> Any:
        """Pandas DataFrame that shares the columns' memory. The motion is the index if there is one; `index=None` keeps all
        columns."""
        import pandas

        table = pandas.DataFrame(dict(self), copy=False)
        if index == "motion":
            return table.set_index(list(self.motion)) if self.motion else table
        return table if index is None else table.set_index(index)

    def to_xarray(self) -> Any:
        """Xarray Dataset over one dimension, with units as attributes, and the motion and the status codes as coordinates."""
        import xarray

        dimension = "station" if self.motion else "row"
        places = {name: (dimension, values) for name, values in self.motion.items()}
        variables = {
            name: (dimension, values, {"units": self.info[name].unit} if name in self.info else {})
            for name, values in self.items()
            if name not in places
        }
        # A table from a file has the words of the status as a column of this name.
        codes = {} if "status" in self else {"status": (dimension, self.status)}
        return xarray.Dataset(variables, coords={**places, **codes})

    def to_parquet(self, path: str | PathLike[str]) -> None:
        """Writes the columns as Apache Parquet (zstd), with a row group for each 131,072 rows. Needs pyarrow."""
        import pyarrow
        import pyarrow.parquet

        # pyarrow also accepts lists of column names here, but its type hints do not include them.
        words: Any = [name for name, values in self.items() if values.dtype.kind not in "fiu"]
        numbers: Any = [name for name, values in self.items() if values.dtype.kind == "f"]
        pyarrow.parquet.write_table(
            pyarrow.table(_for_arrow(self)),
            path,
            compression="zstd",
            row_group_size=131_072,
            use_dictionary=words,
            use_byte_stream_split=numbers,
        )

    def plot(self, *names: str, ax: Any = None) -> Any:
        """Draws columns over the first column of the motion, or over the row number. Returns the axes of matplotlib."""
        for name in names:
            if name not in self:
                raise HardpointError(f"there is no column {name!r}; there are {', '.join(self)}")
        if ax is None:
            from matplotlib import pyplot

            ax = pyplot.gca()
        over, x = next(iter(self.motion.items()), ("row", np.arange(self.rows)))
        shown = names or tuple(n for n, v in self.items() if n not in self.motion and v.dtype.kind == "f")
        for name in shown:
            ax.plot(x, self[name], label=name)
        ax.set_xlabel(over)
        if len(shown) == 1:
            ax.set_ylabel(shown[0])
        else:
            ax.legend()
        return ax

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """Exports the columns to programs that read Arrow (polars, DuckDB, pyarrow). Needs pyarrow."""
        import pyarrow

        return pyarrow.table(_for_arrow(self)).__arrow_c_stream__(requested_schema)

    def _repr_html_(self) -> str:
        """First and last rows, for notebooks."""
        rows: list[int | None] = list(range(self.rows))
        if self.rows > _SHOWN_ROWS:
            half = _SHOWN_ROWS // 2
            rows = [*range(half), None, *range(self.rows - half, self.rows)]
        columns = list(self.values())
        return html_of(repr(self), list(self), [["..." if row is None else v[row] for v in columns] for row in rows])

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    def __repr__(self) -> str:
        bad = len(self.failed)
        doubt = f", {bad} with a status" if bad else ""
        return f"<hardpoint.{type(self).__name__}: {self.rows} rows{doubt}; {', '.join(self)}>"

    def __eq__(self, other: object) -> bool:
        return self is other

    def __ne__(self, other: object) -> bool:
        return self is not other

    def __hash__(self) -> int:  # type: ignore[override]
        return id(self)

    def __copy__(self) -> Self:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return (_restored, (type(self), dict(self), dict(self.__dict__)))

    if not TYPE_CHECKING:

        def _refuse(self, *_: Any, **__: Any) -> NoReturn:
            """Raises TypeError: results cannot be changed."""
            raise TypeError("results cannot be changed; dict(frame) is a copy that can")

        __setitem__ = __delitem__ = __ior__ = update = pop = popitem = setdefault = clear = _refuse


def _restored(cls: type[Frame], columns: dict[str, Array], state: dict[str, Any]) -> Frame:
    frame = cls.__new__(cls)
    dict.update(frame, {name: _read_only(values) for name, values in columns.items()})
    state["motion"] = {name: dict.__getitem__(frame, name) for name in state["motion"]}
    state["status"] = _read_only(state["status"])
    frame.__dict__.update(state)
    return frame


def _read_only(values: Any) -> Array:
    array = values if isinstance(values, np.ndarray) else np.asarray(values)
    if array.flags.writeable:
        array = array.view()
        array.flags.writeable = False
    return array


def _for_arrow(frame: Frame) -> dict[str, Any]:
    return {name: v if v.dtype.kind in "fiub" else v.tolist() for name, v in frame.items()}


def html_of(title: str, head: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Table in HTML."""
    columns = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join("<tr>" + "".join(f"<td>{_shown(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<p>{html.escape(title)}</p><table><thead><tr>{columns}</tr></thead><tbody>{body}</tbody></table>"


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else html.escape(str(value))


def _flat(record: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, Mapping):
            flat.update(_flat(value, f"{prefix}{key}_"))
        else:
            flat[prefix + key] = value
    return flat


def _cells(values: list[Any]) -> Array:
    """Array of a column's cells: numbers (NaN without a value), truth values, text ("" without a value), or objects."""
    known = [v for v in values if v is not None]
    if known and all(isinstance(v, bool) for v in known) and len(known) == len(values):
        return np.array(values, bool)
    if all(isinstance(v, (int, float)) for v in known):
        return np.array([np.nan if v is None else v for v in values], np.float64)
    if all(isinstance(v, str) for v in known):
        return np.array(["" if v is None else v for v in values], str)
    cells = np.empty(len(values), object)
    cells[:] = values
    return cells


def status_words(status: Iterable[int]) -> Iterator[str]:
    """Words for status codes."""
    return (STATUS[code] for code in status)
