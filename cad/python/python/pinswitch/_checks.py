"""Checks of arguments: what is out of range or of a wrong type is a :class:`PinswitchError` that names the argument."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

from ._errors import PinswitchError

#: Largest seed: integers of TOML are signed.
MAX_SEED = 2**63 - 1
#: Most threads, as on the command line.
MAX_THREADS = 256


def in_range(name: str, value: Any, low: float, high: float, unit: str = "") -> float:
    """Return a number from ``low`` to ``high``."""
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise wrong_type(name, value, "a finite number")
    number = float(value)
    if not low <= number <= high:
        raise _out_of_range(name, number, low, high, unit)
    return number


def whole(name: str, value: Any, low: int, high: int) -> int:
    """Return a whole number from ``low`` to ``high``."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise wrong_type(name, value, "a whole number")
    number = int(value.__index__())
    if not low <= number <= high:
        raise _out_of_range(name, number, low, high, "")
    return number


def wrong_type(name: str, value: object, expected: str) -> PinswitchError:
    """Return the error of an argument that is not what is expected."""
    shown = repr(value)
    shown = shown if len(shown) <= 60 else f"a {type(value).__name__}"
    return PinswitchError(
        f"{name}: {shown} is not {expected}", code="wrong-type", help=f"give {expected}", field=name, value=shown
    )


def _out_of_range(name: str, value: object, low: float, high: float, unit: str) -> PinswitchError:
    bounds = f"{low:g} to {high:g}" if isinstance(low, float) or isinstance(high, float) else f"{low} to {high}"
    help = f"give a number from {bounds} {unit}".rstrip()
    problem = f"{name} = {value} is outside {bounds} {unit}".rstrip()
    return PinswitchError(problem, code="out-of-range", help=help, field=name, value=str(value))
