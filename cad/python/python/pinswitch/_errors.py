"""The exception of the package."""

from __future__ import annotations

import json


class PinswitchError(ValueError):
    """An input that cannot be used.

    ``str(error)`` is the message of the command line: the location, the problem, its code, and the help.

    Attributes
    ----------
    code : str
        Kind of fault, such as ``grooves-overlap``: `pinswitch explain` prints its page.
    problem : str
        What is wrong.
    help : str or None
        What to do.
    file, line, column : str or None, int or None, int or None
        Where it is in a file, counted from 1.
    field, value : str or None
        The field that has the problem, such as ``segment.grooves``, and its value as text.
    changes : dict of str to str
        Values of fields that would remove the problem.
    causes : list of str
        Errors behind this one.
    """

    def __init__(
        self,
        problem: str,
        *,
        code: str,
        help: str | None = None,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        field: str | None = None,
        value: str | None = None,
        changes: dict[str, str] | None = None,
        causes: list[str] | None = None,
        text: str | None = None,
    ) -> None:
        self.code = code
        self.problem = problem
        self.help = help
        self.file = file
        self.line = line
        self.column = column
        self.field = field
        self.value = value
        self.changes = changes or {}
        self.causes = causes or []
        if text is None:
            located = f"{problem} [{code}]" if file is None else f"{file}: {problem} [{code}]"
            text = located if help is None else f"{located}\n  help: {help}"
        super().__init__(text)

    def __reduce__(self) -> tuple[object, ...]:
        return (_restored, (self.__dict__.copy(), self.args[0]))


# The name under which users import it.
PinswitchError.__module__ = "pinswitch"


def _restored(fields: dict[str, object], text: str) -> PinswitchError:
    error = PinswitchError("", code="", text=text)
    error.__dict__.update(fields)
    return error


def from_json(text: str, rendered: str) -> PinswitchError:
    """Return the exception of a diagnostic in JSON; the native module calls this."""
    fields = json.loads(text)
    location = fields.get("location", {})
    return PinswitchError(
        fields["problem"],
        code=fields["code"],
        help=fields.get("help"),
        file=location.get("file"),
        line=location.get("line"),
        column=location.get("column"),
        field=location.get("field"),
        value=location.get("value"),
        changes={change["field"]: change["value"] for change in fields.get("changes", [])},
        causes=fields.get("causes"),
        text=rendered.removeprefix("error: "),
    )
