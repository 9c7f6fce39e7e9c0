"""Friction curves."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any, Optional, Protocol, Union, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _pinswitch
from ._checks import MAX_THREADS, whole, wrong_type
from ._errors import PinswitchError
from ._files import read_bytes
from ._notebook import progress_bar
from .config import Config, ConfigLike, config_of
from .model import Model
from .table import Table, columns_of, csv_text

Floats = NDArray[np.float64]
#: Configuration, loads in N, law, and text and name of a model.
_Inputs = tuple[Config, Optional[list[float]], Optional[str], Optional[tuple[str, str]]]


#: Columns of a table of curves that are text, also if every cell is empty.
TEXT_COLUMNS = frozenset({"status", "reason", "law", "trust"})


class ArrowTable(Protocol):
    """A frame of pandas, polars or pyarrow, or a :class:`Table`."""

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Return the frame as an Arrow stream."""


class Curve(Table):
    """Tension and friction over load, by one law.

    The attributes are arrays of shape ``(n,)``; the columns of the table have the same numbers under the names of
    ``friction.csv``. Source of the laws: ``model/doc/friction-laws.md`` and ``model/doc/physics.md``.

    Attributes
    ----------
    load_n : ndarray
        Load on the tendon, N, ascending.
    eccentric_n, concentric_n : ndarray
        Tension while the load is released, and while it is pulled, N.
    friction_n : ndarray
        Friction ``(concentric - eccentric)/2``, N.
    band_low_n, band_high_n : ndarray
        Edges of the 95 % band of the friction, N.
    silicone_share : ndarray
        Share of the friction that the silicone carries, 0 to 1.
    law : str
        ``"physics"``, ``"layout"``, ``"paper"`` or ``"calibrated"``.
    status : str
        Support by measurements: ``"published"``, ``"interpolated"`` or ``"extrapolated"``.
    reasons : list of str
        Reasons for the status, and disagreements between laws.
    threshold_n : float or None
        Load at which the silicone carries half of the friction, N; None if it is not within the loads.
    threshold_band_n : tuple of float or None
        Loads between which the band allows the threshold, N.

    The arrays are read-only. A pickle has the configuration, the loads, the law and the model, and predicts the same
    curve again.
    """

    load_n: Floats
    eccentric_n: Floats
    concentric_n: Floats
    friction_n: Floats
    band_low_n: Floats
    band_high_n: Floats
    silicone_share: Floats

    def __init__(self, native: _pinswitch.Curve, inputs: _Inputs) -> None:
        self._native, self._inputs = native, inputs
        columns = native.columns()
        for name, column in columns.items():
            column.flags.writeable = False
            setattr(self, name, column)
        super().__init__({name.replace("_n", "_N") if name.endswith("_n") else name: c for name, c in columns.items()})
        facts = json.loads(native.facts())
        self.law: str = facts["law"]
        self.status: str = facts["status"]
        self.reasons: list[str] = facts["reasons"]
        transition = facts["transition"]
        self.threshold_n: Optional[float] = transition and transition["threshold_n"]
        self.threshold_band_n: Optional[tuple[float, float]] = transition and (transition["low_n"], transition["high_n"])

    @property
    def other_laws(self) -> dict[str, Table]:
        """Curves of the other laws that apply, at the same loads, by the name of the law."""
        return {law: Table(columns) for law, columns in self._native.other_laws()}

    def friction_at(self, load_n: ArrayLike) -> Floats:
        """Return the friction in N at loads in N, of any shape, by linear interpolation; NaN outside the curve."""
        inside = np.interp(np.asarray(load_n, dtype=float), self.load_n, self.friction_n, np.nan, np.nan)
        return np.asarray(inside, dtype=np.float64)

    def to_svg(self) -> str:
        """Return the figure of ``pinswitch generate``, with band, other laws and published points."""
        return self._native.svg()

    def to_csv(self) -> str:
        """Return ``friction.csv``."""
        return self._native.csv()

    def plot(self, ax: Any = None) -> Any:
        """Draw the curve with its band on matplotlib axes, and return the axes."""
        import matplotlib.pyplot as plt

        ax = plt.subplots(layout="constrained")[1] if ax is None else ax
        (line,) = ax.plot(self.load_n, self.friction_n, label=f"{self.law} ({self.status})")
        ax.fill_between(self.load_n, self.band_low_n, self.band_high_n, color=line.get_color(), alpha=0.2, lw=0)
        if self.threshold_n is not None:
            ax.axvline(self.threshold_n, color=line.get_color(), ls=":", lw=1)
        ax.set(xlabel="load, N", ylabel="friction, N")
        ax.legend()
        return ax

    def __reduce__(self) -> tuple[object, ...]:
        return (_predicted, self._inputs)

    def __repr__(self) -> str:
        last = f"{self.friction_n[-1]:.2f} N [{self.band_low_n[-1]:.2f}, {self.band_high_n[-1]:.2f}]"
        return f"Curve({self.law}, {self.status}: {last} at {self.load_n[-1]:.2f} N, {len(self)} loads)"

    def _repr_html_(self) -> str:
        from html import escape

        reasons = "".join(f"<li>{escape(reason)}</li>" for reason in self.reasons)
        return f'<div style="max-width:720px">{self.to_svg()}<ul>{reasons}</ul></div>'


class CurveTable(Table):
    """Curves of many configurations: one line for each row and load, as ``pinswitch predict --rows`` writes it.

    Columns: ``row`` (from 1), the columns of the input, ``status`` (``predicted``, ``refused`` or ``failed``),
    ``reason``, ``law``, ``trust``, ``threshold_N``, and those of a curve. A refused row has one line without numbers.
    """

    @property
    def predicted(self) -> Table:
        """The lines of rows that have a curve."""
        return self.filter(self["status"] == "predicted")

    @property
    def refused(self) -> Table:
        """The lines of rows whose configuration is invalid."""
        return self.filter(self["status"] == "refused")


ModelLike = Union[Model, str, "os.PathLike[str]", Any]


def _model_text(model: Any, law: Optional[str] = None) -> Optional[tuple[str, str]]:
    """Return the text and the name of a model, a calibration or a file; it replaces the law."""
    if law is not None and not isinstance(law, str):
        raise wrong_type("law", law, "the name of a law")
    if model is None:
        return None
    if law is not None:
        help = "omit one of them: a calibrated model replaces the law"
        raise PinswitchError("law and model exclude each other", code="conflicting-settings", help=help, field="law")
    if hasattr(model, "model"):
        model = model.model
    if not isinstance(model, Model):
        if not isinstance(model, (str, os.PathLike)):
            raise wrong_type("model", model, "a calibration, a model or the path of a model.toml")
        model = Model.load(model)
    return model.text, model.name


@overload
def predict(
    config: ConfigLike,
    loads_n: Optional[ArrayLike] = None,
    *,
    law: Optional[str] = None,
    model: Optional[ModelLike] = None,
) -> Curve: ...
@overload
def predict(
    config: ArrowTable, loads_n: None = None, *, law: Optional[str] = None, model: Optional[ModelLike] = None
) -> CurveTable: ...
def predict(
    config: ConfigLike | ArrowTable,
    loads_n: Optional[ArrayLike] = None,
    *,
    law: Optional[str] = None,
    model: Optional[ModelLike] = None,
) -> Curve | CurveTable:
    """Predict the friction curve of a configuration, or of every row of a frame.

    Parameters
    ----------
    config : Config or source of one, or frame
        The switch; also the name of a template, a file, or a mapping of values. The rows of a frame change the defaults:
        :func:`predict_table` takes another base.
    loads_n : array_like of float, shape (n,), optional
        Loads in N, positive and ascending. Without them, those of ``config.friction``.
    law : str, optional
        ``"physics"`` (default), ``"layout"`` or ``"paper"``.
    model : Calibration, Model or path, optional
        A calibrated model, whose curve excludes the effects of the rig.

    Raises
    ------
    PinswitchError
        If the configuration breaks a rule, a law does not apply, or the loads are not ascending.

    Examples
    --------
    >>> curve = predict(Config("three-double"), [10, 49.67])
    >>> curve.friction_n.shape, curve.status
    ((2,), 'published')
    """
    if any(hasattr(config, name) for name in ("__arrow_c_stream__", "iloc", "collect")):
        if loads_n is not None:
            help = "set the loads with columns such as friction.load_max_n"
            raise PinswitchError("loads_n is for one configuration", code="usage", help=help, field="loads_n")
        return predict_table(config, law=law, model=model)
    try:
        loads = None if loads_n is None else np.atleast_1d(np.asarray(loads_n, dtype=float))
    except (TypeError, ValueError) as error:
        help = "give positive loads in newtons, in ascending order"
        raise PinswitchError("not numbers", code="wrong-type", help=help, field="loads_n") from error
    if loads is not None and loads.ndim != 1:
        raise wrong_type("loads_n", loads_n, "one list of loads in newtons")
    loads = None if loads is None else loads.tolist()
    # What is not a frame is a configuration, or refused as one.
    return _predicted(config_of(cast(ConfigLike, config)), loads, law, _model_text(model, law))


def _predicted(
    config: Config, loads_n: Optional[list[float]], law: Optional[str], model: Optional[tuple[str, str]]
) -> Curve:
    curve = _pinswitch.predict(config._native, loads_n, law, model)
    # A copy: the caller may change the configuration.
    return Curve(curve, (Config._of(config._native.copy()), loads_n, law, model))


def predict_table(
    table: Any,
    config: Optional[ConfigLike] = None,
    *,
    law: Optional[str] = None,
    model: Optional[ModelLike] = None,
    threads: int = 0,
    progress: bool = False,
) -> CurveTable:
    """Predict the curve of every row of a table; each row changes ``config``.

    Parameters
    ----------
    table : frame, mapping, sequence of mappings, or path
        Columns are parameters, such as ``shell.width_mm`` and ``layout.pins``. A frame of pandas, polars or pyarrow, a
        mapping of columns, rows as dictionaries, or a CSV or Parquet file.
    config : Config or source of one, optional
        The base of every row; the defaults without it.
    threads : int
        Threads; 0 means one per processor.
    progress : bool
        Show a progress bar.

    Raises
    ------
    PinswitchError
        If a column is not a parameter, or the table has no rows. An invalid row is refused, and the others are
        predicted.

    Examples
    --------
    >>> base = Config("three-double", friction__points=3)
    >>> curves = predict_table({"layout.pins": [[5, 8, 11], [4, 8, 12]]}, base)
    >>> len(curves), sorted(set(curves["status"]))
    (6, ['predicted'])
    """
    content, name = _table_bytes(table)
    with progress_bar("rows", progress) as report:
        rows, counts, lines = _pinswitch.predict_rows(
            config_of({} if config is None else config)._native, content, name, law, _model_text(model, law), whole("threads", threads, 0, MAX_THREADS), report
        )
    columns: dict[str, Any] = {"row": np.repeat(np.arange(1, len(counts) + 1), counts)}
    reals = {f"{p['table']}.{p['key']}" for p in _pinswitch.parameters() if isinstance(p["default"], float)}
    for column, values in rows.items():
        # The same type in every table of curves, so that blocks can be joined.
        array = np.array(values, dtype=object) if column in TEXT_COLUMNS else _array(values)
        is_whole = column in reals and array.dtype.kind == "i"
        columns[column] = np.repeat(array.astype(np.float64) if is_whole else array, counts)
    return CurveTable({**columns, **lines})


def _array(values: Any) -> NDArray[Any]:
    if isinstance(values, np.ndarray):
        return values
    if values and all(isinstance(value, float) for value in values):
        return np.array(values, dtype=np.float64)
    if values and all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=np.int64)
    numbers = [None if value is None or value == "" else value for value in values]
    if numbers and all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in numbers):
        return np.array([np.nan if value is None else value for value in numbers], dtype=np.float64)
    array = np.empty(len(values), dtype=object)
    array[:] = [value if isinstance(value, str) else str(value) for value in values]
    return array


def _table_bytes(table: Any) -> tuple[bytes, str]:
    if isinstance(table, (str, os.PathLike)):
        return read_bytes(table), os.fspath(table)
    return csv_text(columns_of(table)).encode(), "table"


__all__: Sequence[str] = ["Curve", "CurveTable", "predict", "predict_table"]
