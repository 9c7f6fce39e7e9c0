"""Built parts."""

from __future__ import annotations

import base64
import json
import os
import tempfile
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any, Optional, overload

import numpy as np
from numpy.typing import NDArray

from . import _pinswitch
from ._errors import PinswitchError
from ._files import cannot_write
from .config import Config, ConfigLike, config_of
from .curve import Curve, predict

#: Size of the turning picture in pixels, and its number of views.
PICTURE = (420, 320, 24)


class Part:
    """A printed part, on the print bed.

    Attributes
    ----------
    name : str
        Such as ``"shell"``.
    vertices : ndarray, shape (n, 3)
        Corners in mm. The array is a read-only view of the mesh of the library, not a copy.
    triangles : ndarray of uint32, shape (m, 3)
        Indices of corners, counter-clockwise seen from outside; also a view.
    facts : dict
        Measured properties, such as ``volume_mm3``, ``surface_mm2``, ``low_mm`` and ``high_mm``.
    """

    def __init__(self, parts: _pinswitch.Parts, name: str) -> None:
        self._parts = parts
        self.name = name
        self.vertices: NDArray[np.float64]
        self.triangles: NDArray[np.uint32]
        self.vertices, self.triangles = parts.mesh(name)
        self.facts: dict[str, Any] = json.loads(parts.facts(name))

    @property
    def volume_mm3(self) -> float:
        """Volume of the mesh, mm³."""
        return float(self.facts["volume_mm3"])

    def to_stl(self) -> bytes:
        """Return binary STL in mm."""
        return self._parts.stl(self.name)

    def __repr__(self) -> str:
        return f"Part({self.name}: {self.volume_mm3:.1f} mm3, {len(self.triangles)} triangles)"


class Parts:
    """The built parts of a switch; a sequence of :class:`Part` that is also indexed by name.

    A pickle has the configuration, and builds the parts again.
    """

    def __init__(self, native: _pinswitch.Parts, config: Config) -> None:
        self._native = native
        self.config = config
        self._parts = {name: Part(native, name) for name in native.names}

    def __len__(self) -> int:
        return len(self._parts)

    def __iter__(self) -> Iterator[Part]:
        return iter(self._parts.values())

    @overload
    def __getitem__(self, name: str | int) -> Part: ...
    @overload
    def __getitem__(self, name: slice) -> list[Part]: ...
    def __getitem__(self, name: str | int | slice) -> Part | list[Part]:
        return self._parts[name] if isinstance(name, str) else list(self._parts.values())[name]

    def __contains__(self, part: object) -> bool:
        return part in self._parts or part in self._parts.values()

    @property
    def names(self) -> list[str]:
        """Names of the parts."""
        return list(self._parts)

    @property
    def warnings(self) -> list[str]:
        """Warnings of the design, such as thin walls."""
        return self._native.warnings()

    def to_files(self, formats: Optional[str | Sequence[str]] = None, *, curve: Optional[Curve] = None) -> dict[str, bytes]:
        """Return the files of the set by name, as ``pinswitch generate`` writes them.

        Parameters
        ----------
        formats : str or sequence of str, optional
            Such as ``["stl", "3mf", "step"]``; ``["all"]`` for all. Without it, those of ``generate``.
        curve : Curve, optional
            The curve in the documents. Without it, that of :func:`pinswitch.predict`.
        """
        names = None if formats is None else [formats] if isinstance(formats, str) else list(formats)
        chosen = predict(self.config) if curve is None else curve
        return self._native.files(chosen._native, names, self.config.switch.name)

    def save(
        self,
        folder: str | os.PathLike[str],
        formats: Optional[str | Sequence[str]] = None,
        *,
        curve: Optional[Curve] = None,
        overwrite: bool = False,
    ) -> list[Path]:
        """Write the files of :meth:`to_files` into a folder; the manifest is written last.

        Raises
        ------
        PinswitchError
            If a file exists and ``overwrite`` is false. Nothing is written then.
        """
        return write_files(folder, self.to_files(formats, curve=curve), overwrite=overwrite)

    def plot(self, ax: Any = None) -> Any:
        """Draw the print meshes side by side on 3D axes of matplotlib, and return the axes."""
        import matplotlib.pyplot as plt

        ax = plt.figure(layout="constrained").add_subplot(projection="3d") if ax is None else ax
        x = 0.0
        for part in self:
            low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
            corners = part.vertices - [low[0] - x, 0, 0]
            ax.plot_trisurf(corners[:, 0], corners[:, 1], corners[:, 2], triangles=part.triangles, label=part.name)
            x += high[0] - low[0] + 5
        ax.set(xlabel="mm", aspect="equal")
        return ax

    def __reduce__(self) -> tuple[object, ...]:
        # The parts are built again: a configuration gives the same bytes each time.
        return (build, (self.config,))

    def __repr__(self) -> str:
        return f"Parts({', '.join(self.names)})"

    def _repr_html_(self) -> str:
        width, height, frames = PICTURE
        picture = base64.b64encode(self._native.turning(width, height, frames)).decode()
        rows = "".join(
            f"<tr><td>{escape(part.name)}</td><td>{part.volume_mm3:.1f}</td><td>{len(part.triangles)}</td></tr>"
            for part in self
        )
        head = "<tr><th>part</th><th>volume, mm³</th><th>triangles</th></tr>"
        name = escape(self.config.switch.name)
        return (
            f'<div style="display:flex;gap:2em;align-items:center"><img width="{width}" height="{height}" '
            f'alt="assembly of {name}, turning" src="data:image/png;base64,{picture}">'
            f"<table><thead>{head}</thead><tbody>{rows}</tbody></table></div>"
        )


def build(config: ConfigLike) -> Parts:
    """Build, mesh and examine every part of a switch.

    Parameters
    ----------
    config : Config or source of one
        The switch; also the name of a template, a file, or a mapping of values.

    Raises
    ------
    PinswitchError
        If the configuration breaks a rule; ``error.changes`` are values that satisfy it.

    Examples
    --------
    >>> parts = build(Config("three-double"))
    >>> parts["shell"].vertices.shape[1]
    3
    """
    native = config_of(config)._native.copy()
    return Parts(_pinswitch.build(native), Config._of(native))


def write_files(
    folder: str | os.PathLike[str], files: dict[str, bytes], *, overwrite: bool = False
) -> list[Path]:
    """Write files into a folder, each whole or not at all, in their order."""
    try:
        return _written(Path(folder), files, overwrite)
    except OSError as error:
        raise cannot_write(folder, error) from error


def _written(place: Path, files: dict[str, bytes], overwrite: bool) -> list[Path]:
    existing = [name for name in files if (place / name).exists()]
    if existing and not overwrite:
        problem = f"{len(existing)} of the files exist, such as {existing[0]}"
        raise PinswitchError(
            problem, code="file-in-the-way", help="give another folder, or overwrite=True", file=os.fspath(place)
        )
    written = []
    for name, content in files.items():
        path = place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".pinswitch-")
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
        written.append(path)
    return written
