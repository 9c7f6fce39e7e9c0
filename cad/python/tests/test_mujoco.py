"""The host for MuJoCo, with the real simulator."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Optional

import numpy as np
import pytest

import pinswitch
from pinswitch import PinswitchError

mujoco = pytest.importorskip("mujoco")
from pinswitch.mujoco import Host, Surface, Switch  # noqa: E402

GRAVITY = 9.80665
#: Largest relative difference from the curve.
BOUND = 0.005

RIG = """
<mujoco>
  <option timestep="{step}" gravity="0 0 -{gravity}" integrator="{integrator}"/>
  <worldbody>
    <body>
      <joint name="weight" type="slide" axis="0 0 1"/>
      <geom type="box" size="0.02 0.02 0.02" mass="{mass}"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="tendon" {spring}><joint joint="weight" coef="-1"/></fixed>
  </tendon>
  <actuator>{actuator}</actuator>
</mujoco>
"""
MOTOR = '<motor tendon="tendon" gear="-1"/>'


def rig(
    surface: Surface,
    load_n: float,
    step: float = 1e-3,
    actuator: str = MOTOR,
    spring: str = "",
    integrator: str = "Euler",
) -> tuple[Host, Any]:
    """A weight on a tendon that a motor pulls over a switch."""
    text = RIG.format(
        step=step, gravity=GRAVITY, mass=load_n / GRAVITY, actuator=actuator, spring=spring, integrator=integrator
    )
    host = Host(mujoco.MjModel.from_xml_string(text), [Switch("tendon", surface)])
    return host, mujoco.MjData(host.model)


@pytest.fixture(scope="module")
def curve() -> pinswitch.Curve:
    return pinswitch.predict(pinswitch.Config("three-double", friction__points=101))


@pytest.fixture(scope="module")
def surface(curve: pinswitch.Curve) -> Surface:
    return Surface.of_curve(curve)


def slips(surface: Surface, load_n: float, tension_n: float, step: float) -> bool:
    """Whether a weight still slides 0.3 s after a tension is reached, when its transient has passed."""
    host, data = rig(surface, load_n, step)
    slipped_m = 0.0
    while data.time < 0.5:
        data.ctrl[0] = load_n + (tension_n - load_n) * min(data.time / 0.1, 1.0)
        host.step(data)
        slipped_m += host["tendon"].slip_m if data.time > 0.4 else 0.0
    return abs(slipped_m) > 1e-6


def sliding_tension_n(surface: Surface, load_n: float, direction: int, step: float = 1e-3) -> float:
    """Bisect the tension from which a weight is lifted (1), or down to which it is held (-1), to 0.02 %."""
    sticks_n, slips_n = load_n, load_n * (1 + 0.4 * direction)
    assert slips(surface, load_n, slips_n, step)
    while abs(slips_n - sticks_n) > 2e-4 * load_n:
        middle_n = (sticks_n + slips_n) / 2
        if slips(surface, load_n, middle_n, step):
            slips_n = middle_n
        else:
            sticks_n = middle_n
    return slips_n


@pytest.mark.parametrize("load_n", [3.2, 10.0, 20.0, 27.0, 35.0, 49.0])
def test_lifted_and_held_loads_follow_the_curve(curve: pinswitch.Curve, surface: Surface, load_n: float) -> None:
    lifts = np.interp(load_n, curve.load_n, curve.concentric_n)
    holds = np.interp(load_n, curve.load_n, curve.eccentric_n)
    assert sliding_tension_n(surface, load_n, 1) == pytest.approx(lifts, rel=BOUND)
    assert sliding_tension_n(surface, load_n, -1) == pytest.approx(holds, rel=BOUND)


@pytest.mark.parametrize("step", [1e-4, 5e-4, 2e-3, 5e-3])
def test_steps_agree(curve: pinswitch.Curve, surface: Surface, step: float) -> None:
    lifts = np.interp(40.0, curve.load_n, curve.concentric_n)
    assert sliding_tension_n(surface, 40.0, 1, step) == pytest.approx(lifts, rel=BOUND)


@pytest.mark.parametrize("step", [1e-4, 1e-3, 5e-3])
def test_reversals_follow_both_branches(curve: pinswitch.Curve, surface: Surface, step: float) -> None:
    """A winch moves a weight up, down and up at 5 mm/s; between the branches the tendon sticks."""
    load_n = 30.0
    # The tension is that of a velocity servo.
    host, data = rig(surface, load_n, step, '<velocity tendon="tendon" kv="600"/>')
    lifts = np.interp(load_n, curve.load_n, curve.concentric_n)
    holds = np.interp(load_n, curve.load_n, curve.eccentric_n)
    switch, speed = host["tendon"], 0.005
    data.ctrl[0] = -speed
    for expected, direction in ((lifts, -1), (holds, 1), (lifts, -1)):
        # The set speed is that at which the servo pulls with the tension and the weight moves with the speed.
        data.ctrl[0] = direction * speed - expected / 600
        for _ in range(int(0.6 / step)):
            host.step(data)
        assert np.sign(data.ten_velocity[0]) == direction and switch.slip_m != 0
        assert switch.tension_n == pytest.approx(expected, rel=BOUND)


def test_a_stuck_weight_rests(surface: Surface) -> None:
    """Between the branches nothing creeps, for any time."""
    load_n = 30.0
    host, data = rig(surface, load_n)
    lower, upper = surface.bounds_n(load_n)
    data.ctrl[0] = load_n + 0.5 * upper
    positions = []
    for _ in range(4000):
        host.step(data)
        positions.append(data.qpos[0])
    amplitude = [np.ptp(positions[i : i + 1000]) for i in (0, 1000, 2000, 3000)]
    assert amplitude[3] < 1e-9 and positions[-1] == pytest.approx(0.5 * upper / 20_000, rel=1e-6)
    assert lower < host["tendon"].friction_n < upper


@pytest.mark.parametrize("step", [1e-4, 1e-3, 5e-3])
@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_undriven_energy_never_grows(surface: Surface, step: float, speed: float) -> None:
    """A weight on a constant tension is thrown up or down and comes to rest."""
    load_n = 20.0
    host, data = rig(surface, load_n, step)
    data.ctrl[0], data.qvel[0] = load_n, speed
    switch, mass = host["tendon"], load_n / GRAVITY

    def energy_j() -> float:
        # The tension is constant: its work is a potential, as that of the weight.
        lifted = 0.5 * mass * data.qvel[0] ** 2 + load_n * data.qpos[0] - data.ctrl[0] * data.qpos[0]
        return float(lifted + switch.stored_j)

    mujoco.mj_forward(host.model, data)
    start = last = 0.5 * mass * 0.5**2
    for _ in range(int(2.0 / step)):
        host.step(data)
        now = energy_j()
        assert now <= last + 1e-9 * start, f"{data.time}: {now} after {last}"
        last = now
    assert last < 1e-3 * start and switch.dissipated_j == pytest.approx(start, rel=0.1)


def test_a_spring_driven_weight_comes_to_rest(surface: Surface) -> None:
    """The tension of a passive spring varies the bounds; the energy falls on average and the weight stops."""
    load_n = 20.0
    host, data = rig(surface, load_n, spring='stiffness="2000" springlength="-0.01"', actuator="", integrator="RK4")
    data.qpos[0] = -0.005
    energies = []
    for _ in range(3000):
        host.step(data)
        energies.append(0.5 * load_n / GRAVITY * data.qvel[0] ** 2)
    assert host["tendon"].tension_n > 0
    assert max(energies[2000:]) < 1e-6 * max(energies)


def test_two_switches_on_one_joint_add_up(curve: pinswitch.Curve, surface: Surface) -> None:
    text = RIG.format(step=1e-3, gravity=GRAVITY, mass=40 / GRAVITY, actuator=MOTOR, spring="", integrator="Euler")
    second = '<fixed name="second"><joint joint="weight" coef="-1"/></fixed></tendon>'
    text = text.replace("</tendon>", second).replace("</actuator>", '<motor tendon="second" gear="-1"/></actuator>')
    host = Host(mujoco.MjModel.from_xml_string(text), [Switch("tendon", surface), Switch("second", surface)])
    data = mujoco.MjData(host.model)
    lifts = np.interp(20, curve.load_n, curve.concentric_n)
    while all(switch.slip_m == 0 for switch in host.switches):
        data.ctrl[:] = 20 + 4 * data.time
        host.step(data)
        assert data.time < 2
    assert host["tendon"].tension_n == pytest.approx(lifts, rel=2 * BOUND)


def test_slack_tendons_have_no_friction(surface: Surface) -> None:
    assert surface.bounds_n(0.0) == surface.bounds_n(-5.0) == (0.0, 0.0)
    low, high = surface.bounds_n(1.0)
    assert low < 0 < high
    # The ratio of tension and load is constant beyond the curve.
    assert surface.bounds_n(200.0)[1] == pytest.approx(2 * surface.bounds_n(100.0)[1])


def test_friction_grows_with_the_wrap(curve: pinswitch.Curve) -> None:
    doubled = curve.load_n * (curve.concentric_n / curve.load_n) ** 2
    halved = curve.load_n * (curve.eccentric_n / curve.load_n) ** 2
    surface = Surface(
        [0.5, 1.0], curve.load_n, [curve.eccentric_n, halved], [curve.concentric_n, doubled]
    )
    highs = [surface.bounds_n(30.0, wrap)[1] for wrap in (0.0, 0.25, 0.5, 0.75, 1.0, 1.5)]
    assert highs[0] == 0 and highs == sorted(highs) and highs[4] == highs[5]
    assert highs[1] == pytest.approx(highs[2] / 2) and highs[3] == pytest.approx((highs[2] + highs[4]) / 2)


@pytest.mark.parametrize("change", [{"eccentric_n": [[2.0, 1.0]]}, {"concentric_n": [[0.5, 1.5]]}, {"wrap_rad": [1, 2]}])
def test_impossible_tables_are_refused(change: dict[str, Any]) -> None:
    table: dict[str, Any] = {"wrap_rad": [1.0], "load_n": [1.0, 2.0], "eccentric_n": [[0.9, 1.7]], "concentric_n": [[1.1, 2.4]]}
    Surface(**table)
    with pytest.raises(PinswitchError):
        Surface(**{**table, **change})


@pytest.mark.parametrize(
    ("wrap_rad", "load_n"),
    [([], [1, 2]), ([1], []), ([2, 1], [1, 2]), ([1, 1], [1, 2]), ([np.inf], [1, 2]), ([0], [1, 2]), ([1], [2, 1])],
)
def test_impossible_axes_are_refused(wrap_rad: list[float], load_n: list[float]) -> None:
    lower = np.tile(np.asarray(load_n, dtype=float), (len(wrap_rad), 1))
    with pytest.raises(PinswitchError, match="positive, finite, ascending"):
        Surface(wrap_rad, load_n, lower * 0.9, lower * 1.1)


def test_unknown_tendons_are_refused(surface: Surface) -> None:
    host, _ = rig(surface, 10.0)
    with pytest.raises(PinswitchError, match="no tendon"):
        Host(host.model, [Switch("absent", surface)])
    with pytest.raises(PinswitchError, match="two switches are on this tendon"):
        Host(host.model, [Switch("tendon", surface), Switch("tendon", surface)])
    with pytest.raises(PinswitchError) as caught:
        Host.load("no-such.xml")
    assert caught.value.code == "cannot-read"
    with pytest.raises(PinswitchError, match="no switch on this tendon") as caught:
        host["absent"]
    assert caught.value.help == "its tendons are tendon"
    for stiffness_n_m in (0.0, float("inf"), float("nan")):
        with pytest.raises(PinswitchError, match="stiffness_n_m"):
            Host(host.model, [Switch("tendon", surface, stiffness_n_m=stiffness_n_m)])
    for damping_ratio in (-1.0, float("inf"), float("nan")):
        with pytest.raises(PinswitchError, match="damping_ratio"):
            Host(host.model, [Switch("tendon", surface, damping_ratio=damping_ratio)])


def exported(command: list[str], folder: Path) -> Optional[Path]:
    """Run `pinswitch export`; skip where the command line is not installed."""
    import shutil
    import subprocess

    program = shutil.which("pinswitch")
    if program is None:
        pytest.skip("the command line writes the model")
    subprocess.run([program, "export", "three-double", *command, "--out", str(folder)], check=True)
    return folder


def test_exported_fingers_hold_and_lift(tmp_path: Path) -> None:
    folder = exported(["--to", "mujoco", "--draws", "2"], tmp_path)
    assert folder is not None and (folder / "finger-002.xml").is_file()
    assert (folder / "switch-001.json").read_text() != (folder / "switch.json").read_text()
    host = Host.load(folder / "finger.xml")
    data = mujoco.MjData(host.model)
    switch = host["flexor"]
    arm = float(host.model.wrap_prm[0])
    flexion = np.radians(45)
    for direction in (1, -1):
        mujoco.mj_resetData(host.model, data)
        host.reset()
        data.qpos[0] = flexion
        mujoco.mj_forward(host.model, data)
        torque = float(data.qfrc_bias[0])
        load_n = torque / abs(arm)
        data.ctrl[0] = load_n
        while switch.slip_m == 0 or data.time < 0.01:
            data.ctrl[0] = load_n * (1 + direction * 0.4 * data.time)
            host.step(data)
            assert data.time < 1.0
        wrap = switch.wrap_rad(float(data.ten_length[0]))
        assert wrap == pytest.approx(data.qpos[0], abs=1e-3)
        bounds = switch.surface.bounds_n(switch.tension_n, wrap)
        friction = bounds[1] if direction > 0 else bounds[0]
        assert switch.load_n == pytest.approx(load_n, rel=2 * BOUND)
        assert switch.friction_n == pytest.approx(friction, rel=1e-3)
