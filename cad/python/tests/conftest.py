"""Fixtures that several files share."""

from __future__ import annotations

import pytest

import pinswitch


@pytest.fixture(scope="session")
def config() -> pinswitch.Config:
    return pinswitch.Config("three-double", friction__points=21)


@pytest.fixture(scope="session")
def session() -> pinswitch.Simulation:
    """A session with a known effect of the rig."""
    return pinswitch.simulate(randomised=True, acting={"load_cell_offset": 0.8}, seed=3)


@pytest.fixture(scope="session")
def calibration(session: pinswitch.Simulation) -> pinswitch.Calibration:
    return pinswitch.calibrate(session)
