"""Logs of servos in the format of BAM, and the friction of a servo identified from them.

BAM (*Better Actuator Models*) records a servo that moves a pendulum of known mass and length along a trajectory, one
JSON file for each run. :func:`read` reads such a file, as recorded or as ``bam.process`` resampled it. The format is
that of the recorders in https://github.com/Rhoban/bam, commit 1b5a1ce (2026-07-24, Apache-2.0); the model is that of
Duclusaud, Passault, Padois & Ly, *Extended friction models for the physics simulation of servo actuators*, ICRA 2025,
arXiv:2410.08650.

:func:`identify` fits the constants of the motor and of the friction. With the torque ``tm`` of the motor, the torque
``te`` of the weight and the speed ``v``,

    J dv/dt = tm + te + tf,   tm = G (V - kt v),   V = supply * clip(error_gain * kp * (goal - position), +-max_duty),
    |tf| <= base + load |tm - te| + viscous |v| + stribeck exp(-|v| / stribeck_speed).

``G`` is the torque constant over the resistance. The constant ``load`` makes friction depend on the load. In the
notation of BAM, the model is M3 with the Stribeck term of M2 and its exponent ``alpha`` fixed at 1.

A servo that lifts a load slowly pulls with more than the load, and one that lowers or holds it with less:

    lifts: tm (1 - load) = |te| (1 + load) + base,   holds: tm (1 + load) = |te| (1 - load) - base.

The ratio of motor torque and load is that of a tendon over a pulley, ``exp(+-x)`` with ``x = 2 artanh(load)``. The
constant ``load`` therefore corresponds to the friction of a switch, whose exponent ``x`` is coefficient times wrap
angle, and ``base`` to the drag of guides, which is the same at every load.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Optional

import numpy as np

from . import _pendulum
from ._bam_log import Log, read
from ._checks import in_range, whole, wrong_type
from ._errors import PinswitchError
from ._pendulum import BOUNDED, LOAD, LOGARITHMIC, NAMES, Bench, Floats, Solution

#: Longest step of a simulation: that of the readings may be 0.1 s.
LONGEST_STEP_S = 0.1

__all__ = ["SERVOS", "Friction", "Interval", "Log", "Servo", "identify", "read"]

#: Probability from which the dependence on load is reported.
REPORTED = 0.95
#: Load constant of consequence: a third of the smallest that BAM publishes for M3 (0.063, erob80_50).
CONSEQUENCE = 0.02
#: Largest ratio of residuals and noise of an adequate model.
ADEQUATE = 2.0
#: Speed of Stribeck friction, rad/s: middle of the range 0.1 to 3 that BAM allows, on a logarithmic scale.
STRIBECK_RAD_S = 0.5
#: Parts of a step of which each has the torque enabled or disabled.
PARTS = 8
#: Times of a free swing that the fits of the search include, s.
SWINGS_S = (0.3, 1.0)
#: Number of searches, and least step of the search and of the coarse fit, s.
SEARCHES, SEARCH_STEP_S = 2, 0.01
#: Quantile of the normal distribution for a 95 % interval.
QUANTILE = 1.959964


class Servo(NamedTuple):
    """The position controller in the firmware of a servo that controls its voltage.

    Attributes
    ----------
    error_gain : float
        Duty cycle per rad of position error and unit of ``kp``.
    max_duty : float
        Largest duty cycle, 0 to 1.
    """

    error_gain: float
    max_duty: float


#: Servos by the name in a log; the values are those of ``bam/dynamixel/actuator.py``.
SERVOS = {
    "mx64": Servo(0.158, 0.9625),
    "mx106": Servo(0.158, 0.9625),
    "xl320": Servo(0.05048199, 1.0),
    "xl330": Servo(4096 / (2 * math.pi) / (256 * 885), 1.0),
}


class Interval(NamedTuple):
    """An estimate with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Friction:
    """The friction of a servo, with and without the term that depends on the load.

    Attributes
    ----------
    constants, without_load : dict of str to Interval
        Constants of the model with and without the term: ``gain_nm_v`` (torque constant over resistance, N m/V),
        ``kt_v_s`` (V s), ``armature_kg_m2``, ``offset_rad`` (angle from the vertical minus position), ``base_nm``,
        ``viscous_nm_s`` (N m s), ``stribeck_nm``, ``delay_s`` (of the goal) and, in the first, ``load``. Friction is
        not negative.
    probability : float
        Probability that friction depends on the load, from the Schwarz criterion (BIC) with equal prior odds.
    verdict : str
        ``attributed``: the dependence is reported. ``none``: it is not, and a constant ``load`` of consequence is
        excluded. ``inconclusive``: it is not, and the logs do not exclude it.
    rms_rad, rms_without_load_rad : float
        RMS error of the fitted logs.
    held_out_rad, held_out_without_load_rad : float
        RMS error of logs that are left out of the fit in turn; not a number for a single log.
    noise_rad : float
        Standard deviation of the noise of the positions, from second differences of the residuals.
    blocks : int
        Number of blocks of the logs, the sample size of the criterion.
    """

    constants: dict[str, Interval]
    without_load: dict[str, Interval]
    probability: float
    verdict: str
    rms_rad: float
    rms_without_load_rad: float
    held_out_rad: float
    held_out_without_load_rad: float
    noise_rad: float
    blocks: int
    _points: tuple[Floats, Floats]
    _servo: Servo
    _step_s: float
    _stribeck_rad_s: float

    @property
    def adequate(self) -> bool:
        """Whether the residuals are noise; otherwise the model lacks something, whatever the verdict."""
        return min(self.rms_rad, self.rms_without_load_rad) <= ADEQUATE * self.noise_rad

    @property
    def capstan_exponent(self) -> Interval:
        """Exponent ``x`` of the ratio ``exp(x)`` of motor torque and load: friction coefficient times wrap angle."""
        return Interval(*(2 * math.atanh(min(max(share, -0.999), 0.999)) for share in self.constants["load"]))

    def torques_nm(self, load_nm: Floats) -> tuple[Floats, Floats]:
        """Return the torques of the motor that hold and that lift a load at rest, with Stribeck friction, N m.

        The term that depends on the load is included if the verdict is ``attributed``.
        """
        is_load = self.verdict == "attributed"
        constants = self.constants if is_load else self.without_load
        share = constants["load"].value if is_load else 0.0
        base = constants["base_nm"].value + constants["stribeck_nm"].value
        loads = np.asarray(load_nm, dtype=np.float64)
        return (loads * (1 - share) - base) / (1 + share), (loads * (1 + share) + base) / (1 - share)

    def positions_rad(self, log: Log, with_load: bool = True) -> Floats:
        """Return the positions that the model gives at the times of a log, rad, shape (n,)."""
        bench = _bench([log], self._servo, self._step_s, self._stribeck_rad_s)
        point = self._points[0 if with_load else 1]
        grid = log.time_s[0] + self._step_s * np.arange(len(bench.goal_rad))
        return np.interp(log.time_s, grid, _pendulum.simulate(bench, point)[:, 0, 0])

    def __str__(self) -> str:
        load = self.constants["load"]
        interval = f"{load.value:.4f} [{load.low:.4f}, {load.high:.4f}]"
        statement = {
            "attributed": f"attributed: friction depends on the load (probability {self.probability:.3f})",
            "none": f"none: friction does not depend on the load, load is below {load.high:.4f}",
            "inconclusive": "inconclusive: no dependence on the load detected; cannot rule it out",
        }[self.verdict]
        lines = [f"verdict: {statement}", f"load {interval}"]
        chosen = self.constants if self.verdict == "attributed" else self.without_load
        lines += [f"{name} {v.value:.5g} [{v.low:.5g}, {v.high:.5g}]" for name, v in chosen.items() if name != "load"]
        lines.append(
            f"held-out error: {1e3 * self.held_out_without_load_rad:.2f} mrad without the load, "
            f"{1e3 * self.held_out_rad:.2f} mrad with it"
        )
        if not self.adequate:
            residual, noise = 1e3 * self.rms_rad, 1e3 * self.noise_rad
            lines.append(f"lack of fit: residuals of {residual:.2f} mrad, noise of {noise:.2f} mrad")
        return "\n".join(lines)


def identify(
    logs: Sequence[Log],
    servo: Optional[Servo] = None,
    *,
    stribeck_rad_s: float = STRIBECK_RAD_S,
    step_s: float = 0.0025,
    block_s: float = 1.0,
    consequence: float = CONSEQUENCE,
    seed: int = 0,
) -> Friction:
    """Identify the friction of a servo by the output-error method.

    The closed loop of controller, motor, friction and pendulum is simulated for all logs, and the sum of squares of
    measured minus simulated positions is minimized by Levenberg-Marquardt (Ljung, *System identification*, 2nd ed.,
    1999, section 7.5). Positions are not differentiated, so that noise and quantisation do not bias the constants.

    The model with the term that depends on the load is compared with that without it. Its log odds are
    ``(z^2 - ln n) / 2`` with ``z`` the load constant in standard errors and ``n`` the number of
    blocks: the Schwarz criterion (Kass & Raftery, *Bayes factors*, J. Am. Stat. Assoc. 90, 1995) with the smaller of
    Wald statistic and likelihood ratio. The former allows for residuals that are correlated in time, the latter for
    constants that the logs hardly determine. The dependence is reported from a
    probability of 0.95, if it also lowers the held-out error.

    Parameters
    ----------
    logs : sequence of Log
        Runs of one servo, best with several masses and gains, and one in which the torque is disabled.
    servo : Servo, optional
        Controller of the servo; without it, that of the name in the logs (:data:`SERVOS`).
    stribeck_rad_s : float
        Speed at which Stribeck friction has fallen to 1/e; positions determine it poorly.
    step_s, block_s : float
        Step of the simulation; length of the blocks between which residuals are taken as independent.
    consequence : float
        Load constant that the verdict ``none`` excludes.
    seed : int
        Seed of the starts of the search.

    Notes
    -----
    The intervals contain noise, lack of fit (by the sandwich over blocks) and discretisation: the change of a constant
    from a coarser step of at least 10 ms, times the share that a method of first order would leave.

    Raises
    ------
    PinswitchError
        If there is no log, if a log is given twice, if logs are of several servos or without a supply voltage, if the
        servo is unknown, or if a step or speed is not positive.
    """
    if isinstance(logs, Log):
        logs = [logs]
    if not isinstance(logs, Iterable) or isinstance(logs, (str, bytes)):
        raise wrong_type("logs", logs, "logs, as bam.read returns them")
    logs = list(logs)
    if servo is not None and not isinstance(servo, Servo):
        raise wrong_type("servo", servo, "a Servo, such as SERVOS['mx64']")
    step_s = in_range("step_s", step_s, 1e-5, LONGEST_STEP_S, "s")
    block_s = in_range("block_s", block_s, step_s, 1e4, "s")
    stribeck_rad_s = in_range("stribeck_rad_s", stribeck_rad_s, 1e-6, 1e3, "rad/s")
    consequence = in_range("consequence", consequence, 1e-6, 1.0)
    seed = whole("seed", seed, 0, 2**32)
    servo = _servo(logs, servo)
    bench = _bench(logs, servo, step_s, stribeck_rad_s)
    block = max(round(block_s / step_s), 1)
    simple, full = tuple(i for i in range(len(NAMES)) if i != LOAD), tuple(range(len(NAMES)))
    coarse_s = max(SEARCH_STEP_S, 2 * step_s)
    coarse = _bench(logs, servo, coarse_s, stribeck_rad_s)
    starts = [_start(coarse, seed + i) for i in range(SEARCHES)]
    rough = _pendulum.solve(coarse, full, starts)
    starts = [np.where(np.arange(len(NAMES)) == LOAD, 0.0, start) for start in (rough.point, *starts)]
    rough_without = _pendulum.solve(coarse, simple, starts)
    # A better minimum that only one of the fits has found would count as evidence.
    again = _pendulum.solve(coarse, full, [rough_without.point])
    rough = min(rough, again, key=lambda one: one.variance)
    with_load = _pendulum.solve(bench, full, [rough.point])
    without = _pendulum.solve(bench, simple, [rough_without.point])
    # A method of first order would leave this share of the change between the steps.
    share = step_s / (coarse_s - step_s)
    errors, blocks = _errors(with_load, rough, share, block)
    errors[LOAD] = _load_error(bench, with_load, without, float(errors[LOAD]))
    constants = _intervals(with_load, errors)
    odds = ((with_load.point[LOAD] / errors[LOAD]) ** 2 - math.log(blocks)) / 2
    probability = 1 / (1 + math.exp(-min(odds, 700.0)))
    held_out, held_out_without = _held_out(bench, with_load), _held_out(bench, without)
    # A single log has no held-out error, and the comparison is false.
    is_reported = probability >= REPORTED and held_out < held_out_without
    is_excluded = constants["load"].high < consequence
    return Friction(
        constants=constants,
        without_load=_intervals(without, _errors(without, rough_without, share, block)[0]),
        probability=probability,
        verdict="attributed" if is_reported else "none" if is_excluded else "inconclusive",
        rms_rad=math.sqrt(with_load.variance),
        rms_without_load_rad=math.sqrt(without.variance),
        held_out_rad=held_out,
        held_out_without_load_rad=held_out_without,
        noise_rad=_noise(logs, bench, with_load),
        blocks=blocks,
        _points=(with_load.point, without.point),
        _servo=servo,
        _step_s=step_s,
        _stribeck_rad_s=stribeck_rad_s,
    )


def _servo(logs: Sequence[Log], servo: Optional[Servo]) -> Servo:
    """Return the controller of all logs."""
    for one in logs:
        if not isinstance(one, Log):
            raise wrong_type("logs", one, "a log, as bam.read returns it")
    if not logs:
        raise PinswitchError("no log is given", code="missing-field", help="give the logs of a servo", field="logs")
    motors = sorted({log.motor for log in logs})
    if len(motors) > 1:
        problem = f"logs of several servos: {', '.join(motors)}"
        raise PinswitchError(problem, code="conflicting-settings", help="identify each servo alone", field="motor")
    for i, log in enumerate(logs):
        same = [
            other
            for other in logs[:i]
            if np.array_equal(other.time_s, log.time_s) and np.array_equal(other.position_rad, log.position_rad)
        ]
        if same:
            problem = f"the log has the readings of {same[0].path}"
            help = "give each log once: a copy is no evidence"
            raise PinswitchError(problem, code="duplicate-entry", help=help, file=log.path)
    for log in logs:
        if log.supply_v is None:
            help = "add the supply voltage in V; a servo that controls its current cannot be identified"
            raise PinswitchError("vin is missing", code="missing-field", help=help, file=log.path, field="vin")
    if servo is not None:
        return servo
    if motors[0] not in SERVOS:
        help = f"use one of {', '.join(SERVOS)}, or give servo=Servo(error_gain, max_duty)"
        problem = f"the servo {motors[0]} is not known"
        raise PinswitchError(problem, code="unknown-name", help=help, field="motor", value=motors[0])
    return SERVOS[motors[0]]


def _bench(logs: Sequence[Log], servo: Servo, step_s: float, stribeck_rad_s: float) -> Bench:
    """Return the logs on a common grid."""
    count = max(int((log.time_s[-1] - log.time_s[0]) / step_s) + 1 for log in logs)
    shape = (count, len(logs))
    goal, rate, enabled, switched, position = (np.full(shape, np.nan) for _ in range(5))
    for i, log in enumerate(logs):
        times = log.time_s[0] + step_s * np.arange(count)
        # A recorder sets the goal before it reads an entry, and the goal remains after it: on average it is that of
        # the time of the entry.
        goal[:, i] = np.interp(times + step_s / 2, log.time_s, log.goal_rad)
        later = np.interp(times + 1.5 * step_s, log.time_s, log.goal_rad)
        rate[:, i] = (later - np.interp(times - step_s / 2, log.time_s, log.goal_rad)) / (2 * step_s)
        parts = times[:, np.newaxis] + step_s * (np.arange(PARTS) + 0.5) / PARTS
        enabled[:, i] = (np.interp(parts, log.time_s, log.is_on) > 0.5).mean(axis=1)
        edges = np.interp(np.append(times, times[-1] + step_s), log.time_s, log.is_on) > 0.5
        switched[:, i] = np.diff(edges.astype(np.float64)) / step_s
        is_inside = times <= log.time_s[-1]
        position[is_inside, i] = np.interp(times[is_inside], log.time_s, log.position_rad)
    return Bench(
        step_s=step_s,
        goal_rad=goal,
        goal_rad_s=rate,
        enabled=enabled,
        switched=switched,
        position_rad=position,
        speed_rad_s=np.array([log.speed_rad_s[0] for log in logs]),
        inertia_kg_m2=np.array([log.inertia_kg_m2 for log in logs]),
        gravity_nm=np.array([log.gravity_nm for log in logs]),
        duty_rad=np.array([servo.error_gain * log.kp for log in logs]),
        supply_v=np.array([log.supply_v for log in logs], dtype=np.float64),
        max_duty=servo.max_duty,
        stribeck_rad_s=stribeck_rad_s,
    )


def _start(bench: Bench, seed: int) -> Floats:
    """Return constants near the least squares: the fit of ever longer parts of the logs."""
    point = _pendulum.search(_pendulum.shortened(bench, 0.0), seed)
    point = _pendulum.solve(_pendulum.shortened(bench, 0.0), tuple(range(len(NAMES))), [point]).point
    point = _pendulum.split_damping(_pendulum.shortened(bench, SWINGS_S[0]), point)
    for swing_s in SWINGS_S:
        point = _pendulum.solve(_pendulum.shortened(bench, swing_s), tuple(range(len(NAMES))), [point]).point
    return point


def _errors(solution: Solution, rough: Solution, share: float, block: int) -> tuple[Floats, int]:
    """Return the standard errors of the free constants with that of discretisation, and the number of blocks."""
    spread, blocks = _pendulum.covariance(solution, block)
    change = (solution.point - rough.point)[list(solution.free)]
    return np.sqrt(np.diag(spread) + (share * change) ** 2), blocks


def _load_error(bench: Bench, with_load: Solution, without: Solution, wald: float) -> float:
    """Return the standard error of the load constant, at least that of the likelihood ratio.

    Where the logs hardly determine the constant, the residuals are not linear in it, and the standard error of the
    linear model is too small. The likelihood ratio needs no linear model; correlated residuals can only increase it.
    """
    value = float(with_load.point[LOAD])
    ratio = float(np.isfinite(bench.position_rad).sum()) * math.log(without.variance / with_load.variance)
    widest = float(bench.prior()[1][LOAD])
    return max(wald, min(value / math.sqrt(max(ratio, 1e-12)), widest))


def _intervals(solution: Solution, errors: Floats) -> dict[str, Interval]:
    """Return the constants in their units; the interval of a positive one is that of its logarithm."""
    constants = {}
    for i, error in zip(solution.free, errors):
        ends = solution.point[i] + QUANTILE * error * np.array([0.0, -1.0, 1.0])
        value, low, high = np.exp(np.minimum(ends, 700.0)) if i in LOGARITHMIC else ends
        low = max(float(low), 0.0) if i in BOUNDED else low
        constants[NAMES[i]] = Interval(float(value), float(low), float(high))
    return constants


def _noise(logs: Sequence[Log], bench: Bench, solution: Solution) -> float:
    """Return the standard deviation of the noise of single positions, rad."""
    modelled = _pendulum.simulate(bench, solution.point)[:, 0, :]
    squares = []
    for i, log in enumerate(logs):
        grid = log.time_s[0] + bench.step_s * np.arange(len(modelled))
        squares.append(np.diff(log.position_rad - np.interp(log.time_s, grid, modelled[:, i]), 2) ** 2)
    # The second difference of independent errors has six times their variance.
    return math.sqrt(float(np.concatenate(squares).mean()) / 6)


def _held_out(bench: Bench, solution: Solution) -> float:
    """Return the RMS error of logs that are left out in turn, rad."""
    count = len(bench.supply_v)
    if count < 2:
        return math.nan
    fits = [_pendulum.solve(_pendulum.without(bench, i), solution.free, [solution.point]) for i in range(count)]
    errors = _pendulum.residuals(bench, np.array([fit.point for fit in fits]))
    squares = sum(float(np.sum(errors[i, i] ** 2)) for i in range(count))
    return math.sqrt(squares / float(np.isfinite(bench.position_rad).sum()))
