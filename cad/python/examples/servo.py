"""A simulated servo moves a pendulum; its logs in BAM's format are read, and its friction is identified.

``python servo.py [FIGURE.svg]`` (cad/doc/robots.md shows the figure). The logs are simulated, with known constants. The
simulator is not that of the identification: explicit steps of 0.25 ms with a state of rest, an encoder of 4096 counts
with noise, and irregular times.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any, Callable

import matplotlib.pyplot as plt
import numpy as np

from pinswitch import bam

#: Constants of the servo; friction and motor are similar to the MX-64 in BAM's `params/mx64/m3.json`.
SERVO = {"gain": 0.45, "kt": 1.6, "armature": 0.012, "base": 0.09, "viscous": 0.01, "stribeck": 0.02, "load": 0.08}
#: Speed at which Stribeck friction has fallen to 1/e, rad/s, and position at which the arm hangs, rad.
STRIBECK_RAD_S, OFFSET_RAD = 0.5, 0.01
#: Masses in kg, on an arm of 20 g and 150 mm, and gains of the controller.
PATHS = ((8, "sin_sin"), (32, "up_and_down"), (16, "lift_and_drop"))
RUNS = [(mass, kp, name) for mass in (0.5, 1.5) for kp, name in PATHS]
#: Goal in rad and state of the torque, of the name of a trajectory and a time in s.
Goal = Callable[[str, float], tuple[float, bool]]
#: Step of the simulation and mean time between entries, s; standard deviation of the encoder's noise, rad.
STEP_S, ENTRY_S, NOISE_RAD = 0.00025, 0.005, 0.001


def goal(name: str, t: float) -> tuple[float, bool]:
    """Return goal in rad and state of the torque at a time, as in BAM's ``trajectory.py``."""
    if name == "lift_and_drop":
        share = min(t / 2, 1.0)
        return -np.pi / 2 * share**2 * (3 - 2 * share), t < 2
    if name == "up_and_down":
        up, down = min(t / 3, 1.0), max((t - 3) / 3, 0.0)
        return np.pi / 2 * (up**2 * (3 - 2 * up) - 0.2 * down**2 * (3 - 2 * down)), True
    return np.sin(t) * np.pi / 2 + 0.5 * np.sin(5 * t) * np.sin(2 * t), True


def record(
    run: tuple[float, float, str], seed: int, servo: dict[str, float] = SERVO, path: Goal = goal, seconds: float = 6.0
) -> dict[str, Any]:
    """Simulate a run, and return its log in BAM's format."""
    mass, kp, name = run
    rng = np.random.default_rng(seed)
    log: dict[str, Any] = {"mass": mass, "arm-mass": 0.02, "length": 0.15, "kp": kp, "vin": 15.0, "motor": "mx64"}
    log.update(trajectory=name, entries=[])
    inertia = (mass + 0.02 / 3) * 0.15**2 + servo["armature"]
    weight = (mass + 0.02 / 2) * 9.80665 * 0.15
    position = speed = 0.0
    target, enabled = path(name, 0.0)
    read_s, set_s = 0.4 * ENTRY_S, ENTRY_S
    for i in range(round(seconds / STEP_S)):
        duty = min(max(0.158 * kp * (target - position), -0.9625), 0.9625)
        motor = servo["gain"] * (15.0 * duty - servo["kt"] * speed) if enabled else 0.0
        external = -weight * np.sin(position + OFFSET_RAD)
        limit = servo["base"] + servo["load"] * abs(motor - external) + servo["viscous"] * abs(speed)
        limit += servo["stribeck"] * np.exp(-abs(speed) / STRIBECK_RAD_S)
        torque = motor + external
        if speed == 0.0:
            # At rest, the pendulum moves only if the torque exceeds the friction.
            speed = np.sign(torque) * max(abs(torque) - limit, 0.0) / inertia * STEP_S
        else:
            after = speed + (torque - np.sign(speed) * limit) / inertia * STEP_S
            speed = 0.0 if after * speed < 0 else after
        position += speed * STEP_S
        t = (i + 1) * STEP_S
        if t >= read_s:
            reading = np.round((position + NOISE_RAD * rng.standard_normal()) * 4096 / (2 * np.pi)) * 2 * np.pi / 4096
            entry = {"timestamp": t, "position": float(reading), "speed": float(np.round(speed / 0.0115) * 0.0115)}
            log["entries"].append({**entry, "goal_position": float(target), "torque_enable": bool(enabled)})
            read_s = np.inf
        if t >= set_s:
            # The recorder sets a goal, then reads the servo, then sets the next goal.
            target, enabled = path(name, t)
            read_s, set_s = t + 0.4 * ENTRY_S, t + ENTRY_S * rng.uniform(0.9, 1.1)
    return log


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        logs = []
        for i, run in enumerate(RUNS):
            path = Path(folder) / f"run-{i}.json"
            path.write_text(json.dumps(record(run, seed=i)), encoding="utf-8")
            logs.append(bam.read(path))
    friction = bam.identify(logs)
    print(friction)
    print("true: " + ", ".join(f"{name} {value:g}" for name, value in SERVO.items()))
    exponent = friction.capstan_exponent
    print(f"as a tendon over a pulley: exponent {exponent.value:.3f} [{exponent.low:.3f}, {exponent.high:.3f}]")
    heavy = [log for log in logs if log.mass_kg == max(mass for mass, _, _ in RUNS)]
    fig, axes = plt.subplots(2, len(heavy), figsize=(9, 5), sharex=True, sharey="row", layout="constrained")
    for (above, below), log in zip(axes.T, heavy):
        above.plot(log.time_s[::3], np.degrees(log.position_rad)[::3], color="0.7", lw=4, label="log (simulated)")
        for with_load, colour in ((False, "#2c6fad"), (True, "#d9822b")):
            label = f"model {'with' if with_load else 'without'} dependence on load"
            modelled = np.degrees(friction.positions_rad(log, with_load))[::3]
            above.plot(log.time_s[::3], modelled, color=colour, lw=1.2)
            below.plot(log.time_s[::3], np.degrees(log.position_rad)[::3] - modelled, color=colour, lw=1.2, label=label)
        above.set_title(f"{log.mass_kg:g} kg, kp {log.kp:g}, {log.trajectory}", fontsize=10)
        below.set_xlabel("time, s")
    axes[0, 0].set_ylabel("position, degrees")
    axes[1, 0].set_ylabel("log minus model, degrees")
    axes[0, 0].legend(loc="lower left", fontsize=9)
    axes[1, 0].legend(loc="lower left", fontsize=9)
    if len(sys.argv) > 1:
        plt.rcParams["svg.hashsalt"] = "pinswitch"
        fig.savefig(sys.argv[1], metadata={"Date": None})


if __name__ == "__main__":
    main()
