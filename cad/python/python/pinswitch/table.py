"""Tables of named columns."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _pinswitch
from ._errors import PinswitchError
from ._files import PathLike, write_text

Column = NDArray[Any]

#: Columns that are text even if every cell is a number.
TEXTS = frozenset({"series", "substrate", "pins", "sweep", "direction", "session", "mount", "operator", "specimen"})
#: Most rows that a notebook shows.
SHOWN = 12


class Table:
    """Columns of equal length: float64, int64, or objects that are ``str`` or ``None``. A missing number is NaN.

    Any library that reads Arrow takes a table without a conversion through Python objects: it implements the
    `PyCapsule protocol <https://arrow.apache.org/docs/format/CDataInterface/PyCapsuleInterface.html>`_.

    >>> table = Table({"load_N": np.array([1.0, 2.0]), "series": np.array(["a", "b"], dtype=object)})
    >>> len(table), table.columns
    (2, ['load_N', 'series'])
    >>> table["load_N"].sum()
    np.float64(3.0)
    """

    def __init__(self, columns: Mapping[str, Column]) -> None:
        lengths = {len(column) for column in columns.values()}
        if len(lengths) > 1:
            raise ValueError(f"columns have different lengths: {sorted(lengths)}")
        self._columns = dict(columns)
        self._length = lengths.pop() if lengths else 0

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(self._columns)

    def __len__(self) -> int:
        return self._length

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __getitem__(self, name: str) -> Column:
        return self._columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def keys(self) -> list[str]:
        """Return the names of the columns, so that ``dict(table)`` works."""
        return self.columns

    def filter(self, keep: NDArray[np.bool_]) -> Table:
        """Return the rows for which ``keep`` (shape ``(n,)``) is true."""
        return Table({name: column[keep] for name, column in self._columns.items()})

    def with_column(self, name: str, values: Column) -> Table:
        """Return the table with a column added or replaced; ``values`` has shape ``(n,)``."""
        return Table({**self._columns, name: np.asarray(values)})

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Return the table as an Arrow stream, in which NaN is null. A requested schema is ignored, which the protocol allows."""
        def native(column: Column) -> object:
            if column.dtype.kind == "f":
                return np.ascontiguousarray(column, dtype=np.float64)
            if column.dtype.kind in "iu":
                return np.ascontiguousarray(column, dtype=np.int64)
            return [None if cell is None else str(cell) for cell in column.tolist()]

        return _pinswitch.arrow_stream([(name, native(column)) for name, column in self._columns.items()])

    def to_pandas(self) -> Any:
        """Return a ``pandas.DataFrame``."""
        import pandas

        return pandas.DataFrame(self._columns)

    def to_polars(self) -> Any:
        """Return a ``polars.DataFrame``."""
        import polars

        return polars.DataFrame(self)

    def to_csv(self) -> str:
        """Return CSV with a header; a number has as many digits as it needs to be read back unchanged."""
        return csv_text(self._columns)

    def save(self, path: PathLike) -> None:
        """Write CSV to a file."""
        write_text(path, self.to_csv())

    def __repr__(self) -> str:
        return f"Table({len(self)} rows: {', '.join(self._columns)})"

    def _repr_html_(self) -> str:
        def cell(value: object) -> str:
            if isinstance(value, float):
                return "" if np.isnan(value) else f"{value:.6g}"
            return "" if value is None else escape(str(value))

        head = "".join(f"<th>{escape(name)}</th>" for name in self._columns)
        rows = zip(*(column[:SHOWN].tolist() for column in self._columns.values()))
        body = "".join("<tr>" + "".join(f"<td>{cell(value)}</td>" for value in row) + "</tr>" for row in rows)
        more = f"<p>{len(self)} rows</p>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _cell_text(value: object) -> str:
    """Return a value as a cell of CSV."""
    # pandas has values of its own for what is missing.
    if value is None or (isinstance(value, float) and value != value) or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_cell_text(item) for item in value) + "]"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, float):
        # As the program writes numbers: a whole one has no fraction.
        return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(float(value))
    return str(value)


def csv_text(columns: Mapping[str, Any]) -> str:
    """Return columns as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    lists = [column.tolist() if hasattr(column, "tolist") else list(column) for column in columns.values()]
    lengths = {name: len(column) for name, column in zip(columns, lists)}
    if len(set(lengths.values())) > 1:
        counted = ", ".join(f"{name} {length}" for name, length in lengths.items())
        help = "give each column the same number of rows, and a missing value as None or NaN"
        raise PinswitchError(f"columns of different lengths: {counted}", code="wrong-type", help=help)
    writer.writerows([_cell_text(value) for value in row] for row in zip(*lists))
    return text.getvalue()


def columns_of(frame: Any) -> dict[str, list[Any]]:
    """Return the columns of a frame of any library, a mapping of columns, or a sequence of mappings."""
    if isinstance(frame, Table):
        return {name: frame[name].tolist() for name in frame}
    if hasattr(frame, "collect") and hasattr(frame, "lazy"):  # a lazy frame of polars
        frame = frame.collect()
    if hasattr(frame, "to_pydict"):  # pyarrow
        _check_names(frame.column_names)
        return dict(frame.to_pydict())
    if hasattr(frame, "get_columns"):  # polars
        return {column.name: column.to_list() for column in frame.get_columns()}
    if hasattr(frame, "columns") and hasattr(frame, "iloc"):  # pandas
        names = [str(name) for name in frame.columns]
        _check_names(names)
        return {name: frame.iloc[:, i].tolist() for i, name in enumerate(names)}
    if isinstance(frame, Mapping):
        return {str(name): list(column) for name, column in frame.items()}
    if hasattr(frame, "__arrow_c_stream__"):
        import pyarrow

        try:
            table = pyarrow.table(frame)
        except (pyarrow.ArrowException, TypeError) as error:
            raise _not_a_table(frame) from error
        _check_names(table.column_names)
        return dict(table.to_pydict())
    rows: list[Any] = list(frame) if isinstance(frame, Iterable) else [frame]
    if not all(isinstance(row, Mapping) for row in rows):
        raise _not_a_table(frame)
    names = list(dict.fromkeys(name for row in rows for name in row))
    return {name: [row.get(name) for row in rows] for name in names}


def _check_names(names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            help = "rename or drop one of them"
            raise PinswitchError("two columns have the same name", code="duplicate-entry", help=help, field=name)
        seen.add(name)


def _not_a_table(frame: object) -> PinswitchError:
    problem = f"a {type(frame).__name__} is not a table"
    help = "give a frame of pandas, polars or pyarrow, a mapping of columns, or rows as mappings"
    return PinswitchError(problem, code="wrong-type", help=help)


def read_csv(text: str) -> Table:
    """Return the table of a CSV text; a column whose cells are all numbers or empty is float64.

    Raises
    ------
    PinswitchError
        If a row has another number of cells than the header.
    """
    rows = list(csv.reader(io.StringIO(text)))
    if not rows:
        return Table({})
    head, body = rows[0], rows[1:]
    for line, row in enumerate(body, 2):
        if len(row) != len(head):
            problem = f"row {line} has {len(row)} cells, the header {len(head)}"
            raise PinswitchError(problem, code="wrong-type", help="give each row a cell per column", line=line)
    return Table({name: _column(name, [row[i] for row in body]) for i, name in enumerate(head)})


def _column(name: str, cells: list[str]) -> Column:
    if name not in TEXTS:
        try:
            return np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
        except ValueError:
            pass
    return np.array(cells, dtype=object)
