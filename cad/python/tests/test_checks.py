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
from pinswitch import PinswitchError, bam
from pinswitch.mujoco import Surface

EXAMPLES = Path(__file__).parents[3] / "model" / "doc" / "examples"
CAPSTAN = str(EXAMPLES / "capstan.csv")
ROW: dict[str, Any] = {"shell.width_mm": [13.0]}


def _effect(act: Callable[[Any, Any], object]) -> object:
    @pinswitch.effect(side="rig", covariate="load", acts_on="reading", combine="factor")
    def strange(row: Any, k: Any = pinswitch.size(0.1)) -> Any:
        return act(row, k)

    return strange


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
    ("logs as words", "wrong-type", lambda: bam.identify(["x.json"])),  # type: ignore[list-item]
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
    ("loads in two lists", "wrong-type", lambda: pinswitch.predict("three-double", [[1, 2], [3, 4]])),
    ("law as a number", "wrong-type", lambda: pinswitch.predict("three-double", law=3)),  # type: ignore[call-overload]
    ("model as a number", "wrong-type", lambda: pinswitch.predict("three-double", model=3)),
    ("shard as a number", "wrong-type", lambda: pinswitch.batch("a.toml", "out", shard=5)),  # type: ignore[arg-type]
    ("sweep as a mapping", "wrong-type", lambda: pinswitch.batch({"axes": {}}, "out")),  # type: ignore[arg-type]
    ("wall as a word", "wrong-type", lambda: pinswitch.check(CAPSTAN, min_wall_mm="a")),  # type: ignore[arg-type]
    ("frame as a file", "wrong-type", lambda: pinswitch.read(pandas.DataFrame())),  # type: ignore[arg-type]
    ("list of files", "wrong-type", lambda: pinswitch.read([CAPSTAN])),  # type: ignore[arg-type]
    ("servo as a word", "wrong-type", lambda: bam.identify([], servo="mx64")),  # type: ignore[arg-type]
    ("step beyond the readings", "out-of-range", lambda: bam.identify([], step_s=10)),
    ("effect without a result", "formula-syntax", lambda: _effect(lambda row, k: None)),
    ("effect of an array", "formula-syntax", lambda: _effect(lambda row, k: k * np.array([1.0, 2.0]))),
    ("effect of a text", "formula-syntax", lambda: _effect(lambda row, k: "k")),
    ("calibration as a word", "wrong-type", lambda: pinswitch.experiment("cal")),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("name", "code", "call"), REFUSED, ids=[name for name, _, _ in REFUSED])
def test_arguments_are_refused_with_a_code(name: str, code: str, call: Callable[[], object]) -> None:
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
    assert [one["rows"] for one in both.report["sessions"]] == [len(session), len(session) + len(later)]


def test_missing_values_of_frames_are_missing(config: pinswitch.Config, session: pinswitch.Simulation) -> None:
    frame = session.to_pandas().convert_dtypes()
    frame["dwell_s"] = frame["dwell_s"].astype("Float64").where(frame.index > 3)
    assert len(pinswitch.calibrate(frame).residuals) == len(session)
    rows = pandas.DataFrame({"shell.width_mm": pandas.array([13.0, None], dtype="Float64")})
    curves = pinswitch.predict_table(rows, config)
    assert curves["shell.width_mm"].dtype == np.float64 and np.isnan(curves["shell.width_mm"][-1])
    lazy = pinswitch.predict(polars.LazyFrame({"shell.width_mm": [13.0]}))  # type: ignore[call-overload]
    assert isinstance(lazy, pinswitch.CurveTable)


def test_blocks_of_curves_have_the_same_columns(config: pinswitch.Config) -> None:
    predicted = pinswitch.predict_table({"shell.width_mm": [12.5, 13.0]}, config)
    mixed = pinswitch.predict_table({"shell.width_mm": [12.5, 1300.0]}, config)
    refused = pinswitch.predict_table({"shell.width_mm": [1200.0, 1300.0]}, config)
    whole = polars.concat([polars.DataFrame(block) for block in (predicted, mixed, refused)])
    assert len(whole) == 2 * 21 + 21 + 1 + 2
    assert pyarrow.concat_tables([pyarrow.table(predicted), pyarrow.table(refused)]).num_rows == 44


def test_whole_numbers_stay_whole() -> None:
    table = pinswitch.read_csv("load_mass_g,force_N\n500,1.25\n,2\n")
    assert table.to_csv() == "load_mass_g,force_N\n500,1.25\n,2\n"


def test_progress_is_shown(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    pinswitch.calibrate(pinswitch.read(CAPSTAN), progress=True)
    assert "calibrating: done in" in capsys.readouterr().err


def test_a_plan_is_saved_for_the_next_steps(calibration: pinswitch.Calibration, tmp_path: Path) -> None:
    plan = calibration.experiment(20)
    plan.save(tmp_path / "next")
    assert sorted(f.name for f in (tmp_path / "next").iterdir()) == ["experiment.json", "next-runs.csv", "run-sheet.html"]
    assert (tmp_path / "next" / "next-runs.csv").read_text() == plan.runs


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
