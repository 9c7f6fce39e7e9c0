"""Curves of one configuration and of tables."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import pinswitch
from pinswitch import PinswitchError


def test_curves_are_arrays(config: pinswitch.Config) -> None:
    curve = pinswitch.predict(config)
    assert curve.friction_n.dtype == np.float64 and curve.friction_n.shape == (21,)
    assert np.allclose(curve.friction_n, (curve.concentric_n - curve.eccentric_n) / 2)
    assert np.all(curve.band_low_n < curve.friction_n) and np.all(curve.friction_n < curve.band_high_n)
    assert (curve.law, curve.status) == ("physics", "published")
    assert curve.threshold_n is not None and curve.threshold_band_n is not None
    low, high = curve.threshold_band_n
    assert low < curve.threshold_n < high
    assert set(curve.other_laws) == {"layout", "paper"}


def test_loads_and_laws_are_chosen(config: pinswitch.Config) -> None:
    full = pinswitch.predict(config)
    chosen = pinswitch.predict(config, [full.load_n[3], full.load_n[20]], law="layout")
    expected = pinswitch.predict(config, law="layout")
    assert np.allclose(chosen.friction_n, expected.friction_n[[3, 20]], rtol=1e-12)
    assert full.friction_at(full.load_n[5]) == full.friction_n[5] and np.isnan(full.friction_at(1e3))


@pytest.mark.parametrize("loads", [[], [0.0], [-1.0, 2.0], [2.0, 1.0], [1.0, 1.0], [np.nan], [np.inf]])
def test_invalid_loads_are_refused(config: pinswitch.Config, loads: list[float]) -> None:
    with pytest.raises(PinswitchError) as caught:
        pinswitch.predict(config, loads)
    assert caught.value.field == "loads_n"


def test_unknown_laws_are_refused(config: pinswitch.Config) -> None:
    with pytest.raises(PinswitchError, match="unknown friction law"):
        pinswitch.predict(config, law="coulomb")


def test_frames_take_tables_by_arrow(config: pinswitch.Config) -> None:
    curve = pinswitch.predict(config)
    for frame in (curve.to_pandas(), curve.to_polars(), pyarrow.table(curve), pandas.DataFrame(dict(curve))):
        assert np.array_equal(np.asarray(frame["friction_N"]), curve.friction_n)
    texts = pinswitch.Table({"a": np.array(["x", None], dtype=object), "b": np.array([1, 2])})
    assert polars.DataFrame(texts).rows() == [("x", 1), (None, 2)]
    numbers = pinswitch.Table({"a": np.array([1.5, np.nan])})
    assert polars.DataFrame(numbers).rows() == [(1.5,), (None,)]


INPUTS: list[Any] = [
    {"layout.pins": [[5, 8, 11], [4, 8, 12]], "shell.width_mm": [13.0, 14.5]},
    [{"layout.pins": [5, 8, 11], "shell.width_mm": 13.0}, {"layout.pins": [4, 8, 12], "shell.width_mm": 14.5}],
    pandas.DataFrame({"layout.pins": [[5, 8, 11], [4, 8, 12]], "shell.width_mm": [13.0, 14.5]}),
    polars.DataFrame({"layout.pins": [[5, 8, 11], [4, 8, 12]], "shell.width_mm": [13.0, 14.5]}),
    pyarrow.table({"layout.pins": [[5, 8, 11], [4, 8, 12]], "shell.width_mm": [13.0, 14.5]}),
]


@pytest.mark.parametrize("table", INPUTS, ids=["columns", "rows", "pandas", "polars", "pyarrow"])
def test_frames_of_configurations_are_predicted(config: pinswitch.Config, table: Any) -> None:
    curves = pinswitch.predict_table(table, config)
    assert len(curves) == 42 and set(curves["status"]) == {"predicted"}
    second = pinswitch.predict(config.replace({"layout.pins": [4, 8, 12], "shell.width_mm": 14.5}))
    of_second = curves.filter(curves["row"] == 2)
    assert np.array_equal(of_second["friction_N"], second.friction_n)
    assert set(of_second["layout.pins"]) == {"[4, 8, 12]"} and of_second["threshold_N"][0] == second.threshold_n


def test_tables_equal_the_command_line(config: pinswitch.Config, tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    file.write_text('layout.pins,shell.width_mm\n"[5, 8, 11]",13\n"[5]",999\n')
    curves = pinswitch.predict_table(file, config)
    assert curves.columns[:4] == ["row", "layout.pins", "shell.width_mm", "status"]
    assert len(curves.predicted) == 21 and len(curves.refused) == 1
    assert "outside" in curves.refused["reason"][0] and np.isnan(curves.refused["load_N"][0])


def test_a_source_is_as_good_as_a_configuration(tmp_path: Path) -> None:
    config = pinswitch.Config("three-double")
    config.save(tmp_path / "mine.toml")
    loads = [10.0, 40.0]
    expected = pinswitch.predict(config, loads).friction_n
    for source in ("three-double", tmp_path / "mine.toml", config.to_dict(), {"layout.pins": [5, 8, 11]}):
        assert np.array_equal(pinswitch.predict(source, loads).friction_n, expected)
    assert pinswitch.build("three-double").names == pinswitch.build(config).names
    for wrong in (3, None, b"three-double"):
        with pytest.raises(PinswitchError, match="not a configuration"):
            pinswitch.predict(wrong)  # type: ignore[call-overload]
    with pytest.raises(PinswitchError, match="no such file or template"):
        pinswitch.predict("three-duoble")
    with pytest.raises(PinswitchError, match="not numbers"):
        pinswitch.predict(config, ["heavy"])  # type: ignore[list-item]


@pytest.mark.parametrize("frame", INPUTS[2:], ids=["pandas", "polars", "pyarrow"])
def test_a_frame_is_predicted_row_by_row(frame: Any) -> None:
    curves = pinswitch.predict(frame)
    assert isinstance(curves, pinswitch.CurveTable)
    assert curves.to_csv() == pinswitch.predict_table(frame, pinswitch.Config()).to_csv()
    with pytest.raises(PinswitchError, match="for one configuration"):
        pinswitch.predict(frame, [10.0])  # type: ignore[call-overload]


def test_frames_of_other_kinds(config: pinswitch.Config) -> None:
    frame = polars.DataFrame({"shell.width_mm": [13.0, 14.5]})
    lazy, eager = (pinswitch.predict_table(table, config) for table in (frame.lazy(), frame))
    assert np.array_equal(lazy["friction_N"], eager["friction_N"])
    twice = pandas.DataFrame([[13.0, 14.0]], columns=["shell.width_mm", "shell.width_mm"])
    with pytest.raises(PinswitchError, match="two columns have the same name"):
        pinswitch.predict_table(twice, config)
    for wrong in (3, None, [1, 2], ["shell.width_mm"]):
        with pytest.raises(PinswitchError, match="is not a table"):
            pinswitch.predict_table(wrong, config)


def test_curves_are_read_only_and_pickled(config: pinswitch.Config) -> None:
    changed = config.replace(shell__width_mm=14.0)
    curve = pinswitch.predict(changed, [5.0, 20.0], law="layout")
    changed.layout.pins = [5]
    with pytest.raises(ValueError, match="read-only"):
        curve.friction_n[0] = 99
    restored = pickle.loads(pickle.dumps(curve))
    assert all(np.array_equal(restored[name], curve[name]) for name in curve.columns)
    assert (restored.law, restored.status, restored.reasons) == (curve.law, curve.status, curve.reasons)


def test_invalid_tables_are_refused(config: pinswitch.Config) -> None:
    with pytest.raises(PinswitchError, match="shell.widht_mm"):
        pinswitch.predict_table({"shell.widht_mm": [1]}, config)
    with pytest.raises(PinswitchError, match="no rows"):
        pinswitch.predict_table({"shell.width_mm": []}, config)
    with pytest.raises(PinswitchError, match="cannot read"):
        pinswitch.predict_table("absent.csv", config)


def test_other_threads_run_during_a_prediction(config: pinswitch.Config) -> None:
    ticks: list[float] = []
    is_done = threading.Event()

    def tick() -> None:
        while not is_done.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    pinswitch.predict_table({"shell.width_mm": np.linspace(12, 16, 2000)}, config.replace(friction__points=101))
    end = time.monotonic()
    is_done.set()
    thread.join()
    during = [t for t in ticks if start < t < end]
    assert max(np.diff([start, *during, end])) < 0.5 * (end - start) or end - start < 0.05


LONG = """
import sys, pinswitch
print("ready", flush=True)
try:
    rows = {"shell.width_mm": [12 + 1e-6 * i for i in range(200_000)]}
    pinswitch.predict_table(rows, pinswitch.Config("three-double"))
except KeyboardInterrupt:
    sys.exit(7)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
def test_control_c_ends_a_long_call() -> None:
    process = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, env=dict(os.environ))
    assert process.stdout is not None and process.stdout.readline() == b"ready\n"
    time.sleep(2.0)
    assert process.poll() is None, "the call is too short for this test"
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=10) == 7
    process.stdout.close()


def test_progress_is_reported(config: pinswitch.Config) -> None:
    from pinswitch import _pinswitch

    seen: list[tuple[int, int]] = []
    rows = b"shell.width_mm\n" + b"\n".join(b"13" for _ in range(50))
    _pinswitch.predict_rows(config._native, rows, "rows", progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (50, 50)


def test_curves_are_drawn(config: pinswitch.Config) -> None:
    import matplotlib

    matplotlib.use("Agg")
    curve = pinswitch.predict(config)
    assert curve.plot().get_ylabel() == "friction, N"
    assert curve._repr_html_().count("<svg") == 1 and curve.to_csv().startswith("load_N,")
