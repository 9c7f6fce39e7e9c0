"""Configurations."""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any, Union

from . import _pinswitch
from ._errors import PinswitchError
from ._files import read_bytes, write_text
from ._read_only_list import read_only
from ._sections import SECTIONS, Sections


class Config(Sections):
    """The parameters of a switch, grouped in tables: ``config.shell.width_mm = 12``.

    Names end in their unit. A value is checked against its range when it is set; the rules that connect parameters are
    checked by :meth:`check`, and by every function that takes a configuration.

    Parameters
    ----------
    source : str, path or mapping, optional
        A template (see :func:`pinswitch.templates`), a TOML file, an ``assembly.3mf`` of a set, or values as
        ``{"shell": {"width_mm": 12}}`` or ``{"shell.width_mm": 12}``. Without it, the defaults.
    preset : str or path, optional
        A template or file whose values ``source`` overrides, such as ``"printer-fff-0.4"``.
    **values
        Single values, with two underscores for the dot: ``shell__width_mm=12``.

    Raises
    ------
    PinswitchError
        For an unknown template, file or field, and for a value that its field does not accept.

    Examples
    --------
    >>> config = Config("three-double")
    >>> config.layout.pins
    [5, 8, 11]
    >>> config.shell.width_mm = -1
    Traceback (most recent call last):
    ...
    pinswitch.PinswitchError: shell.width_mm = -1: outside 2 to 100 [out-of-range]
      help: give a number from 2 to 100
    """

    _native: _pinswitch.Configuration

    def __init__(
        self,
        source: str | os.PathLike[str] | Mapping[str, Any] | None = None,
        *,
        preset: str | os.PathLike[str] | None = None,
        **values: object,
    ) -> None:
        base = None if preset is None else _read(preset, None)
        if source is None or isinstance(source, Mapping):
            native = _pinswitch.Configuration() if base is None else base
            self._set_native(native)
            for path, value in _flat(source or {}).items():
                native.set(path, value)
        else:
            self._set_native(_read(source, base))
        for name, value in values.items():
            self._native.set(name.replace("__", "."), value)

    def _set_native(self, native: _pinswitch.Configuration) -> None:
        object.__setattr__(self, "_native", native)
        for name, section in SECTIONS.items():
            object.__setattr__(self, name, section(native))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"set a value of a table, such as config.shell.width_mm; {name!r} is not one")

    @classmethod
    def _of(cls, native: _pinswitch.Configuration) -> Config:
        config = cls.__new__(cls)
        config._set_native(native)
        return config

    @classmethod
    def from_toml(cls, text: str, name: str = "configuration") -> Config:
        """Return the configuration of a TOML text; ``name`` is that of the text in errors."""
        return cls._of(_pinswitch.Configuration.read(text, name))

    def __getitem__(self, path: str) -> Any:
        return read_only(self._native.get(path))

    def __setitem__(self, path: str, value: object) -> None:
        self._native.set(path, value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Config) and self._native.equals(other._native)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[object, ...]:
        return (Config.from_toml, (self.to_toml(), self.switch.name))

    def replace(self, values: Mapping[str, Any] | None = None, /, **others: object) -> Config:
        """Return a copy with other values, given as for :class:`Config`."""
        copy = Config._of(self._native.copy())
        for path, value in {**_flat(values or {}), **others}.items():
            copy._native.set(path.replace("__", "."), value)
        return copy

    def check(self) -> list[str]:
        """Check every rule; return warnings.

        Raises
        ------
        PinswitchError
            For the first broken rule. Its ``changes`` are values that satisfy the rule.
        """
        return self._native.check()

    def repaired(self) -> tuple[Config, dict[str, tuple[str, str, str]]]:
        """Return the nearest valid configuration, and each change as ``{field: (old, new, reason)}``."""
        native, changes = self._native.repaired()
        return Config._of(native), {field: (old, new, reason) for field, old, new, reason in changes}

    def to_toml(self) -> str:
        """Return the values that differ from the defaults as TOML."""
        return self._native.to_toml()

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """Return every value, by table and key."""
        tables: dict[str, dict[str, Any]] = {}
        for entry in _pinswitch.parameters():
            path = f"{entry['table']}.{entry['key']}"
            tables.setdefault(entry["table"], {})[entry["key"]] = self._native.get(path)
        return tables

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write TOML to a file."""
        write_text(path, self.to_toml())

    def __repr__(self) -> str:
        changed = ", ".join(f"{path}={value!r}" for path, value in self._changed().items())
        return f"Config({changed})"

    def _changed(self) -> dict[str, Any]:
        entries = ((f"{e['table']}.{e['key']}", e["default"]) for e in _pinswitch.parameters())
        values = ((path, self._native.get(path), default) for path, default in entries)
        return {path: value for path, value, default in values if value != default}

    def _repr_html_(self) -> str:
        described = {f"{e['table']}.{e['key']}": e for e in _pinswitch.parameters()}
        rows = "".join(
            f"<tr><td><code>{escape(path)}</code></td><td>{escape(str(value))}</td>"
            f"<td>{escape(str(described[path]['default']))}</td><td>{escape(described[path]['reason'])}</td></tr>"
            for path, value in self._changed().items()
        )
        head = "<tr><th>parameter</th><th>value</th><th>default</th><th>meaning</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _flat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by ``table.key``."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            flat.update({f"{name}.{key}": item for key, item in value.items()})
        else:
            flat[name] = value
    return flat


def _read(source: str | os.PathLike[str], base: _pinswitch.Configuration | None) -> _pinswitch.Configuration:
    """Read a template or a file."""
    path, name = Path(source), os.fspath(source)
    if path.is_file():
        content = read_bytes(path)
        if content.startswith(b"PK"):
            return _pinswitch.Configuration.from_3mf(content, name)
        try:
            return _pinswitch.Configuration.read(content.decode("utf-8"), name, base)
        except UnicodeDecodeError as error:
            raise PinswitchError(
                "not UTF-8", code="not-utf-8", help="save the file as UTF-8 text", file=name
            ) from error
    text = _pinswitch.template_text(name)
    if text is not None:
        return _pinswitch.Configuration.read(text, name, base)
    near = difflib.get_close_matches(name, _pinswitch.templates(), 1, 0.0)[0]
    help = f"the nearest template is {near!r}; pinswitch.templates() lists all templates"
    raise PinswitchError("no such file or template", code="file-not-found", help=help, file=name)


#: A configuration, or what :class:`Config` makes one from.
ConfigLike = Union[Config, str, "os.PathLike[str]", Mapping[str, Any]]


def config_of(source: ConfigLike) -> Config:
    """Return the configuration of a template's name, a file or a mapping."""
    if isinstance(source, Config):
        return source
    if isinstance(source, (str, os.PathLike, Mapping)):
        return Config(source)
    problem = f"a {type(source).__name__} is not a configuration"
    help = "give a Config, the name of a template, a file, or a mapping of values"
    raise PinswitchError(problem, code="wrong-type", help=help)


def templates() -> list[str]:
    """Return the names of the templates."""
    return _pinswitch.templates()


def parameters() -> list[dict[str, Any]]:
    """Return every parameter: ``table``, ``key``, ``unit``, ``range``, ``origin``, ``reason`` and ``default``.

    ``origin`` is ``"published"`` (printed in the paper), ``"assumed"`` or ``"chosen"``.
    """
    return _pinswitch.parameters()
