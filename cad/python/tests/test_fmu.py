"""The co-simulation unit, with the real importer."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import pinswitch

fmpy = pytest.importorskip("fmpy")
#: Largest relative difference from the curve.
BOUND = 0.005


@pytest.fixture(scope="module")
def unit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = shutil.which("pinswitch")
    if program is None or shutil.which("cc") is None:
        pytest.skip("the command line and a C compiler make the unit")
    folder = tmp_path_factory.mktemp("fmu")
    subprocess.run([program, "export", "three-double", "--to", "fmu", "--out", str(folder)], check=True)
    return folder / "switch.fmu"


def test_the_friction_of_a_joint_follows_its_wrap(tmp_path: Path) -> None:
    program = shutil.which("pinswitch")
    if program is None or shutil.which("cc") is None:
        pytest.skip("the command line and a C compiler make the unit")
    joint = ["three-double", "--set", "mount.kind=joint", "--set", "friction.points=21"]
    subprocess.run([program, "export", *joint, "--to", "fmu", "--out", str(tmp_path)], check=True)
    table = json.loads((tmp_path / "switch.json").read_text())
    assert len(table["wrap_rad"]) > 2
    for i in (1, len(table["wrap_rad"]) - 1):
        signal = np.zeros(2, dtype=[(name, float) for name in ("time", "tension_N", "displacement_m", "wrap_rad")])
        signal["time"], signal["displacement_m"] = [0.0, 0.4], [0.0, 0.004]
        signal["tension_N"], signal["wrap_rad"] = 20.0, table["wrap_rad"][i]
        result = fmpy.simulate_fmu(
            str(tmp_path / "switch.fmu"), stop_time=0.4, step_size=1e-3, input=signal, output=["load_N"]
        )
        lifted = np.interp(20.0, table["concentric_n"][i], table["load_n"])
        assert result["load_N"][-1] == pytest.approx(lifted, rel=BOUND)


def test_the_unit_conforms(unit: Path) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(unit)) == []
    description = fmpy.read_model_description(str(unit))
    assert description.fmiVersion == "3.0" and description.coSimulation is not None


@pytest.mark.parametrize("tension_n", [3.5, 10.0, 25.0, 42.0])
@pytest.mark.parametrize("step", [1e-4, 1e-3, 5e-3])
def test_reversals_follow_both_branches(unit: Path, tension_n: float, step: float) -> None:
    """At a constant tension, the tendon moves 4 mm to the motor, back, and to the motor again, at 10 mm/s."""
    curve = pinswitch.predict(pinswitch.Config("three-double"))
    times = np.array([0.0, 0.4, 0.8, 1.2])
    motion = np.array([0.0, 0.004, 0.0, 0.004])
    signal = np.zeros(4, dtype=[("time", float), ("tension_N", float), ("displacement_m", float)])
    signal["time"], signal["tension_N"], signal["displacement_m"] = times, tension_n, motion
    names = ["load_N", "friction_N", "dissipated_J", "displacement_m"]
    result = fmpy.simulate_fmu(
        str(unit), stop_time=1.2, step_size=step, output_interval=step, input=signal, output=names
    )
    lifted = np.interp(tension_n, curve.concentric_n, curve.load_n)
    held = np.interp(tension_n, curve.eccentric_n, curve.load_n)
    for end, load_n in ((0.39, lifted), (0.79, held), (1.19, lifted)):
        at = np.searchsorted(result["time"], end)
        assert result["load_N"][at] == pytest.approx(load_n, rel=BOUND)
    assert result["load_N"].min() >= lifted * (1 - BOUND) and result["load_N"].max() <= held * (1 + BOUND)
    # Energy: what the motion puts in is dissipated or stored in the bristle, up to the first step.
    friction = result["friction_N"]
    work = np.sum(friction[1:] * np.diff(result["displacement_m"]))
    stored = friction[-1] ** 2 / (2 * 20_000)
    assert np.all(np.diff(result["dissipated_J"]) >= 0)
    assert result["dissipated_J"][-1] + stored <= work * (1 + 1e-2)


def test_impossible_inputs_are_refused(unit: Path) -> None:
    with pytest.raises(Exception, match="fmi3SetFloat64"):
        fmpy.simulate_fmu(str(unit), stop_time=0.01, start_values={"stiffness_N_m": -1.0})
