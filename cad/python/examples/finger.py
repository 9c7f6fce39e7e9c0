"""A finger lifts a bottle, yields a little and holds it: tension of the motor with and without a switch.

``python finger.py [FIGURE.svg]``; the program `pinswitch` has to be on the path (cad/doc/robots.md shows the figure).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

from pinswitch.mujoco import Host

#: A bottle of two litres, g.
BOTTLE_G = 2000
#: Seconds and set flexions in degrees.
TIMES_S, FLEXIONS_DEG = (0.0, 2.0, 3.0, 3.5, 6.0), (20.0, 60.0, 60.0, 55.0, 55.0)
#: Gains of the servo: N/rad and N s/rad.
GAIN, DAMPING = 6000.0, 120.0


def tensions_n(host: Host) -> tuple[np.ndarray, np.ndarray]:
    """Return times in s and tensions of the motor in N."""
    data = mujoco.MjData(host.model)
    data.qpos[0] = np.radians(FLEXIONS_DEG[0])
    points = []
    while data.time < TIMES_S[-1]:
        wanted = np.radians(np.interp(data.time, TIMES_S, FLEXIONS_DEG))
        data.ctrl[0] = max(GAIN * (wanted - data.qpos[0]) - DAMPING * data.qvel[0], 0.0)
        host.step(data)
        points.append((data.time, float(data.actuator_force[0])))
    times, tensions = np.array(points).T
    return times, tensions


with tempfile.TemporaryDirectory() as folder:
    export = ["pinswitch", "export", "three-double", "--to", "mujoco", "--payload", str(BOTTLE_G), "--out", folder]
    subprocess.run([*export, "--quiet"], check=True)
    switched = Host.load(Path(folder) / "finger.xml")
plain = Host(switched.model, [])
fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
held = {}
for name, host in (("with three-double", switched), ("without a switch", plain)):
    times_s, tension_n = tensions_n(host)
    held[name] = tension_n[times_s > 5].mean()
    # The servo starts without tension.
    started = times_s > 0.2
    ax.plot(times_s[started], tension_n[started], label=f"{name}: holds with {held[name]:.2f} N")
saved = 1 - held["with three-double"] / held["without a switch"]
print(f"the switch saves {100 * saved:.1f} % of the holding tension")
ax.set(xlabel="time, s", ylabel="tension of the motor, N", ylim=(0, None))
ax.set_title(f"A finger lifts {BOTTLE_G} g to 60 degrees, yields by 5 degrees and holds")
ax.legend(loc="lower center")
if len(sys.argv) > 1:
    plt.rcParams["svg.hashsalt"] = "pinswitch"
    fig.savefig(sys.argv[1], metadata={"Date": None})
