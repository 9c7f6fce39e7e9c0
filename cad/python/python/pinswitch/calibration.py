"""Calibration of the model with measurements."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any, Optional

import numpy as np

from . import _pinswitch
from ._checks import in_range, wrong_type
from ._files import read_text
from ._notebook import elapsed
from .config import ConfigLike
from .curve import Curve, predict
from .effects import effect_texts
from .model import Floats, Model, plateau_bytes
from .parts import write_files
from .table import Table


#: Longest session in minutes, a week of eight hours a day, and shares of the loads, as on the command line.
MAX_MINUTES = 2400.0
FIT_BELOW = (0.1, 0.99)


class Experiment:
    """A proposed session.

    Attributes
    ----------
    runs : str
        ``next-runs.csv``.
    sheet : str
        The run sheet as HTML.
    report : dict
        ``experiment.json``: questions with the probability that the runs answer them, and what the rig cannot answer.
    """

    def __init__(self, report: dict[str, Any], runs: str, sheet: str) -> None:
        self.report, self.runs, self.sheet = report, runs, sheet

    def save(self, folder: str | os.PathLike[str], *, overwrite: bool = False) -> list[Path]:
        """Write experiment.json, next-runs.csv and run-sheet.html, which ``pinswitch calibrate --plan`` reads."""
        files = {"next-runs.csv": self.runs, "run-sheet.html": self.sheet, "experiment.json": json.dumps(self.report)}
        return write_files(folder, {name: text.encode() for name, text in files.items()}, overwrite=overwrite)

    def _repr_html_(self) -> str:
        return self.sheet

    def __repr__(self) -> str:
        minutes, runs = self.report["minutes"], max(self.runs.count("\n") - 1, 0)
        return f"Experiment({runs} runs, {minutes:.0f} minutes)"


class Calibration:
    """The posterior over effects that the paper's model may lack.

    Attributes
    ----------
    report : dict
        ``report.json`` (``model/doc/file-formats.md``).
    """

    def __init__(self, native: _pinswitch.Calibration) -> None:
        self._native = native
        self.report: dict[str, Any] = json.loads(native.report())
        self._model: Optional[Model] = None

    @property
    def verdict(self) -> str:
        """``none``, ``inconclusive``, ``attributed``, ``ambiguous`` or ``unattributed``."""
        return str(self.report["verdict"])

    @property
    def probabilities(self) -> dict[str, float]:
        """Posterior probability of each effect, the most probable first."""
        return {candidate["id"]: candidate["probability"] for candidate in self.report["candidates"]}

    @property
    def effects(self) -> dict[str, dict[str, Any]]:
        """Effects of the model by id: probability, constants with 95 % intervals, rivals, formula."""
        return {effect["id"]: effect for effect in self.report["effects"]}

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """95 % interval of the size of each effect that is not in the model, by id."""
        return {limit["id"]: (limit["low"], limit["high"]) for limit in self.report["limits"]}

    @property
    def intervals(self) -> dict[str, tuple[float, float, float]]:
        """Value and 95 % interval of each constant of the best model: ``(value, low, high)``."""
        constants = self.report["augmented"]["parameters"]
        return {name: (c["value"], *c["ci95"]) for name, c in constants.items()}

    @property
    def expected_error_n(self) -> Optional[float]:
        """Expected error of a new session of the same rig, N; None with too few series."""
        error = self.report.get("expected_error_N")
        return None if error is None else float(error["value"])

    @property
    def model(self) -> Model:
        """The best model."""
        if self._model is None:
            self._model = Model(self._native.model())
        return self._model

    @property
    def baseline(self) -> Model:
        """The refitted model of the paper."""
        return Model(self._native.baseline())

    @property
    def residuals(self) -> Table:
        """Reading, prediction of both models, residuals (N) and weight of each row."""
        columns = self._native.residuals()
        reading = columns["force_N"]
        for name in ("baseline", "model"):
            columns[f"residual_{name}_N"] = reading - columns[f"{name}_N"]
        return Table(columns)

    def predict(self, table: Any, *, fitted_session: bool = False) -> tuple[Floats, Floats]:
        """Predict readings of the rig: :meth:`Model.predict` of the best model."""
        return self.model.predict(table, fitted_session=fitted_session)

    def curve(self, config: ConfigLike, loads_n: Any = None) -> Curve:
        """Return the curve of a printed part, without the effects of the rig."""
        return predict(config, loads_n, model=self)

    def draws(self, count: int = 1000, *, seed: int = 1) -> dict[str, Floats]:
        """Draw constants of the best model: :meth:`Model.draws`."""
        return self.model.draws(count, seed=seed)

    def to_arviz(self, count: int = 1000, *, seed: int = 1) -> Any:
        """Return the draws as ``arviz.InferenceData``, in one chain.

        The draws are independent: they come from the normal approximation of the posterior, not from a Markov chain.
        The group ``posterior`` has the constants, ``observed_data`` the readings.
        """
        import arviz

        posterior = {name: values[np.newaxis] for name, values in self.draws(count, seed=seed).items()}
        observed = {"force_N": self.residuals["force_N"]}
        if hasattr(arviz, "InferenceData"):
            return arviz.from_dict(posterior=posterior, observed_data=observed)
        return arviz.from_dict({"posterior": posterior, "observed_data": observed})

    def experiment(self, minutes: float = 60.0, *, rig: Optional[str | os.PathLike[str]] = None) -> Experiment:
        """Plan the session that answers most open questions in a time.

        Parameters
        ----------
        minutes : float
            Available time.
        rig : path, optional
            Limits of the rig (``pinswitch init rig``).
        """
        minutes = in_range("minutes", minutes, 1e-3, MAX_MINUTES, "minutes")
        limits = None if rig is None else (read_text(rig), os.fspath(rig))
        report, runs, sheet = self._native.experiment(minutes, limits)
        return Experiment(json.loads(report), runs, sheet)

    def to_html(self) -> str:
        """Return the page of the calibration, with its figures."""
        return self._native.files()["report.html"].decode()

    def save(self, folder: str | os.PathLike[str], *, overwrite: bool = False) -> list[Path]:
        """Write the files of ``pinswitch calibrate`` into a folder, except ``provenance.json``."""
        return write_files(folder, self._native.files(), overwrite=overwrite)

    def plot(self, ax: Any = None) -> Any:
        """Draw the residuals of both models over the reading, and return the axes."""
        import matplotlib.pyplot as plt

        ax = plt.subplots(layout="constrained")[1] if ax is None else ax
        residuals = self.residuals
        for name, label in (("baseline", "the paper's model, refitted"), ("model", "with the effects found")):
            ax.plot(residuals["force_N"], residuals[f"residual_{name}_N"], ".", ms=3, label=label)
        ax.axhline(0, color="black", lw=0.5)
        ax.set(xlabel="reading, N", ylabel="residual, N")
        ax.legend()
        return ax

    def __reduce__(self) -> tuple[object, ...]:
        raise TypeError("a calibration cannot be pickled; pickle its model, or save it to a folder")

    def __repr__(self) -> str:
        found = ", ".join(f"{id} {effect['probability']:.3f}" for id, effect in self.effects.items())
        return f"Calibration({self.verdict}: {found or 'no effects'})"

    def _repr_html_(self) -> str:
        def constants(parameters: Mapping[str, Any]) -> str:
            shown = (
                f"{escape(name)} = {c['value']:.4g} [{c['ci95'][0]:.4g}, {c['ci95'][1]:.4g}] {escape(c['unit'])}"
                for name, c in parameters.items()
            )
            return "<br>".join(shown)

        rows = "".join(
            f"<tr><td><code>{escape(id)}</code></td><td>{effect['probability']:.4f}</td>"
            f"<td>{constants(effect['parameters'])}</td>"
            f"<td>{', '.join(escape(rival['id']) for rival in effect['rivals'])}</td></tr>"
            for id, effect in self.effects.items()
        )
        head = "<tr><th>effect</th><th>probability</th><th>constants (95 % interval)</th><th>rivals</th></tr>"
        before, after = (self.report[name]["heldout_rmse_N"] for name in ("baseline", "augmented"))
        text = f"verdict: <b>{escape(self.verdict)}</b>; held-out error {before:.3f} N by the paper's model, "
        text += f"{after:.3f} N by this model (noise {self.report['noise_floor_N']:.3f} N)"
        baseline = constants(self.report["baseline"]["parameters"])
        return (
            f"<p>{text}</p><table><thead>{head}</thead><tbody>{rows}</tbody></table>"
            f"<details><summary>constants of the paper's model</summary>{baseline}</details>"
        )


def experiment(
    calibration: Calibration, minutes: float = 60.0, *, rig: Optional[str | os.PathLike[str]] = None
) -> Experiment:
    """Plan the session that answers most open questions of a calibration: :meth:`Calibration.experiment`."""
    if not isinstance(calibration, Calibration):
        raise wrong_type("calibration", calibration, "a calibration")
    return calibration.experiment(minutes, rig=rig)


def calibrate(
    *tables: Any, effects: Sequence[Any] = (), fit_below: Optional[float] = None, progress: bool = False
) -> Calibration:
    """Refit the paper's model to plateau tables, and infer the effects that it lacks.

    The method and its sources: ``model/doc/naming-an-effect.md``.

    Parameters
    ----------
    *tables : frame or path
        Plateau tables; several are sessions of one rig, in their order.
    effects : sequence of Effect or path
        User-defined effects, in addition to the catalogue.
    fit_below : float, optional
        Fit loads up to this share of the highest one, and test both models on the others.
    progress : bool
        Show the elapsed time.

    Raises
    ------
    PinswitchError
        If a cell cannot be used, or the rows are too few.
    """
    named = []
    for number, table in enumerate(tables, 1):
        # Each session of several has a name of its own.
        content, name = plateau_bytes(table, "table" if len(tables) == 1 else f"table {number}")
        named.append((name, content))
    fit_below = None if fit_below is None else in_range("fit_below", fit_below, *FIT_BELOW)
    texts = effect_texts(effects)
    with elapsed("calibrating", progress):
        return Calibration(_pinswitch.calibrate(named, texts, fit_below))
