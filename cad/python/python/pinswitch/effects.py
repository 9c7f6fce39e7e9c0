"""User-defined effects, written as Python functions.

A function of an effect is called once with symbols in place of numbers, and its result becomes a formula of
``model/doc/own-effects.md``. The library evaluates the formula for all rows, so that a fit runs at its usual speed and
a saved model contains the effect.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, Optional, Union

import numpy as np

from . import _pinswitch
from ._checks import wrong_type
from ._errors import PinswitchError
from ._files import read_text

#: Variables of a row, as attributes of the first argument of an effect.
VARIABLES = (
    "load_n", "direction", "repetition", "position_mm", "stroke", "speed_pct", "mean_speed_pct", "dwell_s", "time_s",
    "time", "travel", "descending", "pin_count", "turn_per_pin_rad", "turn_unevenness", "is_silicone", "is_device",
    "previous_load_n", "repetitions_so_far", "session", "mount", "tension_n",
)  # fmt: skip

Operand = Union["Expression", float, int, bool]

#: numpy functions that have a counterpart in formulas.
UFUNCS: dict[Any, str] = {
    np.add: "+", np.subtract: "-", np.multiply: "*", np.divide: "/", np.power: "^", np.float_power: "^",
    np.less: "<", np.less_equal: "<=", np.greater: ">", np.greater_equal: ">=", np.equal: "==", np.not_equal: "!=",
    np.exp: "exp", np.log: "ln", np.sqrt: "sqrt", np.abs: "abs", np.fabs: "abs", np.sin: "sin", np.cos: "cos",
    np.tanh: "tanh", np.rint: "round", np.floor: "floor", np.ceil: "ceil", np.minimum: "min", np.maximum: "max",
    np.fmin: "min", np.fmax: "max",
}  # fmt: skip
OPERATORS = frozenset("+ - * / ^ < <= > >= == !=".split())


class Expression:
    """A formula under construction. It supports arithmetic, comparisons, and the functions of numpy in formulas."""

    def __init__(self, text: str) -> None:
        self.text = text

    def _joined(self, operator: str, left: Operand, right: Operand) -> Expression:
        return Expression(f"({_text(left)} {operator} {_text(right)})")

    def __add__(self, other: Operand) -> Expression:
        return self._joined("+", self, other)

    def __radd__(self, other: Operand) -> Expression:
        return self._joined("+", other, self)

    def __sub__(self, other: Operand) -> Expression:
        return self._joined("-", self, other)

    def __rsub__(self, other: Operand) -> Expression:
        return self._joined("-", other, self)

    def __mul__(self, other: Operand) -> Expression:
        return self._joined("*", self, other)

    def __rmul__(self, other: Operand) -> Expression:
        return self._joined("*", other, self)

    def __truediv__(self, other: Operand) -> Expression:
        return self._joined("/", self, other)

    def __rtruediv__(self, other: Operand) -> Expression:
        return self._joined("/", other, self)

    def __pow__(self, other: Operand) -> Expression:
        return self._joined("^", self, other)

    def __rpow__(self, other: Operand) -> Expression:
        return self._joined("^", other, self)

    def __neg__(self) -> Expression:
        return Expression(f"(-{self.text})")

    def __pos__(self) -> Expression:
        return self

    def __abs__(self) -> Expression:
        return Expression(f"abs({self.text})")

    def __lt__(self, other: Operand) -> Expression:
        return self._joined("<", self, other)

    def __le__(self, other: Operand) -> Expression:
        return self._joined("<=", self, other)

    def __gt__(self, other: Operand) -> Expression:
        return self._joined(">", self, other)

    def __ge__(self, other: Operand) -> Expression:
        return self._joined(">=", self, other)

    def __eq__(self, other: object) -> Expression:  # type: ignore[override]
        return self._joined("==", self, other)  # type: ignore[arg-type]

    def __ne__(self, other: object) -> Expression:  # type: ignore[override]
        return self._joined("!=", self, other)  # type: ignore[arg-type]

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        raise PinswitchError(
            "the function of an effect decides with if, and, or, min or max on a value of a row",
            code="formula-syntax",
            help="write a comparison as a factor, such as k * (row.time > 0.5), or use np.minimum and np.maximum",
        )

    def __float__(self) -> float:
        raise PinswitchError(
            "the function of an effect converts a value of a row to a number, as functions of math do",
            code="formula-syntax",
            help="use the functions of numpy, such as np.exp",
        )

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **options: Any) -> Expression:
        name = UFUNCS.get(function)
        if name is None or method != "__call__" or options:
            known = ", ".join(sorted({f.__name__ for f, n in UFUNCS.items() if n not in OPERATORS}))
            problem = f"formulas have no counterpart of numpy.{function.__name__}"
            raise PinswitchError(problem, code="formula-syntax", help=f"use arithmetic, comparisons and {known}")
        if name in OPERATORS:
            return self._joined(name, *inputs)
        return Expression(f"{name}({', '.join(_text(operand) for operand in inputs)})")

    def __repr__(self) -> str:
        return self.text


def _text(operand: Operand) -> str:
    """Return an operand as text of a formula, in which numbers are not negative."""
    if isinstance(operand, Expression):
        return operand.text
    try:
        value = float(operand)
    except (TypeError, ValueError) as error:
        help = "return arithmetic of the row and its constants, and use single numbers"
        problem = f"the function of an effect uses {operand!r}, which is not a number"
        raise PinswitchError(problem, code="formula-syntax", help=help) from error
    if not np.isfinite(value):
        raise PinswitchError(
            f"the function of an effect uses {value}", code="formula-not-finite", help="use finite numbers"
        )
    return repr(value) if value >= 0 else f"(-{-value!r})"


def _without_brackets(text: str) -> str:
    """Return a formula without the brackets around the whole of it."""
    depth = 0
    for i, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth == 0 and i < len(text) - 1:
            return text
    return text[1:-1] if text.startswith("(") else text


class Row:
    """The variables of a row: see :data:`VARIABLES` and ``model/doc/own-effects.md``."""

    def __getattr__(self, name: str) -> Expression:
        if name not in VARIABLES:
            raise AttributeError(f"a row has no variable {name!r}; its variables are {', '.join(VARIABLES)}")
        return Expression(name)


@dataclass(frozen=True)
class Constant:
    """A constant of an effect: a size, or a shape between bounds.

    Attributes
    ----------
    start : float
        Value at which a fit starts.
    unit : str
        ``"1"``, ``"N"``, ``"%"``, ``"s"``, ``"mm"``, ``"rad"``, or powers, products and quotients of these.
    low, high : float or None
        Bounds of a shape; None for a size, with which the effect vanishes at zero.
    """

    start: float
    unit: str = "1"
    low: Optional[float] = None
    high: Optional[float] = None

    def __post_init__(self) -> None:
        for name in ("start", "low", "high"):
            value = getattr(self, name)
            if not (isinstance(value, Real) or (name != "start" and value is None)):
                raise wrong_type(name, value, "a number")

    def to_toml(self) -> str:
        """Return the constant as an inline table."""
        bounds = "size = true" if self.low is None else f"low = {self.low!r}, high = {self.high!r}"
        return f"{{ {bounds}, start = {float(self.start)!r}, unit = {_quoted(self.unit)} }}"


def size(start: float, unit: str = "1") -> Constant:
    """Return the size of an effect: unbounded, and zero without the effect."""
    return Constant(start, unit)


def shape(start: float, low: float, high: float, unit: str = "1") -> Constant:
    """Return a shape of an effect, between bounds."""
    return Constant(start, unit, float(low), float(high))


@dataclass(frozen=True)
class Effect:
    """A user-defined effect; :func:`effect` makes one."""

    id: str
    side: str
    covariate: str
    acts_on: str
    combine: str
    formula: str
    constants: dict[str, Constant]
    one_sided: bool = False
    confused_with: tuple[str, ...] = ()
    experiment: str = ""
    drawn_from: Optional[tuple[str, ...]] = ()

    def to_toml(self) -> str:
        """Return the block of a file of effects."""
        lines = ["[[effect]]"]
        for key in ("id", "side", "covariate", "acts_on", "combine", "formula"):
            lines.append(f"{key} = {_quoted(getattr(self, key))}")
        lines.append(f"one_sided = {'true' if self.one_sided else 'false'}")
        if self.confused_with:
            lines.append(f"confused_with = [{', '.join(map(_quoted, self.confused_with))}]")
        if self.experiment:
            lines.append(f"experiment = {_quoted(self.experiment)}")
        if self.drawn_from is not None:
            lines.append(f"drawn_from = [{', '.join(map(_quoted, self.drawn_from))}]")
        lines += [f"parameters.{name} = {constant.to_toml()}" for name, constant in self.constants.items()]
        return "\n".join(lines) + "\n"


def effect(
    *,
    side: str,
    covariate: str,
    acts_on: str,
    combine: str,
    id: Optional[str] = None,
    one_sided: bool = False,
    confused_with: Sequence[str] = (),
    experiment: str = "",
    drawn_from: Optional[Sequence[str]] = (),
) -> Callable[[Callable[..., Any]], Effect]:
    """Make an effect of a function ``f(row, constant=size(...), ...)``.

    Parameters
    ----------
    side : str
        ``"switch"`` (part of the curve of a printed part) or ``"rig"``.
    covariate : str
        ``load``, ``direction``, ``repetition``, ``position``, ``speed``, ``dwell``, ``sweep``, ``time`` or
        ``condition``.
    acts_on : str
        ``mu``, ``mu_pins``, ``mu_silicone``, ``wrap``, ``threshold``, ``load``, ``tension`` or ``reading``.
    combine : str
        ``"factor"`` (times 1 + f) or ``"add"`` (plus f, in the unit of ``acts_on``).
    id : str, optional
        Name; without it, that of the function.
    one_sided : bool
        The first size is not negative.
    confused_with : sequence of str
        Ids of effects that may look alike.
    experiment : str
        Experiment that identifies the effect.
    drawn_from : sequence of str or None
        Readings from which the effect was derived; empty for an effect from physics.

    Raises
    ------
    PinswitchError
        If the function branches on a value of a row, if the formula is not valid, if units do not match, or if its
        constants are not identifiable.

    Examples
    --------
    >>> import numpy as np
    >>> @effect(side="rig", covariate="dwell", acts_on="reading", combine="factor")
    ... def cell_creep(row, k=size(0.02)):
    ...     return k * np.log(row.dwell_s / 3)
    >>> cell_creep.formula
    'k * ln((dwell_s / 3.0))'
    """

    def decorate(function: Callable[..., Any]) -> Effect:
        arguments = list(inspect.signature(function).parameters.values())
        constants: dict[str, Constant] = {}
        for argument in arguments[1:]:
            if not isinstance(argument.default, Constant):
                help = f"write {argument.name}=pinswitch.size(start) or =pinswitch.shape(start, low, high)"
                raise PinswitchError(
                    f"argument {argument.name} has no constant as its default", code="invalid-effect", help=help
                )
            constants[argument.name] = argument.default
        result = function(Row(), **{name: Expression(name) for name in constants})
        made = Effect(
            id=id or function.__name__,
            side=side,
            covariate=covariate,
            acts_on=acts_on,
            combine=combine,
            formula=_without_brackets(_text(result)),
            constants=constants,
            one_sided=one_sided,
            confused_with=tuple(confused_with),
            experiment=experiment,
            drawn_from=None if drawn_from is None else tuple(drawn_from),
        )
        _pinswitch.check_effects(effect_texts([made]))
        return made

    return decorate


def effect_file(effects: Sequence[Effect]) -> str:
    """Return the file of effects, for ``pinswitch calibrate --effects``."""
    for one in effects:
        if not isinstance(one, Effect):
            raise wrong_type("effects", one, "a function with @pinswitch.effect")
    return 'schema = "pinswitch.effects/1"\n\n' + "\n".join(one.to_toml() for one in effects)


def effect_texts(effects: Sequence[Any]) -> list[tuple[str, str]]:
    """Return (name, text) of files of effects: effects together in one text, and files as they are."""
    if isinstance(effects, (str, os.PathLike, Effect)):
        effects = [effects]
    own = [one for one in effects if isinstance(one, Effect)]
    texts = [("effects", effect_file(own))] if own else []
    for path in effects:
        if isinstance(path, Effect):
            continue
        if not isinstance(path, (str, os.PathLike)):
            help = "give functions with @pinswitch.effect, or paths of files"
            raise PinswitchError(f"{path!r} is not an effect", code="wrong-type", help=help, field="effects")
        texts.append((os.fspath(path), read_text(path)))
    return texts


def _quoted(text: str) -> str:
    """Return a basic string of TOML."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
