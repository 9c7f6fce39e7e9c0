"""Models of a calibration."""

from __future__ import annotations

import os
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _pinswitch
from ._checks import MAX_SEED, whole
from ._files import read_bytes, read_text, write_text
from .table import columns_of, csv_text

Floats = NDArray[np.float64]
#: Most draws of constants.
MOST_DRAWS = 10_000_000


class Model:
    """A fitted model: ``model.toml`` or ``baseline.toml`` of a calibration.

    Attributes
    ----------
    text : str
        The text of the file.
    name : str
        The name of the file in errors.
    """

    def __init__(self, native: _pinswitch.Model) -> None:
        self._native = native

    @property
    def text(self) -> str:
        """The text of the file."""
        return self._native.text

    @property
    def name(self) -> str:
        """The name in errors."""
        return self._native.name

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model file.

        Raises
        ------
        PinswitchError
            If the file cannot be read, is not a model, or was changed since pinswitch wrote it.
        """
        return cls.parse(read_text(path), os.fspath(path))

    @classmethod
    def parse(cls, text: str, name: str = "model.toml") -> Model:
        """Return the model of a text; ``name`` is that of the file in errors."""
        return cls(_pinswitch.Model.parse(text, name))

    def __reduce__(self) -> tuple[object, ...]:
        return (Model.parse, (self.text, self.name))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file."""
        write_text(path, self.text)

    @property
    def constants(self) -> dict[str, tuple[float, str]]:
        """Fitted value and unit of each constant."""
        return {name: (value, unit) for name, unit, value in self._native.constants([])}

    def predict(self, table: Any, *, fitted_session: bool = False) -> tuple[Floats, Floats]:
        """Predict readings of the rig.

        Parameters
        ----------
        table : frame or path
            A plateau table (``model/doc/file-formats.md``); ``force_N`` is not used.
        fitted_session : bool
            The rows are of the session that was fitted: a drift has its value at their times, not its mean.

        Returns
        -------
        predicted_n, sd_n : ndarray, shape (n,)
            Readings and their standard deviations, N.
        """
        content, name = plateau_bytes(table)
        return self._native.predict(content, name, fitted_session)

    def draws(self, count: int = 1000, *, seed: int = 1) -> dict[str, Floats]:
        """Draw constants from their posterior: a normal distribution of their coordinates.

        Parameters
        ----------
        count : int
            Number of draws.
        seed : int
            Seed of numpy's generator.

        Returns
        -------
        dict of str to ndarray, shape (count,)
            Draws of each constant, in its unit.
        """
        count, seed = whole("count", count, 0, MOST_DRAWS), whole("seed", seed, 0, MAX_SEED)
        variates = np.random.default_rng(seed).standard_normal((count, self._native.dimension()))
        rows = [self._native.constants(z) for z in variates.tolist()]
        names = list(self.constants)
        values = np.array([[value for _, _, value in row] for row in rows], dtype=np.float64).reshape(count, len(names))
        return {name: values[:, i] for i, name in enumerate(names)}

    def __repr__(self) -> str:
        constants = ", ".join(f"{name}={value:.4g}" for name, (value, _) in self.constants.items())
        return f"Model({self.name}: {constants})"


def plateau_bytes(table: Any, name: str = "table") -> tuple[bytes, str]:
    """Return a plateau table as CSV, with its name in errors; ``name`` is that of a frame."""
    if isinstance(table, (str, os.PathLike)):
        return read_bytes(table), os.fspath(table)
    columns = columns_of(table)
    if "repetition" in columns:
        columns["repetition"] = [_whole(value) for value in columns["repetition"]]
    return csv_text(columns).encode(), name


def _whole(value: Optional[Any]) -> Any:
    """Return a whole float as an integer: frames store counts with gaps as floats."""
    return int(value) if isinstance(value, float) and value.is_integer() else value
