"""Writes python/pinswitch/_sections.py: one typed class for each table of a configuration.

Run it after a parameter was added: ``python cad/python/tools/sections.py``. A test compares the file.
"""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

from pinswitch import _pinswitch

FILE = Path(__file__).parents[1] / "python" / "pinswitch" / "_sections.py"
HEAD = '''"""Tables of a configuration; written by tools/sections.py from the parameters of the library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _pinswitch
from ._read_only_list import read_only


class Section:
    """One table of a configuration."""

    _table = ""
    _keys: tuple[str, ...] = ()
    _native: _pinswitch.Configuration

    def __init__(self, native: _pinswitch.Configuration) -> None:
        object.__setattr__(self, "_native", native)

    # A type checker knows the parameters below, and no others.
    if not TYPE_CHECKING:

        def __getattr__(self, key: str) -> Any:
            if key.startswith("_"):
                raise AttributeError(key)
            if key not in self._keys:
                raise AttributeError(f"[{self._table}] has no {key!r}; its parameters are {', '.join(self._keys)}")
            return read_only(self._native.get(f"{self._table}.{key}"))

        def __setattr__(self, key: str, value: object) -> None:
            self._native.set(f"{self._table}.{key}", value)

    def __dir__(self) -> list[str]:
        return list(self._keys)

    def __repr__(self) -> str:
        values = ", ".join(f"{key}={self._native.get(f'{self._table}.{key}')!r}" for key in self._keys)
        return f"{type(self).__name__}({values})"
'''


def kind(value: object) -> str:
    """Return the annotation of a value."""
    if isinstance(value, list):
        return "list[int]"
    return type(value).__name__


def class_of(table: str, entries: list[dict[str, Any]]) -> str:
    """Return the class of a table."""
    name = "".join(word.capitalize() for word in table.split("_"))
    lines = [f"class {name}(Section):", f'    """Table ``[{table}]``.', "", "    Attributes", "    ----------"]
    for entry in entries:
        lines.append(f"    {entry['key']} : {kind(entry['default'])}")
        unit = f" {entry['unit']}" if entry["unit"] else ""
        reason = entry["reason"]
        about = f"{reason[0].upper()}{reason[1:].rstrip('.')}. Range: {entry['range']}{unit}; default {entry['default']} ({entry['origin']})."
        about = about.replace("\\", "\\\\")
        lines += textwrap.wrap(about, 112, initial_indent=" " * 8, subsequent_indent=" " * 8, break_on_hyphens=False)
    keys = ", ".join(f'"{entry["key"]}"' for entry in entries) + ","
    lines += ['    """', "", f'    _table = "{table}"', "    _keys = ("]
    lines += textwrap.wrap(keys, 104, initial_indent=" " * 8, subsequent_indent=" " * 8)
    lines += ["    )", *(f"    {entry['key']}: {kind(entry['default'])}" for entry in entries)]
    return "\n".join(lines)


def text() -> str:
    """Return the text of the file."""
    tables: dict[str, list[dict[str, Any]]] = {}
    for entry in _pinswitch.parameters():
        tables.setdefault(entry["table"], []).append(entry)
    classes = [class_of(table, entries) for table, entries in tables.items()]
    names = {table: "".join(word.capitalize() for word in table.split("_")) for table in tables}
    sections = "\n".join(["class Sections:", '    """The tables of a configuration."""', ""]
                         + [f"    {table}: {name}" for table, name in names.items()])
    listing = "\n".join(["SECTIONS: dict[str, type[Section]] = {"]
                        + [f'    "{table}": {name},' for table, name in names.items()] + ["}"])
    return "\n\n\n".join([HEAD.rstrip(), *classes, sections, listing]) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
