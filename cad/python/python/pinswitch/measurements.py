"""Measurements: files of any laboratory, logs, and simulated rigs."""

from __future__ import annotations

import gzip
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Optional

from . import _pinswitch
from ._checks import MAX_SEED, whole, wrong_type
from ._errors import PinswitchError
from ._files import PathLike, read_bytes, read_text
from ._notebook import elapsed
from .curve import ModelLike, _model_text
from .effects import effect_texts
from .table import Table, read_csv

#: Ends of the names of files that are read from a folder.
ENDINGS = frozenset({"csv", "txt", "tsv", "dat", "lvm", "xlsx", "xls", "ods", "parquet", "gz"})
#: Most bytes of an unpacked file.
MAX_UNPACKED = 1 << 29
#: Most simulated experiments per effect and size.
MOST_RUNS = 1_000


class Measurements(Table):
    """A plateau table, or a log, with what was understood.

    Columns of a plateau table: ``model/doc/file-formats.md``. Those of a log: ``time_s``, ``force_N`` and others.

    Attributes
    ----------
    kind : str
        ``"table"`` or ``"log"``.
    understanding : dict
        What was recognised in each file: format, columns with units and factors, directions, constants, notes.
    map : str
        Every decision as TOML; with it, the same files give the same table.
    """

    def __init__(self, table: Table, kind: str, text: str, understanding: dict[str, Any], map: str) -> None:
        super().__init__({name: table[name] for name in table})
        self.kind = kind
        self.understanding = understanding
        self.map = map
        self._text = text

    def __str__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(self._text)}</pre>{super()._repr_html_()}"


def read(
    *sources: PathLike,
    map: Optional[PathLike] = None,
    set: Optional[Mapping[str, object]] = None,
    pattern: Optional[str] = None,
) -> Measurements:
    """Read files of any laboratory: text with any delimiter, encoding and decimal sign, LabVIEW, Excel, Parquet.

    Parameters
    ----------
    *sources : path
        Files, or folders with files; ``.gz`` files are unpacked.
    map : path, optional
        Decisions that an earlier import wrote.
    set : mapping, optional
        Single decisions, such as ``{"unit.Load": "kg", "wrap_angle_deg": 90}``.
    pattern : str, optional
        Values in the names of files, such as ``"{load_g}g_{trial}.csv"``.

    Raises
    ------
    PinswitchError
        If a file cannot be read, or a value has two readings; ``error.help`` lists the decisions.
    """
    for source in sources:
        if not isinstance(source, (str, os.PathLike)):
            raise wrong_type("sources", source, "the path of a file or a folder")
    files = [(os.fspath(path), _unpacked(path)) for path in _files(sources, pattern)]
    decisions = None if map is None else (read_text(map), os.fspath(map))
    if set is not None and not isinstance(set, Mapping):
        raise wrong_type("set", set, "a mapping")
    assignments = [f"{key}={value}" for key, value in (set or {}).items()]
    csv, kind, text, understanding, complete = _pinswitch.import_files(files, decisions, assignments, pattern)
    understood = json.loads(understanding)
    if csv is None:
        question = understood["questions"][0]
        options = ", or ".join(
            f"set={dict(option.split('=', 1) for option in answer['options'])!r} ({answer['reading']})"
            for answer in question["answers"]
        )
        raise PinswitchError(question["problem"], code=question["code"], help=f"decide with {options}")
    return Measurements(read_csv(csv), kind, text, understood, complete)


def _files(sources: Sequence[PathLike], pattern: Optional[str]) -> list[Path]:
    files: list[Path] = []
    for source in map(Path, sources):
        if not source.is_dir():
            files.append(source)
            continue
        all_files = (path for path in source.iterdir() if path.is_file())
        wanted = (path for path in all_files if pattern or path.suffix[1:].lower() in ENDINGS)
        files += sorted(wanted, key=_natural)
    return files


def _natural(path: Path) -> list[tuple[int, str]]:
    """Return a key by which numbers in names count as numbers."""
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdigit() else (0, part) for part in parts]


def _unpacked(path: PathLike) -> bytes:
    content = read_bytes(path)
    if not content.startswith(b"\x1f\x8b"):
        return content
    try:
        with gzip.open(path) as file:
            content = file.read(MAX_UNPACKED + 1)
    except (OSError, EOFError) as error:
        help = "give a complete gzip file"
        raise PinswitchError("cannot unpack", code="damaged-file", help=help, file=os.fspath(path)) from error
    if len(content) > MAX_UNPACKED:
        raise PinswitchError(f"unpacks to more than {MAX_UNPACKED} bytes", code="file-too-large", file=os.fspath(path))
    return content


class Segmentation(Table):
    """The plateau table of raw logs.

    Attributes
    ----------
    report : dict
        Plateaus and faults of each log.
    figures : dict of str to str
        SVG of each log, with its plateaus marked.
    """

    def __init__(self, table: Table, report: dict[str, Any], summary: str, figures: dict[str, str]) -> None:
        super().__init__({name: table[name] for name in table})
        self.report = report
        self.figures = figures
        self._summary = summary

    def __str__(self) -> str:
        return self._summary


def segment(run: PathLike, *, figures: bool = True) -> Segmentation:
    """Convert raw logs to a plateau table (``model/doc/logs.md``).

    Parameters
    ----------
    run : path
        Description of the run (``run.toml``), in the folder of its logs.
    figures : bool
        Draw each log.

    Raises
    ------
    PinswitchError
        If a log is missing, outside the folder, or contains no plateau.
    """
    path = Path(run)
    text, name, folder = read_text(path), os.fspath(run), path.parent
    logs, map_name = _pinswitch.run_files(text, name)
    for log in logs:
        if not (folder / log).resolve().is_relative_to(folder.resolve()):
            raise PinswitchError(
                "the log is outside the folder of the description",
                code="outside-the-folder",
                help="copy it there",
                file=log,
            )
    contents = {log: _unpacked(folder / log) for log in logs}
    named_map = map_name and (read_text(folder / map_name), map_name)
    csv, report, summary, drawn = _pinswitch.segment(text, name, contents, named_map or None, figures)
    return Segmentation(read_csv(csv), json.loads(report), summary, dict(drawn))


class Simulation(Table):
    """The plateau table of a simulated rig.

    Attributes
    ----------
    fresh : Table
        The same rows without noise.
    plan : str
        The plan as TOML, with every default.
    """

    def __init__(self, csv: str, fresh: str, plan: str) -> None:
        table = read_csv(csv)
        super().__init__({name: table[name] for name in table})
        self.fresh = read_csv(fresh)
        self.plan = plan


def simulate(
    plan: Optional[PathLike] = None,
    *,
    acting: Optional[Mapping[str, Any]] = None,
    randomised: bool = False,
    effects: Sequence[Any] = (),
    noise: Optional[ModelLike] = None,
    seed: Optional[int] = None,
    next: bool = False,
) -> Simulation:
    """Simulate a rig with known effects and noise.

    Parameters
    ----------
    plan : path, optional
        Plan (``pinswitch init plan``). Without it, the paper's rig.
    acting : mapping, optional
        Effects that act, with their values: ``{"coating_ploughing": 0.02}``; several values as a sequence.
    randomised : bool
        Without a plan: loads up and down, several speeds and dwells, instead of the paper's protocol.
    effects : sequence of Effect or path
        User-defined effects that ``acting`` may name.
    noise : Calibration, Model or path, optional
        Model whose noise replaces the plan's.
    seed : int, optional
        Seed of the noise.
    next : bool
        Simulate a later session of the same rig.
    """
    if acting is not None and not isinstance(acting, Mapping):
        raise wrong_type("acting", acting, "a mapping")
    values = [(id, _values(id, value)) for id, value in (acting or {}).items()]
    seed = None if seed is None else whole("seed", seed, 0, MAX_SEED)
    text = _plan_text(plan)
    return Simulation(
        *_pinswitch.simulate(text, randomised, values, effect_texts(effects), _model_text(noise), seed, next)
    )


def power(
    plan: Optional[PathLike] = None,
    *,
    runs: int = 3,
    randomised: bool = False,
    effects: Sequence[Any] = (),
    noise: Optional[ModelLike] = None,
    progress: bool = False,
) -> list[dict[str, Any]]:
    """Estimate which effects a planned experiment could detect: ``runs`` simulated experiments per effect and size.

    Returns
    -------
    list of dict
        ``id``, ``values``, ``runs``, and the numbers of runs ``named``, ``ambiguous`` and ``missed``; ``others``.
    """
    inputs = (_plan_text(plan), randomised, effect_texts(effects), _model_text(noise))
    runs = whole("runs", runs, 1, MOST_RUNS)
    with elapsed("simulating experiments", progress):
        rates: list[dict[str, Any]] = json.loads(_pinswitch.power(*inputs, runs))
    return rates


def _values(id: str, value: Any) -> list[float]:
    is_sequence = hasattr(value, "__iter__") and not isinstance(value, str)
    try:
        return [float(one) for one in (value if is_sequence else [value])]
    except (TypeError, ValueError) as error:
        raise wrong_type(f"acting[{id!r}]", value, "a number, or several") from error


def _plan_text(plan: Optional[PathLike]) -> Optional[tuple[str, str]]:
    return None if plan is None else (read_text(plan), os.fspath(plan))
