"""Files of the user: what cannot be read or written is a :class:`PinswitchError` with its path."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Union

from ._errors import PinswitchError

PathLike = Union[str, "os.PathLike[str]"]


def read_bytes(path: PathLike) -> bytes:
    """Return the content of a file."""
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise PinswitchError(f"cannot read: {error.strerror}", code="cannot-read", file=os.fspath(path)) from error
    except ValueError as error:
        raise PinswitchError(f"cannot read: {error}", code="cannot-read", file=repr(path)) from error


def read_text(path: PathLike) -> str:
    """Return the text of a file in UTF-8, without the mark that some editors put at its begin."""
    try:
        return read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        help = "save the file as UTF-8 text"
        raise PinswitchError("not UTF-8", code="not-utf-8", help=help, file=os.fspath(path)) from error


def write_text(path: PathLike, text: str) -> None:
    """Write a file of text in UTF-8, with its line feeds."""
    try:
        Path(path).write_bytes(text.encode("utf-8"))
    except OSError as error:
        raise cannot_write(path, error) from error


def cannot_write(path: PathLike, error: OSError) -> PinswitchError:
    """Return the error of a file or folder that cannot be written."""
    help = "give a path in a folder that exists and can be written"
    return PinswitchError(f"cannot write: {error.strerror}", code="cannot-write", help=help, file=os.fspath(path))
