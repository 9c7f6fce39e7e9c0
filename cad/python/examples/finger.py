"""A finger lifts a bottle, yields a little and holds it: tension of the motor with and without a switch.

``python finger.py [FIGURE.svg [FILM.gif]]``; the program `pinswitch` has to be on the path. cad/doc/robots.md shows
figure and film. The film draws the simulated flexions: the moment arm of the tendon and the wrap angle are those of the
model, the pulley is drawn where a tendon with this wrap touches it, and the bottle is not to scale.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import mujoco
import numpy as np
from matplotlib.patches import Circle, FancyBboxPatch, Polygon
from PIL import Image

from pinswitch.mujoco import Host

#: A bottle of two litres, g.
BOTTLE_G = 2000
#: Seconds and set flexions in degrees.
TIMES_S, FLEXIONS_DEG = (0.0, 2.0, 3.0, 3.5, 6.0), (20.0, 60.0, 60.0, 55.0, 55.0)
#: Gains of the servo: N/rad and N s/rad.
GAIN, DAMPING = 6000.0, 120.0
#: The servo starts without tension: curves begin at this time, s.
START_S = 0.2
#: Lengths of the links and radius of the drawn pulley, mm.
PROXIMAL_MM, DISTAL_MM, PULLEY_MM = 60.0, 50.0, 13.0
#: Time between frames, and time that the last one remains, ms; colours of the film.
FRAME_MS, LAST_MS, COLOURS = 80, 2500, 64
ORANGE, BLUE, GREY, DARK = "#d9822b", "#2c6fad", "#b8bcc0", "#41464b"


class Run(NamedTuple):
    """Times in s, flexions in rad and tensions of the motor in N."""

    times_s: np.ndarray
    flexion_rad: np.ndarray
    tension_n: np.ndarray

    @property
    def held_n(self) -> float:
        """Tension that holds the bottle at the end."""
        return float(self.tension_n[self.times_s > 5].mean())


def simulate(host: Host) -> Run:
    """Lift, yield and hold."""
    data = mujoco.MjData(host.model)
    data.qpos[0] = np.radians(FLEXIONS_DEG[0])
    points = []
    while data.time < TIMES_S[-1]:
        wanted = np.radians(np.interp(data.time, TIMES_S, FLEXIONS_DEG))
        data.ctrl[0] = max(GAIN * (wanted - data.qpos[0]) - DAMPING * data.qvel[0], 0.0)
        host.step(data)
        points.append((data.time, float(data.qpos[0]), float(data.actuator_force[0])))
    return Run(*np.array(points).T)


def draw_finger(ax: Any, arm_mm: float, flexion_rad: float, tension_n: float, colour: str, is_switch: bool) -> None:
    """Draw links, bottle and tendon; the tendon has the distance of its moment arm from the links."""
    ax.set(xlim=(-42, 122), ylim=(-62, 64), aspect="equal")
    ax.axis("off")
    along = np.array([np.cos(flexion_rad), np.sin(flexion_rad)])
    normal = np.array([-along[1], along[0]])
    joint = np.array([PROXIMAL_MM, 0.0])
    tip = joint + DISTAL_MM * along
    ax.add_patch(Polygon([(-4, -16), (-4, 12), (-12, 12), (-12, -16)], color=GREY))
    for start, end in ((np.array([-4.0, 0.0]), joint), (joint, tip)):
        ax.plot(*zip(start, end), color=GREY, lw=11, solid_capstyle="round", zorder=2)
    ax.plot(*joint, "o", color=DARK, ms=5, zorder=4)
    top = tip[1] - 13
    ax.plot([tip[0], tip[0]], [tip[1], top], color=DARK, lw=1.5, zorder=3)
    ax.plot(*tip, "o", color=DARK, ms=4, zorder=4)
    neck, body = ("round,pad=0,rounding_size=2", "none", BLUE), ("round,pad=0,rounding_size=7", BLUE, "#9cc3e6")
    for (style, edge, face), low, width, height in ((neck, top - 12, 8, 12), (body, top - 62, 26, 52)):
        corner = (tip[0] - width / 2, low)
        ax.add_patch(FancyBboxPatch(corner, width, height, boxstyle=style, fc=face, ec=edge, lw=1.5))
    ax.text(tip[0], top - 38, "2 kg", ha="center", va="center", fontsize=9, color=DARK)
    # The pulley touches the tendon on both sides of the joint, on the bisector of the links.
    bisector = np.array([-np.sin(flexion_rad / 2), np.cos(flexion_rad / 2)])
    centre = joint + (arm_mm + PULLEY_MM) / np.cos(flexion_rad / 2) * bisector
    ax.plot(*zip(joint, centre), color=GREY, lw=4, zorder=1)
    ax.add_patch(Circle(centre, PULLEY_MM, fc="#f3d3a8" if is_switch else "#e4e6e8", ec=colour, lw=1.5, zorder=3))
    angles = -np.pi / 2 + np.linspace(0, flexion_rad, 30)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    if is_switch:
        pins = -np.pi / 2 + np.linspace(0, 2 * np.pi, 18, endpoint=False) + flexion_rad / 2
        places = centre[:, np.newaxis] + 0.78 * PULLEY_MM * np.array([np.cos(pins), np.sin(pins)])
        ax.plot(*places, "o", color=colour, ms=2.5, zorder=4)
    end = joint + 0.8 * DISTAL_MM * along
    tendon = [np.array([-26.0, arm_mm]), *(centre + PULLEY_MM * circle), end + arm_mm * normal]
    ax.plot(*zip(*tendon), color=colour, lw=1 + tension_n / 10, zorder=5, solid_capstyle="butt")
    ax.plot(*zip(end, end + arm_mm * normal), color=DARK, lw=3, zorder=3)
    ax.add_patch(Circle((-28, arm_mm), 9, fc="white", ec=colour, lw=2.5, zorder=6))
    ax.text(-28, arm_mm, "M", ha="center", va="center", fontsize=10, color=colour, weight="bold", zorder=7)
    ax.text(-40, arm_mm + 15, f"{tension_n:.1f} N", ha="left", fontsize=14, color=colour, weight="bold")


def frame(runs: dict[str, Run], arm_mm: float, until_s: float) -> Image.Image:
    """Draw both fingers and the tensions until a time."""
    fig = plt.figure(figsize=(7, 5.2), dpi=100)
    places = {"left": 0.08, "right": 0.98, "top": 0.94, "bottom": 0.1, "wspace": 0.02, "hspace": 0.06}
    axes = fig.subplot_mosaic([list(runs), ["curve"] * len(runs)], height_ratios=[1.5, 1], gridspec_kw=places)
    ax = axes["curve"]
    for (name, run), colour in zip(runs.items(), (ORANGE, BLUE)):
        now = max(int(np.searchsorted(run.times_s, until_s)) - 1, 0)
        flexion, tension = float(run.flexion_rad[now]), float(run.tension_n[now])
        draw_finger(axes[name], arm_mm, flexion, tension, colour, name != "without a switch")
        axes[name].set_title(name, color=colour, fontsize=12, weight="bold")
        drawn = (run.times_s > START_S) & (run.times_s <= until_s)
        ax.plot(run.times_s[drawn], run.tension_n[drawn], color=colour, lw=2)
        if drawn.any():
            ax.plot(run.times_s[now], tension, "o", color=colour, ms=6)
    ax.set(xlim=(0, TIMES_S[-1]), ylim=(15, 42), xlabel="time, s", ylabel="tension of the motor, N")
    for start, end, label in ((0, 2, "lifts"), (2, 3, "stops"), (3, 3.5, "yields"), (3.5, 6, "holds")):
        ax.axvspan(start, end, color="0.94" if label in ("lifts", "yields") else "white", zorder=0)
        if until_s >= start:
            ax.text((start + end) / 2, 39.5, label, ha="center", fontsize=9, color=DARK)
    if until_s >= TIMES_S[-1] - 1:
        low, high = (run.held_n for run in runs.values())
        ax.fill_between([3.75, TIMES_S[-1]], low, high, color=ORANGE, alpha=0.25, lw=0)
        text = f"the motor holds with {100 * (1 - low / high):.1f} % less"
        ax.text(4.75, low - 0.8, text, ha="center", va="top", fontsize=10, color=ORANGE, weight="bold")
    fig.canvas.draw()
    image = Image.fromarray(np.asarray(fig.canvas.buffer_rgba()).copy()).convert("RGB")  # type: ignore[attr-defined]
    plt.close(fig)
    return image


def film(runs: dict[str, Run], arm_mm: float, path: str) -> None:
    """Write the film as an animated GIF."""
    frames = [frame(runs, arm_mm, until_s) for until_s in np.arange(START_S, TIMES_S[-1] + 1e-9, FRAME_MS / 1000)]
    # One palette for all frames: only what moves differs between them.
    palette = frames[-1].quantize(COLOURS, dither=Image.Dither.NONE)
    images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in frames]
    times_ms = [FRAME_MS] * (len(images) - 1) + [LAST_MS]
    images[0].save(path, save_all=True, append_images=images[1:], duration=times_ms, loop=0, optimize=False)


with tempfile.TemporaryDirectory() as folder:
    export = ["pinswitch", "export", "three-double", "--to", "mujoco", "--payload", str(BOTTLE_G), "--out", folder]
    subprocess.run([*export, "--quiet"], check=True)
    switched = Host.load(Path(folder) / "finger.xml")
runs = {"with three-double": simulate(switched), "without a switch": simulate(Host(switched.model, []))}
fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
for name, run in runs.items():
    started = run.times_s > START_S
    ax.plot(run.times_s[started], run.tension_n[started], label=f"{name}: holds with {run.held_n:.2f} N")
saved = 1 - runs["with three-double"].held_n / runs["without a switch"].held_n
print(f"the switch saves {100 * saved:.1f} % of the holding tension")
ax.set(xlabel="time, s", ylabel="tension of the motor, N", ylim=(0, None))
ax.set_title(f"A finger lifts {BOTTLE_G} g to 60 degrees, yields by 5 degrees and holds")
ax.legend(loc="lower center")
if len(sys.argv) > 1:
    plt.rcParams["svg.hashsalt"] = "pinswitch"
    fig.savefig(sys.argv[1], metadata={"Date": None})
if len(sys.argv) > 2:
    film(runs, 1000 * abs(float(switched.model.wrap_prm[0])), sys.argv[2])
