"""A user-defined effect: creep of a load cell, whose reading grows with the dwell."""

from __future__ import annotations

from typing import Any

import numpy as np

import pinswitch


@pinswitch.effect(side="rig", covariate="dwell", acts_on="reading", combine="factor", confused_with=["dwell_relaxation"])
def cell_creep(row: Any, k: Any = pinswitch.size(0.02)) -> Any:
    """Return the relative change of a reading."""
    return k * np.log(row.dwell_s / 3)


session = pinswitch.simulate(randomised=True, acting={"cell_creep": 0.03}, effects=[cell_creep], seed=5)
calibration = pinswitch.calibrate(session, effects=[cell_creep])
print(calibration)
for name, (value, low, high) in calibration.intervals.items():
    print(f"{name} = {value:.4g} [{low:.4g}, {high:.4g}]")
