"""Arguments out of range or of a wrong type, and files that cannot be written, are errors with a code."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import pinswitch
from pinswitch import PinswitchError
from pinswitch.mujoco import Surface

EXAMPLES = Path(__file__).parents[3] / "model" / "doc" / "examples"
CAPSTAN = str(EXAMPLES / "capstan.csv")
ROW: dict[str, Any] = {"shell.width_mm": [13.0]}

REFUSED: list[tuple[str, str, Callable[[], object]]] = [
    ("seed -1", "out-of-range", lambda: pinswitch.simulate(seed=-1)),
    ("seed 2^70", "out-of-range", lambda: pinswitch.simulate(seed=2**70)),
    ("seed 1.5", "wrong-type", lambda: pinswitch.simulate(seed=1.5)),  # type: ignore[arg-type]
    ("runs 0", "out-of-range", lambda: pinswitch.power(runs=0)),
    ("runs -1", "out-of-range", lambda: pinswitch.power(runs=-1)),
    ("bodies -1", "out-of-range", lambda: pinswitch.check(CAPSTAN, bodies=-1)),
    ("design seed", "out-of-range", lambda: pinswitch.design({"targets": {"threshold_n": 24}}, seed=-1)),
    ("design best", "out-of-range", lambda: pinswitch.design({"targets": {"threshold_n": 24}}, best=0)),
    ("threads -1", "out-of-range", lambda: pinswitch.predict_table(ROW, threads=-1)),
    ("threads 10^6", "out-of-range", lambda: pinswitch.predict_table(ROW, threads=10**6)),
    ("fit_below 3", "out-of-range", lambda: pinswitch.calibrate(CAPSTAN, fit_below=3)),
    ("fit_below NaN", "wrong-type", lambda: pinswitch.calibrate(CAPSTAN, fit_below=math.nan)),
    ("targets 5", "wrong-type", lambda: pinswitch.design({"targets": 5})),
    ("set as a list", "wrong-type", lambda: pinswitch.read(CAPSTAN, set=["a=b"])),  # type: ignore[arg-type]
    ("acting as a list", "wrong-type", lambda: pinswitch.simulate(acting=["x"])),  # type: ignore[arg-type]
    ("acting as a word", "wrong-type", lambda: pinswitch.simulate(acting={"coating_ploughing": "x"})),
    ("logs as words", "wrong-type", lambda: pinswitch.bam.identify(["x.json"])),  # type: ignore[attr-defined]
    ("curve as a word", "wrong-type", lambda: Surface.of_curve("three-double")),  # type: ignore[arg-type]
    ("effects as words", "wrong-type", lambda: pinswitch.effect_file(["x"])),  # type: ignore[list-item]
    ("size as a word", "wrong-type", lambda: pinswitch.size("a")),  # type: ignore[arg-type]
    ("series", "wrong-type", lambda: pinswitch.predict(pandas.Series([1, 2]))),
    ("chunked array", "wrong-type", lambda: pinswitch.predict(pyarrow.chunked_array([[1]]))),
    ("ragged CSV", "wrong-type", lambda: pinswitch.read_csv("a,b\n1\n")),
    ("unequal columns", "wrong-type", lambda: pinswitch.predict_table({**ROW, "pins.diameter_mm": [1.0, 1.1]})),
    ("column twice", "duplicate-entry", lambda: pinswitch.predict_table(
        pyarrow.Table.from_arrays([pyarrow.array([12.0]), pyarrow.array([13.0])], names=["shell.width_mm"] * 2))),
    ("law and model", "conflicting-settings", lambda: pinswitch.predict("three-double", law="paper", model="m.toml")),
    ("law and model of a table", "conflicting-settings",
     lambda: pinswitch.predict_table(ROW, law="paper", model="m.toml")),
    ("calibration as a word", "wrong-type", lambda: pinswitch.experiment("cal")),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("name", "code", "call"), REFUSED, ids=[name for name, _, _ in REFUSED])
def test_arguments_are_refused_with_a_code(name: str, code: str, call: Callable[[], object]) -> None:
    import pinswitch.bam  # noqa: F401

    with pytest.raises(PinswitchError) as caught:
        call()
    assert caught.value.code == code and caught.value.help


def test_what_cannot_be_written_is_one_kind_of_error(
    tmp_path: Path, config: pinswitch.Config, calibration: pinswitch.Calibration
) -> None:
    file = tmp_path / "file"
    file.write_text("mine")
    curve = pinswitch.predict(config)
    for act in (config.save, calibration.model.save, curve.save, pinswitch.build(config).save, calibration.save):
        with pytest.raises(PinswitchError) as caught:
            act(file / "x")
        assert caught.value.code == "cannot-write"
    assert file.read_text() == "mine"


def test_a_calibration_refuses_impossible_plans(calibration: pinswitch.Calibration) -> None:
    for minutes in (math.nan, math.inf, 0, -5, 1e9, "a"):
        with pytest.raises(PinswitchError):
            calibration.experiment(minutes)  # type: ignore[arg-type]
    with pytest.raises(PinswitchError):
        calibration.draws(-1)
    assert calibration.draws(0)["mu_s"].shape == (0,)
    direct, method = pinswitch.experiment(calibration, 30), calibration.experiment(30)
    assert direct.runs == method.runs and direct.report["minutes"] <= 30


def test_frames_are_sessions(session: pinswitch.Simulation) -> None:
    later = pinswitch.simulate(randomised=True, acting={"load_cell_offset": 0.8}, seed=3, next=True)
    both = pinswitch.calibrate(session, later)
    assert len(both.residuals) == len(session) + len(later)


def test_missing_values_of_frames_are_missing(config: pinswitch.Config, session: pinswitch.Simulation) -> None:
    frame = session.to_pandas().convert_dtypes()
    frame["dwell_s"] = frame["dwell_s"].astype("Float64").where(frame.index > 3)
    assert len(pinswitch.calibrate(frame).residuals) == len(session)
    rows = pandas.DataFrame({"shell.width_mm": pandas.array([13.0, None], dtype="Float64")})
    curves = pinswitch.predict_table(rows, config)
    assert curves["shell.width_mm"].dtype == np.float64 and np.isnan(curves["shell.width_mm"][-1])
    lazy = pinswitch.predict(polars.LazyFrame({"shell.width_mm": [13.0]}))  # type: ignore[call-overload]
    assert isinstance(lazy, pinswitch.CurveTable)


def test_a_request_takes_numbers_of_numpy() -> None:
    targets = {"threshold_n": np.float64(24.0), "max_friction_n": f"at most {np.float32(9.0)}"}
    assert pinswitch.design({"targets": targets}, best=1, draws=np.int64(100)).is_possible


def test_threads_share_a_configuration() -> None:
    config = pinswitch.Config("three-double", friction__points=3)
    errors: list[Exception] = []

    def work() -> None:
        try:
            for i in range(30):
                config.shell.width_mm = 12 + i % 3
                pinswitch.predict(config, [10, 20])
        except Exception as error:  # noqa: BLE001
            errors.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors


def test_a_saved_calibration_is_a_data_package(calibration: pinswitch.Calibration, tmp_path: Path) -> None:
    import hashlib
    import json

    calibration.save(tmp_path)
    package = json.loads((tmp_path / "datapackage.json").read_text())
    listed = {one["path"]: one for one in package["resources"]}
    assert set(listed) | {"datapackage.json"} == {file.name for file in tmp_path.iterdir()}
    for name, one in listed.items():
        content = (tmp_path / name).read_bytes()
        assert one["hash"] == f"sha256:{hashlib.sha256(content).hexdigest()}" and one["bytes"] == len(content)
