"""A host for MuJoCo: adds the friction of a switch to a simulation.

MuJoCo has no friction of a tendon that depends on tension and direction. Here, the tendon of the model carries the
tension ``T`` of the motor, and the host adds the friction ``f`` of the switch, so that the load side has ``F = T - f``.
``f`` is bounded by the tensions of the switch: ``F`` cannot fall below the load that ``T`` lifts, nor exceed the load
that ``T`` holds,

    F_c(T) <= F <= F_e(T),   T_c(F_c) = T,   T_e(F_e) = T.

Between the bounds the tendon sticks, as an elastic bristle of stretch ``z``, stiffness ``sigma`` and damping ``c``; at a
bound it slides, and the stretch stays at the bound. This is elastic, perfectly plastic friction: the rate-independent
case of Dupont, Hayward, Armstrong & Altpeter, *Single state elastoplastic friction models*, IEEE Trans. Autom. Control
47(5), 2002.

Each step solves ``f`` implicitly, with the velocity ``s`` along the tendon at the end of the step:

    s = s_free - dt w f,   f = clip(sigma (z + dt s) + c s, T - F_e, T - F_c),   w = J M^-1 J^T.

The friction then opposes the slip of the step itself: it dissipates energy or stores it in the bristle, and never
returns more than is stored. The method is stable for any stiffness and step.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import PinswitchError
from ._checks import wrong_type
from ._files import read_bytes, read_text
from .curve import Curve

Floats = NDArray[np.float64]

#: Stiffness of a tendon before it slides, N/m: 0.5 mm at 10 N.
STIFFNESS_N_M = 20_000.0
#: Damping of the bristle as a share of the critical damping.
DAMPING_RATIO = 0.7
#: Sweeps over the switches of a model, whose frictions depend on each other.
SWEEPS = 30
#: Sweeps end when no friction changes by more than this, N.
TOLERANCE_N = 1e-9


#: Columns of a table.
COLUMNS = ("wrap_rad", "load_n", "eccentric_n", "concentric_n")


class Surface:
    """Tensions of a switch over load and wrap angle.

    Attributes
    ----------
    wrap_rad : ndarray, shape (k,)
        Wrap angles, ascending, rad.
    load_n : ndarray, shape (n,)
        Loads, ascending, N.
    eccentric_n, concentric_n : ndarray, shape (k, n)
        Tension while the load is released, and while it is pulled, N.
    """

    def __init__(
        self, wrap_rad: ArrayLike, load_n: ArrayLike, eccentric_n: ArrayLike, concentric_n: ArrayLike
    ) -> None:
        self.wrap_rad: Floats = np.atleast_1d(np.asarray(wrap_rad, dtype=np.float64))
        self.load_n: Floats = np.atleast_1d(np.asarray(load_n, dtype=np.float64))
        for name, axis in (("wrap_rad", self.wrap_rad), ("load_n", self.load_n)):
            is_ascending = axis.ndim == 1 and axis.size and np.all(axis > 0) and np.all(np.diff(axis) > 0)
            if not (is_ascending and np.isfinite(axis[-1])):
                problem = f"{name} is not a list of positive, finite, ascending numbers"
                raise PinswitchError(problem, code="out-of-range", help="sort it, and remove the others", field=name)
        self.eccentric_n: Floats = np.atleast_2d(np.asarray(eccentric_n, dtype=np.float64))
        self.concentric_n: Floats = np.atleast_2d(np.asarray(concentric_n, dtype=np.float64))
        shape = (len(self.wrap_rad), len(self.load_n))
        for name in ("eccentric_n", "concentric_n"):
            table = getattr(self, name)
            if table.shape != shape or not np.all(np.isfinite(table)) or not np.all(np.diff(table, axis=1) > 0):
                problem = f"{name} does not grow with the load, or does not have the shape {shape}"
                raise PinswitchError(
                    problem,
                    code="tension-not-increasing",
                    help="give ascending tensions for each wrap angle",
                    field=name,
                )
        if not (np.all(self.eccentric_n <= self.load_n) and np.all(self.concentric_n >= self.load_n)):
            raise PinswitchError(
                "a tension is on the wrong side of its load",
                code="tension-not-increasing",
                help="eccentric <= load <= concentric",
            )

    @classmethod
    def of_curve(cls, curve: Curve, wrap_rad: float = 1.0) -> Surface:
        """Return the surface of a curve; with one wrap angle it applies to every wrap."""
        if not isinstance(curve, Curve):
            raise wrong_type("curve", curve, "a curve, as predict returns it")
        return cls(wrap_rad, curve.load_n, curve.eccentric_n, curve.concentric_n)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Surface:
        """Read a ``switch.json`` of ``pinswitch export``."""
        text = read_text(path)
        try:
            table = json.loads(text)
            if table["schema"] != "pinswitch.surface/1":
                raise KeyError("schema")
            columns = [np.asarray(table[name], dtype=np.float64) for name in COLUMNS]
        except (KeyError, TypeError, ValueError) as error:
            help = "give a switch.json of `pinswitch export`"
            raise PinswitchError(
                "not the table of a switch", code="other-kind-of-file", help=help, file=os.fspath(path)
            ) from error
        return cls(*columns)

    def bounds_n(self, tension_n: float, wrap_rad: Optional[float] = None) -> tuple[float, float]:
        """Return the bounds of the friction ``T - F`` at a tension of the motor, N.

        Parameters
        ----------
        tension_n : float
            Tension of the motor; a slack tendon has no friction.
        wrap_rad : float, optional
            Wrap angle. Friction is interpolated between angles, constant beyond the largest, and falls to zero at zero.

        Returns
        -------
        tuple of float
            Lower (the load moves away from the motor, at most 0) and upper bound (towards the motor, at least 0).
        """
        if tension_n <= 0:
            return 0.0, 0.0
        lower = tension_n - self._load_of(self.eccentric_n, tension_n, wrap_rad)
        upper = tension_n - self._load_of(self.concentric_n, tension_n, wrap_rad)
        return min(lower, 0.0), max(upper, 0.0)

    def _load_of(self, table: Floats, tension_n: float, wrap_rad: Optional[float]) -> float:
        """Return the load at which the tendon slides."""
        if len(table) == 1:
            return self._inverse(table[0], tension_n)
        wrap = self.wrap_rad[-1] if wrap_rad is None else wrap_rad
        if wrap <= self.wrap_rad[0]:
            share = max(wrap, 0.0) / self.wrap_rad[0]
            return float(tension_n + share * (self._inverse(table[0], tension_n) - tension_n))
        i = int(np.searchsorted(self.wrap_rad, wrap))
        if i >= len(table):
            return self._inverse(table[-1], tension_n)
        share = (wrap - self.wrap_rad[i - 1]) / (self.wrap_rad[i] - self.wrap_rad[i - 1])
        low, high = self._inverse(table[i - 1], tension_n), self._inverse(table[i], tension_n)
        return float((1 - share) * low + share * high)

    def _inverse(self, tensions: Floats, tension_n: float) -> float:
        """Return the load at a tension; beyond the table their ratio is constant."""
        for end in (0, -1):
            if (tension_n < tensions[end]) if end == 0 else (tension_n > tensions[end]):
                return float(tension_n * self.load_n[end] / tensions[end])
        return float(np.interp(tension_n, tensions, self.load_n))


@dataclass
class Switch:
    """A switch on a tendon of a model, with its state.

    Attributes
    ----------
    tendon : str
        Name of the tendon, fixed or spatial; it gets shorter as the motor pulls.
    surface : Surface
        Tensions of the switch.
    wrap_start_rad, wrap_slope_rad_m : float
        Wrap angle ``start - slope * length`` of the tendon; a slope of zero is a constant wrap.
    stiffness_n_m : float
        Stiffness of the bristle, N/m.
    damping_ratio : float
        Damping of the bristle as a share of the critical damping, with the mass that the tendon moves.
    tension_n, friction_n : float
        Tension of the motor and friction of the last step, N.
    stretch_m : float
        Stretch of the bristle at the end of the last step, m.
    slip_m : float
        Slip of the last step, m, positive towards the motor; 0 while the tendon sticks.
    dissipated_j : float
        Energy that slip and damping have dissipated, J.
    """

    tendon: str
    surface: Surface
    wrap_start_rad: Optional[float] = None
    wrap_slope_rad_m: float = 0.0
    stiffness_n_m: float = STIFFNESS_N_M
    damping_ratio: float = DAMPING_RATIO
    tension_n: float = 0.0
    friction_n: float = 0.0
    stretch_m: float = 0.0
    slip_m: float = 0.0
    dissipated_j: float = 0.0
    _length_m: Optional[float] = field(default=None, repr=False)
    _start_m: float = field(default=0.0, repr=False)

    @property
    def load_n(self) -> float:
        """Tension on the side of the load, N."""
        return self.tension_n - self.friction_n

    @property
    def stored_j(self) -> float:
        """Energy of the stretched bristle, J."""
        return 0.5 * self.stiffness_n_m * self.stretch_m**2

    def reset(self) -> None:
        """Forget the state, as after a reset of the simulation."""
        self.tension_n = self.friction_n = self.stretch_m = self.slip_m = self.dissipated_j = self._start_m = 0.0
        self._length_m = None

    def wrap_rad(self, length_m: float) -> Optional[float]:
        """Return the wrap angle at a length of the tendon."""
        if self.wrap_start_rad is None:
            return None
        return self.wrap_start_rad - self.wrap_slope_rad_m * length_m


class Host:
    """Steps a simulation with the friction of its switches.

    Call :meth:`step` in place of ``mujoco.mj_step``. The host adds to ``data.qfrc_applied``, which may contain forces of
    the caller. It evaluates the model once more in each step, for the motion without friction.

    The tension of a tendon comes from its actuators and its spring. The force of a limit of its length is not part of it:
    a tendon that only a limit holds has no friction.

    Parameters
    ----------
    model : mujoco.MjModel
        The model.
    switches : iterable of Switch
        Switches, each on a tendon of its own.

    Raises
    ------
    PinswitchError
        If a tendon does not exist, or a stiffness is not positive.

    Examples
    --------
    >>> import mujoco  # doctest: +SKIP
    >>> host = Host.load("out/finger/finger.xml")  # doctest: +SKIP
    >>> data = mujoco.MjData(host.model)  # doctest: +SKIP
    >>> data.ctrl[0] = 5.0  # doctest: +SKIP
    >>> host.step(data)  # doctest: +SKIP
    """

    def __init__(self, model: Any, switches: Iterable[Switch]) -> None:
        import mujoco

        self.model = model
        self.switches = list(switches)
        self._mujoco: Any = mujoco
        self._ids: list[int] = []
        for switch in self.switches:
            if not isinstance(switch.surface, Surface):
                raise wrong_type("surface", switch.surface, "a Surface: Surface.of_curve makes one of a curve")
            number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, switch.tendon)
            if number < 0:
                raise PinswitchError(
                    "the model has no tendon of this name", code="unknown-name", field="tendon", value=switch.tendon
                )
            if not 0 < switch.stiffness_n_m < math.inf:
                problem = f"stiffness_n_m = {switch.stiffness_n_m} is not a positive number"
                raise PinswitchError(
                    problem, code="out-of-range", help="give a stiffness in N/m", field="stiffness_n_m"
                )
            if not 0 <= switch.damping_ratio < math.inf:
                problem = f"damping_ratio = {switch.damping_ratio} is not a number from 0"
                help = "give a share of the critical damping: less than 0 would create energy"
                raise PinswitchError(problem, code="out-of-range", help=help, field="damping_ratio")
            if number in self._ids:
                problem = "two switches are on this tendon"
                help = "give each switch a tendon of its own; wraps in series are one surface"
                raise PinswitchError(problem, code="duplicate-entry", help=help, field="tendon", value=switch.tendon)
            self._ids.append(number)
        is_tendon = model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON
        self._actuators = [np.flatnonzero(is_tendon & (model.actuator_trnid[:, 0] == id)) for id in self._ids]

    @classmethod
    def load(cls, path: str | os.PathLike[str], **options: Any) -> Host:
        """Read an MJCF of ``pinswitch export``; ``options`` are attributes of every :class:`Switch`.

        The model names its tables: a ``<text name="pinswitch.TENDON">`` with the file, and a
        ``<numeric name="pinswitch.TENDON.wrap">`` with start (rad) and slope (rad/m) of the wrap angle.
        """
        import mujoco

        read_bytes(path)
        try:
            model = mujoco.MjModel.from_xml_path(os.fspath(path))
        except ValueError as error:
            raise PinswitchError(
                "not a model of MuJoCo", code="damaged-file", file=os.fspath(path), causes=[str(error)]
            ) from error
        switches = []
        for i in range(model.ntext):
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, i) or ""
            if not name.startswith("pinswitch."):
                continue
            tendon = name[len("pinswitch.") :]
            wrap = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, f"{name}.wrap")
            if wrap < 0:
                raise PinswitchError(
                    f"the model has no <numeric name={name}.wrap>", code="missing-field", file=os.fspath(path)
                )
            start, slope = model.numeric_data[model.numeric_adr[wrap] :][:2]
            at = model.text_adr[i]
            text = bytes(bytearray(model.text_data[at : at + model.text_size[i]])).decode()
            file = Path(path).parent / text.rstrip("\0")
            switches.append(Switch(tendon, Surface.load(file), float(start), float(slope), **options))
        if not switches:
            raise PinswitchError(
                "the model names no switch",
                code="other-kind-of-file",
                help="use a model of `pinswitch export`",
                file=str(path),
            )
        return cls(model, switches)

    def __getitem__(self, tendon: str) -> Switch:
        for switch in self.switches:
            if switch.tendon == tendon:
                return switch
        help = f"its tendons are {', '.join(switch.tendon for switch in self.switches)}"
        problem = "the host has no switch on this tendon"
        raise PinswitchError(problem, code="unknown-name", help=help, field="tendon", value=str(tendon))

    def reset(self) -> None:
        """Forget the state of every switch."""
        for switch in self.switches:
            switch.reset()

    def tension_n(self, data: Any, number: int) -> float:
        """Return the tension of the motor on the tendon of a switch, N: actuators and passive springs.

        ``data`` contains forces of the current state, as after ``mj_forward``.
        """
        id, actuators = self._ids[number], self._actuators[number]
        pull = float(-(self.model.actuator_gear[actuators, 0] * data.actuator_force[actuators]).sum())
        low, high = self.model.tendon_lengthspring[id]
        stretch = max(data.ten_length[id] - high, 0.0) + min(data.ten_length[id] - low, 0.0)
        # Newer versions have polynomial stiffness: the first coefficient is the linear one.
        stiffness = float(np.ravel(self.model.tendon_stiffness[id])[0])
        return float(pull + stiffness * stretch)

    def step(self, data: Any) -> None:
        """Advance the simulation by one step with the friction of every switch."""
        mujoco, model = self._mujoco, self.model
        own = data.qfrc_applied.copy()
        mujoco.mj_forward(model, data)
        step_s = model.opt.timestep
        rows = self._jacobian(data)
        # Slip towards the motor shortens the tendon.
        free = -rows @ (data.qvel + step_s * data.qacc)
        inverse = np.zeros_like(rows)
        mujoco.mj_solveM(model, data, inverse, rows)
        mobility = rows @ inverse.T
        frictions = self._frictions(data, free, mobility, step_s)
        # Friction lowers the tension of the load side: it acts along the length of the tendon.
        data.qfrc_applied[:] = own + rows.T @ frictions
        mujoco.mj_step(model, data)
        data.qfrc_applied[:] = own

    def _jacobian(self, data: Any) -> Floats:
        """Return the derivatives of the lengths of the tendons, shape (switches, nv)."""
        model = self.model
        rows = np.zeros((len(self._ids), model.nv))
        dense = np.asarray(data.ten_J)
        for row, id in zip(rows, self._ids):
            if dense.ndim == 2:
                row[:] = dense[id]
                continue
            if hasattr(model, "ten_J_rownnz"):
                count, start, columns = model.ten_J_rownnz[id], model.ten_J_rowadr[id], model.ten_J_colind
            else:
                count, start, columns = data.ten_J_rownnz[id], data.ten_J_rowadr[id], data.ten_J_colind
            indices = np.ravel(columns)[start : start + count]
            row[indices] = dense[start : start + count]
        return rows

    def _frictions(self, data: Any, free: Floats, mobility: Floats, step_s: float) -> Floats:
        """Solve the implicit step of all bristles by projected Gauss-Seidel sweeps."""
        count = len(self.switches)
        bounds = []
        for number, switch in enumerate(self.switches):
            length = float(data.ten_length[self._ids[number]])
            if switch._length_m is not None:
                # The motion of the tendon without its slip stretches the bristle.
                switch._start_m += switch._length_m - length - switch.slip_m
            switch._length_m = length
            switch.tension_n = self.tension_n(data, number)
            bounds.append(switch.surface.bounds_n(switch.tension_n, switch.wrap_rad(length)))
        frictions = np.array([switch.friction_n for switch in self.switches])
        ends = np.zeros(count)
        speeds = np.zeros(count)
        dampings = [
            2 * switch.damping_ratio * np.sqrt(switch.stiffness_n_m / max(mobility[i, i], 1e-12))
            for i, switch in enumerate(self.switches)
        ]
        for _ in range(SWEEPS):
            before = frictions.copy()
            for i, switch in enumerate(self.switches):
                own = step_s * mobility[i, i]
                speed = free[i] - step_s * (mobility[i] @ frictions) + own * frictions[i]
                # The derivative of the stuck friction by the velocity.
                slope = switch.stiffness_n_m * step_s + dampings[i]
                stuck = (switch.stiffness_n_m * switch._start_m + slope * speed) / (1 + slope * own)
                frictions[i] = min(max(stuck, bounds[i][0]), bounds[i][1])
                speeds[i] = speed - own * frictions[i]
            if np.max(np.abs(frictions - before), initial=0.0) <= TOLERANCE_N:
                break
        for i, switch in enumerate(self.switches):
            ends[i] = switch._start_m + step_s * speeds[i]
            low, high = (bound / switch.stiffness_n_m for bound in bounds[i])
            switch.friction_n = float(frictions[i])
            switch.stretch_m = float(min(max(ends[i], low), high))
            switch.slip_m = float(ends[i] - switch.stretch_m)
            is_stuck = bounds[i][0] < frictions[i] < bounds[i][1]
            damped = dampings[i] * speeds[i] ** 2 * step_s if is_stuck else 0.0
            switch.dissipated_j += abs(switch.friction_n * switch.slip_m) + float(damped)
        return frictions
