"""Recovery of the friction of simulated servos by pinswitch.bam: intervals that contain the truth, and false reports.

``python benches/servo_recovery.py [SEEDS]`` [default: 30] prints the table of cad/doc/robots.md. The logs are those of the
simulator in examples/servo.py; motor and friction vary with the seed.
"""

from __future__ import annotations

import importlib.util
import json
import sys
import tempfile
import time
from collections import Counter, defaultdict
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from pinswitch import bam

#: Masses in kg, gains and trajectories of the runs of a servo; a light arm that moves slowly decides nothing.
RUNS = [(mass, kp, name) for mass in (0.5, 1.5) for kp, name in ((8, "sin_sin"), (16, "lift_and_drop"))]
LIGHT = [(0.02, kp, "slow") for kp in (8, 32)]
#: Constants of the simulator and of the identification.
NAMES = {
    "load": "load",
    "base": "base_nm",
    "viscous": "viscous_nm_s",
    "stribeck": "stribeck_nm",
    "gain": "gain_nm_v",
    "kt": "kt_v_s",
    "armature": "armature_kg_m2",
}


def simulator() -> ModuleType:
    """Load the simulator of the example."""
    path = Path(__file__).parents[1] / "examples" / "servo.py"
    spec = importlib.util.spec_from_file_location("servo", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def constants(seed: int, is_dependent: bool) -> dict[str, float]:
    """Draw motor and friction of a servo."""
    random = np.random.default_rng(seed)
    return {
        "gain": 0.45 * float(np.exp(0.2 * random.standard_normal())),
        "kt": 1.6 * float(np.exp(0.1 * random.standard_normal())),
        "armature": 0.012 * float(np.exp(0.3 * random.standard_normal())),
        "base": random.uniform(0.03, 0.15),
        "viscous": random.uniform(0.0, 0.03),
        "stribeck": float(random.choice([0.0, 0.02, 0.05])),
        "load": random.uniform(0.02, 0.25) if is_dependent else 0.0,
    }


def slow(name: str, t: float) -> tuple[float, bool]:
    """Return the goal of a slow motion around the arm's rest."""
    return 0.3 * float(np.sin(1.5 * t)), True


def study(rig: ModuleType, seeds: int, is_dependent: bool, is_light: bool) -> str:
    """Return a row of the table."""
    verdicts: Counter[str] = Counter()
    covered: dict[str, list[bool]] = defaultdict(list)
    errors, seconds = [], []
    options: dict[str, Any] = {"path": slow} if is_light else {}
    for seed in range(seeds):
        true = constants(seed, is_dependent)
        with tempfile.TemporaryDirectory() as folder:
            logs = []
            for i, run in enumerate(LIGHT if is_light else RUNS):
                path = Path(folder) / f"{i}.json"
                path.write_text(json.dumps(rig.record(run, 1000 * seed + i, true, **options)), encoding="utf-8")
                logs.append(bam.read(path))
        start = time.process_time()
        friction = bam.identify(logs)
        seconds.append(time.process_time() - start)
        verdicts[friction.verdict] += 1
        errors.append(friction.constants["load"].value - true["load"])
        for name, found in NAMES.items():
            interval = friction.constants[found]
            covered[name].append(interval.low <= true[name] <= interval.high)
        print(seed, friction.verdict, friction.constants["load"], true["load"], file=sys.stderr, flush=True)
    shares = ", ".join(f"{name} {100 * np.mean(inside):.0f}" for name, inside in covered.items())
    counts = ", ".join(f"`{verdict}` {count}" for verdict, count in verdicts.most_common())
    kind = f"{'light arm, ' if is_light else ''}load {'0.02 to 0.25' if is_dependent else '0'}"
    return f"| {kind} | {counts} | {np.sqrt(np.mean(np.square(errors))):.4f} | {shares} | {np.median(seconds):.1f} |"


def main() -> None:
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 30
    rig = simulator()
    print("| servos | verdicts | RMS error of load | intervals with the truth, % | s |")
    print("| --- | --- | --- | --- | --- |")
    for is_dependent, is_light in ((True, False), (False, False), (True, True)):
        print(study(rig, seeds, is_dependent, is_light), flush=True)


if __name__ == "__main__":
    main()
