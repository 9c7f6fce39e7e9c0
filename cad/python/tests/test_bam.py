"""Logs of servos in BAM's format, and the friction identified from them.

The logs are those of the simulator in examples/servo.py, which shares no code with the identification.
"""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from types import ModuleType
from typing import Any, Callable

import numpy as np
import pytest

from pinswitch import PinswitchError, bam

pytest.importorskip("matplotlib")

#: Step of the fits, s: twice the default, to save time.
STEP_S = 0.005
RUNS = [(mass, kp, name) for mass in (0.5, 1.5) for kp, name in ((8, "sin_sin"), (16, "lift_and_drop"))]


@pytest.fixture(scope="module")
def rig() -> ModuleType:
    """The simulator of the example."""
    path = Path(__file__).parents[1] / "examples" / "servo.py"
    spec = importlib.util.spec_from_file_location("servo", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def servo(rig: ModuleType, seed: int, **constants: float) -> dict[str, float]:
    """A servo whose motor and friction vary with the seed."""
    random = np.random.default_rng(seed)
    drawn = {
        "gain": 0.45 * np.exp(0.2 * random.standard_normal()),
        "kt": 1.6 * np.exp(0.1 * random.standard_normal()),
        "base": random.uniform(0.05, 0.15),
        "viscous": random.uniform(0.0, 0.03),
    }
    return {**rig.SERVO, **drawn, **constants}


def logs(
    rig: ModuleType, folder: Path, constants: dict[str, float], seed: int, runs: Any = RUNS, **options: Any
) -> list[bam.Log]:
    """Simulated runs, written and read."""
    found = []
    for i, run in enumerate(runs):
        path = folder / f"{i}.json"
        path.write_text(json.dumps(rig.record(run, 100 * seed + i, constants, **options)))
        found.append(bam.read(path))
    return found


@pytest.mark.parametrize(("load", "seed"), [(0.02, 0), (0.04, 1), (0.1, 2), (0.2, 3)])
def test_known_friction_is_recovered(rig: ModuleType, tmp_path: Path, load: float, seed: int) -> None:
    true = servo(rig, seed, load=load)
    friction = bam.identify(logs(rig, tmp_path, true, seed), step_s=STEP_S)
    assert friction.verdict == "attributed" and friction.probability > 0.99
    assert friction.held_out_rad < 0.7 * friction.held_out_without_load_rad
    for name, value in (("load", load), ("base_nm", true["base"]), ("gain_nm_v", true["gain"])):
        found = friction.constants[name]
        assert found.low <= value <= found.high and found.high - found.low < 0.01 + 0.1 * value, name
    # The drag is the same at every load: the slopes are those of a tendon over a pulley.
    holds, lifts = friction.torques_nm(np.array([1.0, 2.0]))
    exponent = friction.capstan_exponent.value
    assert np.diff(lifts)[0] == pytest.approx(np.exp(exponent))
    assert np.diff(holds)[0] == pytest.approx(np.exp(-exponent))
    assert holds[0] < 1.0 < lifts[0]


@pytest.mark.parametrize(("stribeck", "seed"), [(0.0, 4), (0.02, 5), (0.05, 6)])
def test_absent_load_dependence_is_excluded(rig: ModuleType, tmp_path: Path, stribeck: float, seed: int) -> None:
    true = servo(rig, seed, load=0.0, stribeck=stribeck)
    friction = bam.identify(logs(rig, tmp_path, true, seed), step_s=STEP_S)
    assert friction.verdict == "none" and friction.probability < 0.5
    assert friction.constants["load"].high < bam.CONSEQUENCE


@pytest.mark.parametrize("load", [0.0, 0.1])
def test_one_small_load_cannot_decide(rig: ModuleType, tmp_path: Path, load: float) -> None:
    """A light arm that moves slowly: its friction is one number, whatever depends on the load."""
    runs = [(0.02, kp, "slow") for kp in (8, 32)]
    slow: Callable[[str, float], tuple[float, bool]] = lambda name, t: (0.3 * np.sin(1.5 * t), True)
    found = logs(rig, tmp_path, servo(rig, 1, load=load), 1, runs, path=slow)
    friction = bam.identify(found, step_s=STEP_S)
    assert friction.verdict == "inconclusive"
    assert friction.constants["load"].low <= load <= friction.constants["load"].high
    assert friction.constants["load"].high > 5 * bam.CONSEQUENCE


def test_resting_arm_decides_nothing(rig: ModuleType, tmp_path: Path) -> None:
    """The torque is never enabled, and the arm hangs."""
    off: Callable[[str, float], tuple[float, bool]] = lambda name, t: (0.0, False)
    friction = bam.identify(logs(rig, tmp_path, rig.SERVO, 0, RUNS[:2], path=off, seconds=2.0), step_s=STEP_S)
    assert friction.verdict == "inconclusive" and friction.probability < 0.5
    assert friction.constants["base_nm"].high > 0.5 and friction.constants["load"].high > 0.5


def test_lack_of_fit_is_detected(rig: ModuleType, tmp_path: Path) -> None:
    """A slow error of the encoder is not noise, and no constant explains it."""
    run = (1.5, 8, "sin_sin")
    log = rig.record(run, 0)
    assert bam.identify([bam.read(written(tmp_path, log))], step_s=STEP_S).adequate
    for entry in log["entries"]:
        entry["position"] += 0.02 * float(np.sin(7 * entry["timestamp"]))
    friction = bam.identify([bam.read(written(tmp_path, log))], step_s=STEP_S)
    assert not friction.adequate and friction.noise_rad == pytest.approx(0.0011, rel=0.1)
    assert np.isnan(friction.held_out_rad)


@pytest.fixture(scope="module")
def table(rig: ModuleType) -> dict[str, Any]:
    log: dict[str, Any] = rig.record(RUNS[0], 0, seconds=1.0)
    return log


def written(folder: Path, table: dict[str, Any]) -> Path:
    path = folder / "log.json"
    path.write_text(json.dumps(table))
    return path


def test_both_names_of_the_arm_are_read(tmp_path: Path, table: dict[str, Any]) -> None:
    log = bam.read(written(tmp_path, table))
    assert log.arm_mass_kg == 0.02 and log.motor == "mx64" and len(log.time_s) == len(table["entries"])
    assert log.gravity_nm == pytest.approx((0.5 + 0.01) * 9.80665 * 0.15)
    other = {key: value for key, value in table.items() if key != "arm-mass"}
    assert bam.read(written(tmp_path, {**other, "arm_mass": 0.02})).inertia_kg_m2 == log.inertia_kg_m2
    assert bam.read(written(tmp_path, other)).arm_mass_kg == 0.0


def changed(key: str, value: Any) -> Callable[[dict[str, Any]], None]:
    return lambda table: table.__setitem__(key, value)


def removed(key: str) -> Callable[[dict[str, Any]], None]:
    return lambda table: table.pop(key)


def entry(key: str, value: Any) -> Callable[[dict[str, Any]], None]:
    return lambda table: table["entries"][7].__setitem__(key, value)


@pytest.mark.parametrize(
    ("change", "code", "field"),
    [
        (removed("mass"), "missing-field", "mass"),
        (removed("kp"), "missing-field", "kp"),
        (removed("motor"), "missing-field", "motor"),
        (removed("entries"), "missing-field", "entries"),
        (lambda table: table["entries"][7].pop("goal_position"), "missing-field", "entries[7].goal_position"),
        (lambda table: table["entries"][7].pop("torque_enable"), "missing-field", "entries[7].torque_enable"),
        (changed("length", "0.15"), "wrong-type", "length"),
        (changed("kp", True), "wrong-type", "kp"),
        (entry("torque_enable", 1), "wrong-type", "entries[7].torque_enable"),
        (entry("position", None), "wrong-type", "entries[7].position"),
        (changed("length", 0), "out-of-range", "length"),
        (changed("mass", -1), "out-of-range", "mass"),
        (entry("position", float("nan")), "out-of-range", "entries[7].position"),
        (entry("goal_position", float("inf")), "out-of-range", "entries[7].goal_position"),
        (entry("position", 90.0), "out-of-range", "entries[7].position"),
        (entry("timestamp", 0.0), "impossible-clock", "entries[7].timestamp"),
        (entry("timestamp", 60.0), "impossible-clock", "entries[7].timestamp"),
        (lambda table: table["entries"].__delitem__(slice(9, None)), "too-few-samples", "entries"),
    ],
)
def test_unusable_logs_are_refused(
    tmp_path: Path, table: dict[str, Any], change: Callable[[dict[str, Any]], None], code: str, field: str
) -> None:
    copy = json.loads(json.dumps(table))
    change(copy)
    path = written(tmp_path, copy)
    with pytest.raises(PinswitchError) as refused:
        bam.read(path)
    assert (refused.value.code, refused.value.field, refused.value.file) == (code, field, str(path))
    assert refused.value.help


@pytest.mark.parametrize("text", ["", "[1, 2]", '"log"', "{", "\xff"])
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "log.json"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(PinswitchError) as refused:
        bam.read(path)
    assert refused.value.code in {"damaged-file", "other-kind-of-file", "not-utf-8"}


def test_truncated_logs_name_the_place(tmp_path: Path, table: dict[str, Any]) -> None:
    path = tmp_path / "log.json"
    path.write_text(json.dumps(table, indent=1)[:-200])
    with pytest.raises(PinswitchError) as refused:
        bam.read(path)
    assert refused.value.code == "damaged-file" and (refused.value.line or 0) > 100
    with pytest.raises(PinswitchError) as refused:
        bam.read(tmp_path / "absent.json")
    assert refused.value.code == "cannot-read"


def test_unsuitable_logs_are_not_identified(tmp_path: Path, table: dict[str, Any]) -> None:
    log = bam.read(written(tmp_path, table))
    unknown = bam.read(written(tmp_path, {**table, "motor": "other"}))
    current = bam.read(written(tmp_path, {key: value for key, value in table.items() if key != "vin"}))
    refusals: list[tuple[list[bam.Log], str]] = [
        ([], "missing-field"),
        ([log, unknown], "conflicting-settings"),
        ([unknown], "unknown-name"),
        ([current], "missing-field"),
    ]
    for given, code in refusals:
        with pytest.raises(PinswitchError) as refused:
            bam.identify(given)
        assert refused.value.code == code


def test_a_copy_of_a_log_is_no_evidence(rig: ModuleType, tmp_path: Path) -> None:
    runs = logs(rig, tmp_path, servo(rig, 0, load=0.0), 0, runs=RUNS[:2])
    with pytest.raises(PinswitchError, match="duplicate-entry"):
        bam.identify([*runs, runs[0]])
    with pytest.raises(PinswitchError, match="step_s"):
        bam.identify(runs, step_s=0.0)


def test_one_log_attributes_nothing(rig: ModuleType, tmp_path: Path) -> None:
    """No other log can confirm that the dependence predicts better."""
    run = logs(rig, tmp_path, servo(rig, 0, load=0.1), 0, runs=RUNS[:1])
    assert bam.identify(run, step_s=STEP_S).verdict != "attributed"
