"""Designs from a request, sweeps, and the check of meshes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Optional, overload

import numpy as np

from . import _pinswitch
from ._checks import MAX_SEED, MAX_THREADS, in_range, whole, wrong_type
from ._errors import PinswitchError
from ._files import read_bytes, read_text
from ._notebook import progress_bar
from .config import Config, ConfigLike, config_of
from .curve import ModelLike, _model_text
from .effects import _quoted
from .table import Table, read_csv

Request = Mapping[str, Any]
#: Most proposals, draws and starts.
MOST = 1_000_000


class Proposal:
    """A proposed design.

    Attributes
    ----------
    config : Config
        The configuration.
    report : dict
        Entry of ``design.json``: probability, targets, uncertainty, sensitivity.
    """

    def __init__(self, config: Config, report: dict[str, Any]) -> None:
        self.config, self.report = config, report

    @property
    def pins(self) -> list[int]:
        """Occupied grooves."""
        return list(self.report["pins"])

    @property
    def probability(self) -> float:
        """Probability that a manufactured part meets all targets."""
        return float(self.report["probability"]["all"])

    @property
    def threshold_n(self) -> Optional[float]:
        """Threshold, N."""
        value = self.report["threshold_n"]
        return None if value is None else float(value)

    @property
    def friction_n(self) -> float:
        """Friction at the heaviest load, N."""
        return float(self.report["friction_n"])

    @property
    def status(self) -> str:
        """Support by measurements: ``"published"``, ``"interpolated"`` or ``"extrapolated"``."""
        return str(self.report["trust"])

    def __repr__(self) -> str:
        threshold = "none" if self.threshold_n is None else f"{self.threshold_n:.2f} N"
        return (
            f"Proposal({self.pins}, threshold {threshold}, friction {self.friction_n:.2f} N, "
            f"probability {self.probability:.3f}, {self.status})"
        )


class Designs(Sequence[Proposal]):
    """Proposals for a request, the most probable first; if none meets it, the nearest design.

    Attributes
    ----------
    is_possible : bool
        Whether a design meets the request.
    blocked : dict or None
        Why none does: the limit, the missed targets, and the parameters to change.
    """

    def __init__(
        self,
        proposals: list[Proposal],
        blocked: Optional[dict[str, Any]],
        patterns: list[tuple[Optional[float], float, list[int]]],
    ) -> None:
        self._proposals, self.blocked, self._patterns = proposals, blocked, patterns
        self.is_possible = blocked is None and bool(proposals)

    def __len__(self) -> int:
        return len(self._proposals)

    @overload
    def __getitem__(self, index: int) -> Proposal: ...
    @overload
    def __getitem__(self, index: slice) -> list[Proposal]: ...
    def __getitem__(self, index: int | slice) -> Proposal | list[Proposal]:
        return self._proposals[index]

    def plot(self, ax: Any = None) -> Any:
        """Draw threshold and friction of all patterns, with the proposals, and return the axes."""
        import matplotlib.pyplot as plt

        ax = plt.subplots(layout="constrained")[1] if ax is None else ax
        points = [(threshold, friction) for threshold, friction, _ in self._patterns if threshold is not None]
        ax.plot(*zip(*points), ".", ms=3, color="0.7", label="patterns of pins")
        for number, proposal in enumerate(self, 1):
            if proposal.threshold_n is not None:
                ax.plot(proposal.threshold_n, proposal.friction_n, "o", label=f"{number}: {proposal.pins}")
        ax.set(xlabel="threshold, N", ylabel="friction at the heaviest load, N")
        ax.legend()
        return ax

    def __repr__(self) -> str:
        return f"Designs({self._proposals!r})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{number}</td><td>{one.pins}</td><td>{one.probability:.3f}</td>"
            f"<td>{'' if one.threshold_n is None else f'{one.threshold_n:.2f}'}</td><td>{one.friction_n:.2f}</td>"
            f"<td>{one.status}</td></tr>"
            for number, one in enumerate(self, 1)
        )
        names = ("", "pins", "probability", "threshold, N", "friction, N", "status")
        head = f"<tr>{''.join(f'<th>{name}</th>' for name in names)}</tr>"
        note = "" if self.is_possible else "<p>no design meets the request; this is the nearest</p>"
        return f"{note}<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def design(
    request: Request | str | os.PathLike[str],
    base: Optional[ConfigLike] = None,
    *,
    model: Optional[ModelLike] = None,
    best: int = 5,
    draws: int = 1000,
    seed: int = 1,
    starts: int = 16,
    progress: bool = False,
) -> Designs:
    """Find pins, grooves and silicone that meet a request (``cad/doc/design.md``).

    Parameters
    ----------
    request : mapping or path
        Tables of a request file: ``{"targets": {"threshold_n": 24, "max_friction_n": "at most 9"}}``, and optionally
        ``limits``, ``vary``, ``materials`` and ``tolerances``; or the file.
    base : Config or source of one, optional
        The configuration that proposals change; ``three-double`` without it.
    model : Calibration, Model or path, optional
        A calibrated model in place of the published constants.
    best, draws, starts : int
        Number of proposals, of simulated parts per probability, and of optimised patterns.
    progress : bool
        Show a progress bar.

    Raises
    ------
    PinswitchError
        If the request is invalid. An impossible request is not an error: see :attr:`Designs.is_possible`.
    """
    if isinstance(request, Mapping):
        for table, values in request.items():
            if not isinstance(values, Mapping):
                raise wrong_type(f"request[{table!r}]", values, "a mapping")
        text, name = "".join(_table(table, values) for table, values in request.items()), "request"
    else:
        text, name = read_text(request), os.fspath(request)
    native = config_of("three-double" if base is None else base)._native
    best, draws, starts = (
        whole(option, value, 1, MOST) for option, value in (("best", best), ("draws", draws), ("starts", starts))
    )
    seed = whole("seed", seed, 0, MAX_SEED)
    with progress_bar("steps", progress) as report:
        reports, texts, blocked, patterns = _pinswitch.design(
            native, text, name, _model_text(model), best, draws, seed, starts, report
        )
    proposals = [Proposal(Config.from_toml(toml), one) for one, toml in zip(json.loads(reports), texts)]
    return Designs(proposals, json.loads(blocked), patterns)


def _table(name: str, values: Mapping[str, Any]) -> str:
    return f"[{name}]\n" + "".join(f"{key} = {_toml(value)}\n" for key, value in values.items())


def _toml(value: Any) -> str:
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return repr(value)


class Batch:
    """The variants of a sweep.

    Attributes
    ----------
    folder : Path
        The folder with the variants.
    tally : dict
        Numbers of variants ``made``, ``refused`` and ``failed``, and of part files.
    """

    def __init__(self, folder: Path, tally: dict[str, Any]) -> None:
        self.folder, self.tally = folder, tally

    @property
    def variants(self) -> Table:
        """``variants.csv``: a row for each variant. A shard has none: ``pinswitch merge`` joins all shards.

        Raises
        ------
        PinswitchError
            If the folder has no such table.
        """
        if not (self.folder / "variants.csv").exists():
            help = f"make every shard, then join them with `pinswitch merge {self.folder}`"
            raise PinswitchError("the shards are not joined", code="file-not-found", help=help, file=str(self.folder))
        return read_csv(read_text(self.folder / "variants.csv"))

    def __repr__(self) -> str:
        made, refused, failed = (self.tally[name] for name in ("made", "refused", "failed"))
        return f"Batch({self.folder}: {made} made, {refused} refused, {failed} failed)"


def batch(
    sweep: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    shard: Optional[str] = None,
    threads: int = 0,
    read_outside: bool = False,
    progress: bool = False,
) -> Batch:
    """Make the variants of a sweep (``cad/doc/batch.md``). The same call resumes an interrupted batch.

    Parameters
    ----------
    sweep : path
        The sweep file.
    out : path
        The folder of the batch.
    shard : str, optional
        ``"K/N"``: the K-th of N parts; ``pinswitch merge`` joins them.
    threads : int
        Threads; 0 means one per processor.
    read_outside : bool
        Allow the sweep to name files outside its folder.
    """
    for name, value in (("sweep", sweep), ("out", out)):
        if not isinstance(value, (str, os.PathLike)):
            raise wrong_type(name, value, "a path")
    if shard is not None and not isinstance(shard, str):
        raise wrong_type("shard", shard, 'a text such as "1/4"')
    with progress_bar("variants", progress) as report:
        threads = whole("threads", threads, 0, MAX_THREADS)
        tally = _pinswitch.batch(os.fspath(sweep), os.fspath(out), shard, threads, read_outside, report)
    return Batch(Path(out), json.loads(tally))


class MeshCheck:
    """The verdict on a mesh file.

    Attributes
    ----------
    is_valid : bool
        Whether the file is a valid printable solid.
    faults : list of dict
        ``check``, ``level``, ``count``, ``detail`` and a place for each fault.
    report : dict
        Everything, as ``pinswitch check --json`` prints it.
    """

    def __init__(self, report: dict[str, Any], text: str) -> None:
        self.report, self._text = report, text
        self.is_valid = bool(report["valid"])
        self.faults: list[dict[str, Any]] = report["faults"]

    def __bool__(self) -> bool:
        return self.is_valid

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"MeshCheck({self._text.strip()})"


def check(
    path: str | os.PathLike[str],
    *,
    bodies: Optional[int] = None,
    min_wall_mm: float = 0.4,
    strict: bool = False,
    purpose: Optional[str] = None,
) -> MeshCheck:
    """Check whether an STL or 3MF of any program is a valid printable solid (``cad/doc/meshes.md``).

    Parameters
    ----------
    path : path
        The file.
    bodies : int, optional
        Required number of bodies.
    min_wall_mm : float
        Thinner walls are reported.
    strict : bool
        Count warnings as errors.
    purpose : str, optional
        ``"print"`` or ``"spec"``; both without it.

    Raises
    ------
    PinswitchError
        If the file cannot be read.
    """
    bodies = None if bodies is None else whole("bodies", bodies, 1, MOST)
    min_wall_mm = in_range("min_wall_mm", min_wall_mm, 0.0, 1e6, "mm")
    report, text = _pinswitch.check(read_bytes(path), os.fspath(path), bodies, min_wall_mm, strict, purpose)
    return MeshCheck(json.loads(report), text)
