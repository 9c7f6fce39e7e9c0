"""A servo that moves a pendulum: simulation of many pendulums and constants at once, and least squares over them.

The step of length ``h`` takes forces at its middle, is exact for the viscous terms and implicit for the dry friction.
With the torque ``t`` of motor and weight, the limit ``b`` of dry friction, the sum ``d`` of the viscous terms and the
inertia ``J``,

    a = exp(-h d / J),   u = a v + (1 - a) t / d,   v' = sign(u) max(|u| - (1 - a) b / d, 0).

A pendulum that dry friction can stop is at rest at the end of the step, as with the stopping torque of BAM.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Standard gravity, m/s2, as in BAM.
GRAVITY_M_S2 = 9.80665
#: Names of the constants, in the order of a vector.
NAMES = (
    "gain_nm_v",
    "kt_v_s",
    "armature_kg_m2",
    "offset_rad",
    "base_nm",
    "viscous_nm_s",
    "stribeck_nm",
    "delay_s",
    "load",
)
#: Constants that are positive: the fit uses their logarithm.
LOGARITHMIC = (0, 1, 2)
#: Constants that are not negative: friction opposes the motion.
BOUNDED = (4, 5, 6, 8)
LOAD = NAMES.index("load")
#: Largest speed of a simulated pendulum, rad/s: constants far from the solution stay finite.
MAX_SPEED_RAD_S = 50.0
#: Generations, points and best points of the search; share of the new covariance; first width, in those of the prior.
GENERATIONS, POINTS, ELITE, SMOOTHING, SEARCH_WIDTH = 16, 96, 16, 0.6, 0.5
#: Divisions of the damping between motor and friction that the search compares.
SPLITS = 40
#: Iterations of least squares end at this number, or when the cost falls by less than this share.
ITERATIONS, TOLERANCE = 40, 1e-5
#: Factors of the Levenberg-Marquardt damping that each iteration tries.
DAMPINGS = (1e-6, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2)
#: Step of the finite differences, in standard deviations of the prior.
DIFFERENCE = 1e-4


@dataclass(frozen=True)
class Bench:
    """Logs on a common grid of time; ``n`` steps, ``m`` logs.

    Attributes
    ----------
    step_s : float
        Step of the grid.
    goal_rad, goal_rad_s : ndarray, shape (n, m)
        Goal in the middle of each step, and its rate.
    enabled, switched : ndarray, shape (n, m)
        Share of each step in which the torque is enabled, 0 to 1, and 1 or -1 over the step where the torque is
        enabled or disabled within it, 1/s.
    position_rad : ndarray, shape (n, m)
        Measured position at the beginning of each step, not a number after the end of a log.
    speed_rad_s : ndarray, shape (m,)
        Speed at the beginning.
    inertia_kg_m2, gravity_nm : ndarray, shape (m,)
        Moment of inertia of the pendulum, and torque of its weight at 90 degrees.
    duty_rad, supply_v : ndarray, shape (m,)
        Duty cycle per rad of position error, and supply voltage.
    max_duty : float
        Largest duty cycle.
    stribeck_rad_s : float
        Speed at which Stribeck friction has fallen to 1/e.
    """

    step_s: float
    goal_rad: Floats
    goal_rad_s: Floats
    enabled: Floats
    switched: Floats
    position_rad: Floats
    speed_rad_s: Floats
    inertia_kg_m2: Floats
    gravity_nm: Floats
    duty_rad: Floats
    supply_v: Floats
    max_duty: float
    stribeck_rad_s: float

    def prior(self) -> tuple[Floats, Floats]:
        """Return mean and standard deviation of the constants, as the fit uses them, shape (9,) each.

        The widths are far larger than what a usable log leaves open. They make constants that the logs do not determine
        wide instead of infinite.
        """
        torque, volts = float(self.gravity_nm.max()), float(self.supply_v.mean())
        inertia = float(self.inertia_kg_m2.mean())
        motor = [3 * torque / volts, volts / 10, 0.3 * inertia]
        mean = [*np.log(motor), 0, 0, 0, 0, 0, 0]
        width = [1.5, 1.0, 1.5, 0.1, 0.5 * torque, 0.2 * torque, 0.5 * torque, 0.005, 0.5]
        return np.array(mean, dtype=np.float64), np.array(width, dtype=np.float64)


def natural(points: Floats) -> Floats:
    """Return constants in their units, of vectors in which some are logarithms."""
    values = np.array(points, dtype=np.float64)
    values[..., LOGARITHMIC] = np.exp(values[..., LOGARITHMIC])
    return values


def simulate(bench: Bench, points: Floats) -> Floats:
    """Return positions in rad of all logs for several vectors of constants.

    Parameters
    ----------
    bench : Bench
        Logs.
    points : ndarray, shape (p, 9)
        Vectors of constants, as the fit uses them.

    Returns
    -------
    ndarray, shape (n, p, m)
        Position at each step.
    """
    columns = natural(np.atleast_2d(points)).T[:, :, np.newaxis]
    gain, kt, armature, offset, base, viscous, stribeck, delay, load = columns
    step, half = bench.step_s, 0.5 * bench.step_s
    moved = bench.inertia_kg_m2 + armature
    # Decay and response of the speed in a step, with the torque disabled and enabled.
    damping = np.stack([viscous + 0 * moved, viscous + gain * kt + 0 * moved])
    damping = np.maximum(damping, 1e-9)
    decays = np.exp(-step * damping / moved)
    responses = (1 - decays) / damping
    # Weight of the first of two speeds in the mean speed of a step, exact for a constant torque; 1/2 without damping.
    exponents = np.maximum(step * damping / moved, 1e-4)
    weights = 1 / exponents - np.exp(-exponents) / -np.expm1(-exponents)
    count, logs = len(columns[0]), len(bench.supply_v)
    position = np.broadcast_to(bench.position_rad[0], (count, logs)).copy()
    speed = np.broadcast_to(bench.speed_rad_s, (count, logs)).copy()
    positions = np.empty((len(bench.goal_rad), count, logs))
    positions[0] = position
    for i in range(len(bench.goal_rad) - 1):
        middle = position + half * speed
        share = np.minimum(np.maximum(bench.enabled[i] - delay * bench.switched[i], 0.0), 1.0)
        decay = decays[0] + share * (decays[1] - decays[0])
        response = responses[0] + share * (responses[1] - responses[0])
        goal = bench.goal_rad[i] - delay * bench.goal_rad_s[i]
        duty = np.minimum(np.maximum(bench.duty_rad * (goal - middle), -bench.max_duty), bench.max_duty)
        on = gain * share
        drive = on * (bench.supply_v * duty)
        external = -bench.gravity_nm * np.sin(middle + offset)
        limit = base + load * np.abs(drive - on * kt * speed - external)
        limit = np.maximum(limit + stribeck * np.exp(-np.abs(speed) / bench.stribeck_rad_s), 0.0)
        free = decay * speed + response * (drive + external)
        slowed = np.maximum(np.abs(free) - response * limit, 0.0)
        before, speed = speed, np.copysign(np.minimum(slowed, MAX_SPEED_RAD_S), free)
        weight = weights[0] + share * (weights[1] - weights[0])
        position = position + step * (speed + weight * (before - speed))
        positions[i + 1] = position
    return positions


def residuals(bench: Bench, points: Floats) -> Floats:
    """Return measured minus simulated positions, rad, 0 after the end of a log; shape (p, m, n)."""
    differences = bench.position_rad[:, np.newaxis, :] - simulate(bench, points)
    return np.asarray(np.nan_to_num(differences, nan=0.0, posinf=1e3, neginf=-1e3).transpose(1, 2, 0))


def shortened(bench: Bench, swing_s: float) -> Bench:
    """Return the logs without the positions from a time after the torque is disabled.

    A pendulum that swings freely has minima of the residuals wherever it is in phase; one that has just begun to swing,
    or that the motor drives, has not.
    """
    steps = np.cumsum(np.cumsum(bench.enabled < 1, axis=0) > 0, axis=0)
    return replace(bench, position_rad=np.where(steps <= swing_s / bench.step_s, bench.position_rad, np.nan))


def without(bench: Bench, log: int) -> Bench:
    """Return the other logs."""
    arrays: dict[str, Any] = {name: value for name, value in vars(bench).items() if isinstance(value, np.ndarray)}
    return replace(bench, **{name: np.delete(value, log, axis=-1) for name, value in arrays.items()})


@dataclass(frozen=True)
class Solution:
    """Constants with the least squares, and what the inference needs.

    Attributes
    ----------
    point : ndarray, shape (9,)
        Constants, as the fit uses them.
    errors : ndarray, shape (m, n)
        Residuals, rad.
    slopes : ndarray, shape (k, m, n)
        Derivatives of the residuals by the free constants.
    free : tuple of int
        Numbers of the free constants.
    variance : float
        Mean square of the residuals, rad2.
    precision : ndarray, shape (k,)
        Inverse variance of the prior of the free constants.
    pull : ndarray, shape (k,)
        Gradient of the prior.
    """

    point: Floats
    errors: Floats
    slopes: Floats
    free: tuple[int, ...]
    variance: float
    precision: Floats
    pull: Floats

    def normal(self, slopes: Floats) -> Floats:
        """Return the normal matrix of some logs with the prior, shape (k, k)."""
        flat = slopes.reshape(len(self.free), -1)
        normal: Floats = flat @ flat.T / self.variance + np.diag(self.precision)
        return normal

    def step(self, slopes: Floats, errors: Floats, damping: float = 0.0) -> Floats:
        """Return the constants after a Levenberg-Marquardt step with some logs.

        A constant at its bound whose gradient points outwards stays there.
        """
        index = np.array(self.free)
        gradient = slopes.reshape(len(index), -1) @ errors.ravel() / self.variance + self.pull
        is_bounded = np.isin(index, BOUNDED)
        moves = ~(is_bounded & (self.point[index] <= 0) & (gradient > 0))
        normal = self.normal(slopes)[np.ix_(moves, moves)]
        point: Floats = self.point.copy()
        point[index[moves]] -= np.linalg.solve(normal + damping * np.diag(np.diag(normal)), gradient[moves])
        point[list(BOUNDED)] = np.maximum(point[list(BOUNDED)], 0.0)
        return point


def solve(bench: Bench, free: tuple[int, ...], starts: list[Floats]) -> Solution:
    """Return the least squares over the free constants by Levenberg-Marquardt, the best of several starts."""
    mean, width = bench.prior()
    index = list(free)
    # Logs in which the torque is never enabled have no driven part.
    count = max(float(np.isfinite(bench.position_rad).sum()), 1.0)

    def costs(points: Floats, variance: float) -> Floats:
        squares = np.sum(residuals(bench, points) ** 2, axis=(1, 2)) / variance
        return np.asarray(squares + np.sum(((points - mean) / width)[:, index] ** 2, axis=1))

    def solution(point: Floats) -> Solution:
        moved = np.tile(point, (len(index) + 1, 1))
        moved[np.arange(1, len(index) + 1), index] += DIFFERENCE * width[index]
        errors = residuals(bench, moved)
        slopes = (errors[1:] - errors[0]) / (DIFFERENCE * width[index])[:, np.newaxis, np.newaxis]
        variance = max(float(np.sum(errors[0] ** 2)) / count, 1e-12)
        precision = 1 / width[index] ** 2
        return Solution(point, errors[0], slopes, free, variance, precision, (point - mean)[index] * precision)

    def descend(point: Floats) -> Solution:
        now = solution(point)
        for _ in range(ITERATIONS):
            steps = [now.step(now.slopes, now.errors, damping) for damping in DAMPINGS]
            trials = np.array([now.point, *steps])
            values = costs(trials, now.variance)
            best = int(np.argmin(values))
            if values[0] - values[best] <= TOLERANCE * values[0]:
                break
            now = solution(trials[best])
        return now

    found = [descend(start) for start in starts]
    return min(found, key=lambda one: one.variance)


def search(bench: Bench, seed: int) -> Floats:
    """Return constants near the least absolute residuals by the cross-entropy method, shape (9,).

    The residuals have several minima, since dry friction is not smooth. Each generation is drawn from the normal
    distribution of the best points before (Rubinstein & Kroese, *The cross-entropy method*, 2004, chapter 5).
    """
    mean, width = bench.prior()
    random = np.random.default_rng(seed)
    spread = np.diag((SEARCH_WIDTH * width) ** 2)
    best, least = mean, np.inf
    for _ in range(GENERATIONS):
        points = random.multivariate_normal(mean, spread, POINTS)
        points[:, BOUNDED] = np.abs(points[:, BOUNDED])
        sizes = np.sum(np.abs(residuals(bench, points)), axis=(1, 2))
        order = np.argsort(sizes)[:ELITE]
        if sizes[order[0]] < least:
            best, least = points[order[0]], float(sizes[order[0]])
        mean = points[order].mean(axis=0)
        spread = SMOOTHING * np.cov(points[order].T) + (1 - SMOOTHING) * spread
    return best


def split_damping(bench: Bench, point: Floats) -> Floats:
    """Return constants in which the damping is divided between motor and friction as the logs show best.

    While the torque is enabled, only the sum of the viscous friction and of ``gain_nm_v kt_v_s`` acts.
    """
    gain, kt, viscous = natural(point)[[0, 1, NAMES.index("viscous_nm_s")]]
    total = viscous + gain * kt
    shares = np.linspace(0.0, 0.95, SPLITS)
    points = np.tile(point, (SPLITS, 1))
    points[:, NAMES.index("viscous_nm_s")] = shares * total
    points[:, 1] = np.log((1 - shares) * total / gain)
    return np.asarray(points[np.argmin(np.sum(np.abs(residuals(bench, points)), axis=(1, 2)))])


def covariance(solution: Solution, block: int) -> tuple[Floats, int]:
    """Return the covariance of the free constants, shape (k, k), and the number of blocks of consecutive residuals.

    The residuals of a log are correlated in time, since no model is exact. The covariance is the sandwich of Liang &
    Zeger, *Longitudinal data analysis using generalized linear models*, Biometrika 73(1), 1986, over blocks of
    ``block`` steps. Where the conventional standard error is larger, it is used instead, as Angrist & Pischke, *Mostly
    harmless econometrics*, 2009, section 8.2.3, recommend for few blocks.
    """
    bread = np.linalg.inv(solution.normal(solution.slopes))
    scores = []
    for slopes, errors in zip(solution.slopes.transpose(1, 0, 2), solution.errors):
        used = int(np.max(np.flatnonzero(errors), initial=0)) + 1
        for start in range(0, used, block):
            part = slice(start, min(start + block, used))
            scores.append(slopes[:, part] @ errors[part] / solution.variance)
    table = np.array(scores)
    groups, size = table.shape
    scale = groups / max(groups - size, 1)
    robust = bread @ (scale * table.T @ table + np.diag(solution.precision)) @ bread
    larger = np.maximum(np.sqrt(np.diag(bread)), np.sqrt(np.diag(robust)))
    shrink = larger / np.sqrt(np.diag(robust))
    return np.asarray(robust * shrink[:, np.newaxis] * shrink), groups


