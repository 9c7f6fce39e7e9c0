"""Logs of servos in the format of BAM."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from ._errors import PinswitchError
from ._files import read_text
from ._pendulum import GRAVITY_M_S2, Floats

#: Largest angle of a log, rad: a larger one is in degrees.
MAX_ANGLE_RAD = 2 * math.pi
#: Smallest number of entries of a log.
MIN_ENTRIES = 50
#: Largest time between two entries, s: over a longer one, the motion between them is not known.
MAX_GAP_S = 0.1


@dataclass(frozen=True)
class Log:
    """A run of a servo with a pendulum; ``n`` entries.

    Attributes
    ----------
    path : str
        File.
    motor, trajectory : str
        Names of the servo and of the trajectory.
    mass_kg, arm_mass_kg, length_m : float
        Mass at the end of the arm, mass of the arm, length of the arm.
    kp : float
        Gain of the position controller, in the unit of the firmware.
    supply_v : float or None
        Supply voltage; logs of servos that control their current have none.
    time_s : ndarray, shape (n,)
        Times of the entries, increasing.
    position_rad, goal_rad, speed_rad_s : ndarray, shape (n,)
        Position, 0 with the arm down, goal, and speed; the speed is 0 where the log has none.
    is_on : ndarray of bool, shape (n,)
        Whether the torque is enabled.
    """

    path: str
    motor: str
    trajectory: str
    mass_kg: float
    arm_mass_kg: float
    length_m: float
    kp: float
    supply_v: Optional[float]
    time_s: Floats
    position_rad: Floats
    goal_rad: Floats
    speed_rad_s: Floats
    is_on: NDArray[np.bool_]

    @property
    def gravity_nm(self) -> float:
        """Torque of the weight at 90 degrees, N m."""
        return (self.mass_kg + self.arm_mass_kg / 2) * GRAVITY_M_S2 * self.length_m

    @property
    def inertia_kg_m2(self) -> float:
        """Moment of inertia of the pendulum, kg m2; the arm is a uniform rod."""
        return (self.mass_kg + self.arm_mass_kg / 3) * self.length_m**2


class _Reader:
    """Takes values of a file by key, and refuses those that cannot be used."""

    def __init__(self, path: str) -> None:
        self.path = path

    def error(self, problem: str, code: str, help: str, field: str, value: object = None) -> PinswitchError:
        text = None if value is None else str(value)
        return PinswitchError(problem, code=code, help=help, file=self.path, field=field, value=text)

    def number(self, table: dict[str, Any], key: str, low: float, high: float, unit: str, place: str = "") -> float:
        field = f"{place}{key}"
        if key not in table:
            help = f"add {key} in {unit}, as the recorders of BAM write it"
            raise self.error(f"{field} is missing", "missing-field", help, field)
        value = table[key]
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            problem = f"{field} = {json.dumps(value)[:40]}: expected a number"
            raise self.error(problem, "wrong-type", f"give a number in {unit}", field, value)
        if not low <= value <= high:
            problem = f"{field} = {str(value)[:40]} is outside {low:g} to {high:g} {unit}"
            raise self.error(problem, "out-of-range", f"give a finite number in {unit}", field, value)
        return float(value)

    def text(self, table: dict[str, Any], key: str) -> str:
        if key not in table:
            raise self.error(f"{key} is missing", "missing-field", f'add the name, such as "{key}": "xl330"', key)
        if not isinstance(table[key], str):
            problem = f"{key} = {json.dumps(table[key])[:40]}: expected a text"
            raise self.error(problem, "wrong-type", "write a name in quotes", key, table[key])
        return str(table[key])

    def enabled(self, entry: dict[str, Any], place: str) -> bool:
        field = f"{place}torque_enable"
        if "torque_enable" not in entry:
            raise self.error(f"{field} is missing", "missing-field", "add true or false", field)
        value = entry["torque_enable"]
        if not isinstance(value, bool):
            problem = f"{field} = {json.dumps(value)[:40]}: expected true or false"
            raise self.error(problem, "wrong-type", "write true or false", field, value)
        return value

    def entries(self, table: dict[str, Any]) -> list[dict[str, Any]]:
        entries = table.get("entries")
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            problem = "entries is missing, or not a list of objects"
            raise self.error(problem, "missing-field", "give a log of BAM", "entries")
        if len(entries) < MIN_ENTRIES:
            problem = f"entries has {len(entries)} entries, at least {MIN_ENTRIES} are needed"
            raise self.error(problem, "too-few-samples", "record the whole trajectory", "entries", len(entries))
        return entries


def read(path: str | os.PathLike[str]) -> Log:
    """Read a log of BAM, raw or resampled.

    Parameters
    ----------
    path : path
        A JSON file with ``mass``, ``arm_mass`` or ``arm-mass`` (kg, 0 where absent), ``length`` (m), ``kp``, ``vin``
        (V), ``motor``, ``trajectory`` and ``entries``, each with ``timestamp`` (s), ``position`` and
        ``goal_position`` (rad), ``torque_enable`` and, where the servo reports it, ``speed`` (rad/s). Other keys are
        not used.

    Raises
    ------
    PinswitchError
        If the file cannot be read, is not JSON, or lacks a key; if a value has another type, is not finite or outside
        its range; if the times do not increase, or are more than 0.1 s apart.

    Examples
    --------
    >>> from pinswitch import bam
    >>> log = bam.read("2026-01-15_10h28m10.json")  # doctest: +SKIP
    """
    name = os.fspath(path)
    reader = _Reader(name)
    text = read_text(path)
    try:
        table = json.loads(text)
    except json.JSONDecodeError as error:
        raise PinswitchError(
            f"not JSON, or incomplete: line {error.lineno}, column {error.colno}",
            code="damaged-file",
            help="copy the log again; a recorder that is interrupted leaves an incomplete file",
            file=name,
            line=error.lineno,
            column=error.colno,
            causes=[error.msg],
        ) from error
    except (ValueError, RecursionError) as error:
        raise PinswitchError("not a log of BAM", code="damaged-file", help="give a log of BAM", file=name) from error
    if not isinstance(table, dict):
        raise reader.error("not a log of BAM: expected an object", "other-kind-of-file", "give a log of BAM", "entries")
    arm_key = "arm-mass" if "arm-mass" in table else "arm_mass"
    arm_mass_kg = reader.number(table, arm_key, 0, 100, "kg") if arm_key in table else 0.0
    mass_kg = reader.number(table, "mass", 0, 100, "kg")
    if mass_kg + arm_mass_kg == 0:
        raise reader.error("mass = 0: nothing loads the servo", "out-of-range", "give a mass in kg", "mass", 0)
    rows: list[tuple[float, float, float, float]] = []
    enabled: list[bool] = []
    for i, entry in enumerate(reader.entries(table)):
        place = f"entries[{i}]."
        time_s = reader.number(entry, "timestamp", 0, 1e6, "s", place)
        position = reader.number(entry, "position", -MAX_ANGLE_RAD, MAX_ANGLE_RAD, "rad", place)
        goal = reader.number(entry, "goal_position", -MAX_ANGLE_RAD, MAX_ANGLE_RAD, "rad", place)
        speed = reader.number(entry, "speed", -1e3, 1e3, "rad/s", place) if "speed" in entry else 0.0
        if rows and not rows[-1][0] < time_s <= rows[-1][0] + MAX_GAP_S:
            problem = f"{place}timestamp = {time_s:g} follows {rows[-1][0]:g} s: expected 0 to {MAX_GAP_S:g} s more"
            help = "sort the entries by time and remove duplicates; record a log with gaps again"
            raise reader.error(problem, "impossible-clock", help, f"{place}timestamp", time_s)
        rows.append((time_s, position, goal, speed))
        enabled.append(reader.enabled(entry, place))
    times, positions, goals, speeds = np.array(rows, dtype=np.float64).T
    return Log(
        path=name,
        motor=reader.text(table, "motor"),
        trajectory=reader.text(table, "trajectory"),
        mass_kg=mass_kg,
        arm_mass_kg=arm_mass_kg,
        length_m=reader.number(table, "length", 1e-3, 10, "m"),
        kp=reader.number(table, "kp", 1e-6, 1e6, "units of the firmware"),
        supply_v=reader.number(table, "vin", 0.1, 1e3, "V") if "vin" in table else None,
        time_s=times,
        position_rad=positions,
        goal_rad=goals,
        speed_rad_s=speeds,
        is_on=np.array(enabled, dtype=np.bool_),
    )
