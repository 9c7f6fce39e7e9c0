"""Lists of a configuration."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NoReturn


class ReadOnlyList(list[Any]):
    """A list of a configuration: a change of the list would not reach the configuration, and is refused.

    >>> pins = ReadOnlyList([5, 8, 11])
    >>> pins.append(14)
    Traceback (most recent call last):
    ...
    TypeError: assign a new list, such as config.layout.pins = [5, 8, 11]
    >>> pins += [14]
    >>> pins
    [5, 8, 11, 14]
    """

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError(f"assign a new list, such as config.layout.pins = {list(self)!r}")

    append = extend = insert = remove = pop = clear = sort = reverse = _refuse
    __setitem__ = __delitem__ = __imul__ = _refuse

    def __iadd__(self, other: Iterable[Any]) -> list[Any]:  # type: ignore[override,misc]
        # `config.layout.pins += [14]` assigns what this returns.
        return [*self, *other]

    def __reduce_ex__(self, _: object) -> tuple[object, ...]:
        return (list, (list(self),))


def read_only(value: Any) -> Any:
    """Return a value of a configuration; a list is read-only."""
    return ReadOnlyList(value) if isinstance(value, list) else value
