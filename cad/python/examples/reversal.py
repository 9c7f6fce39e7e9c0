"""A winch pulls, releases and pulls a weight over a switch in MuJoCo; draws the tension over the position.

``python reversal.py [FIGURE.svg]`` (cad/doc/robots.md shows the figure)
"""

from __future__ import annotations

import sys

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import pinswitch
from pinswitch.mujoco import Host, Surface, Switch

LOAD_N = 30.0
SPEED_M_S = 0.005
#: Stiffness and damping of the winch.
STIFFNESS_N_M, DAMPING_N_S_M = 20_000.0, 200.0
MODEL = """
<mujoco>
  <option timestep="{step}" gravity="0 0 -9.80665"/>
  <worldbody>
    <body>
      <joint name="weight" type="slide" axis="0 0 1"/>
      <geom type="box" size="0.02 0.02 0.02" mass="{mass}"/>
    </body>
  </worldbody>
  <tendon><fixed name="tendon"><joint joint="weight" coef="-1"/></fixed></tendon>
  <actuator><position tendon="tendon" kp="{stiffness}" kv="{damping}"/></actuator>
</mujoco>
"""


def strokes(surface: Surface, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return position in mm and tension in N of three strokes."""
    text = MODEL.format(step=step_s, mass=LOAD_N / 9.80665, stiffness=STIFFNESS_N_M, damping=DAMPING_N_S_M)
    host = Host(mujoco.MjModel.from_xml_string(text), [Switch("tendon", surface)])
    data = mujoco.MjData(host.model)
    points, length_m = [], -LOAD_N / STIFFNESS_N_M
    for direction, seconds in ((-1, 0.4), (1, 0.4), (-1, 0.4)):
        for _ in range(round(seconds / step_s)):
            # The winch pulls with its stiffness times the difference of the lengths.
            length_m += direction * SPEED_M_S * step_s
            data.ctrl[0] = length_m
            host.step(data)
            points.append((1e3 * data.qpos[0], host["tendon"].tension_n))
    position, tension = np.array(points).T
    return position, tension


curve = pinswitch.predict(pinswitch.Config("three-double"))
fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
for step_s, style in ((1e-4, "-"), (1e-3, "--"), (5e-3, ":")):
    position_mm, tension_n = strokes(Surface.of_curve(curve), step_s)
    ax.plot(position_mm, tension_n, style, label=f"steps of {1e3 * step_s:g} ms")
for column, label in ((curve.concentric_n, "lifts"), (curve.eccentric_n, "holds")):
    ax.axhline(np.interp(LOAD_N, curve.load_n, column), color="0.6", lw=1, zorder=0)
    ax.annotate(f"curve: {label}", (1.2, np.interp(LOAD_N, curve.load_n, column) + 0.15), color="0.4")
ax.set(xlabel="position of the weight, mm", ylabel="tension of the motor, N", title=f"A weight of {LOAD_N:g} N on three-double")
ax.legend(loc="center")
if len(sys.argv) > 1:
    plt.rcParams["svg.hashsalt"] = "pinswitch"
    fig.savefig(sys.argv[1], metadata={"Date": None})
