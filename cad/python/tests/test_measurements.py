"""Imports, logs, simulations, effects and calibrations."""

from __future__ import annotations

import gzip
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pinswitch
from pinswitch import PinswitchError

EXAMPLES = Path(__file__).parents[3] / "model" / "doc" / "examples"


def test_files_of_a_laboratory_are_read(tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    file.write_bytes("Last [kg];F_heben [N];F_senken [N]\n1,5;19,25;11,2\n2;25,1;14,9\n".encode("latin-1"))
    table = pinswitch.read(file)
    assert table.kind == "table" and len(table) == 4
    assert table["load_N"][0] == pytest.approx(1.5 * 9.80665) and table["direction"][0] == "concentric"
    assert table.understanding["files"][0]["decimal"] == "comma" and "comma" in table.map
    (tmp_path / "rig.csv.gz").write_bytes(gzip.compress(file.read_bytes()))
    assert np.array_equal(pinswitch.read(tmp_path / "rig.csv.gz")["force_N"], table["force_N"])


def test_ambiguous_files_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    file.write_text("Load;F_up [N];F_down [N]\n1;19;11\n2;25;14\n")
    with pytest.raises(PinswitchError) as caught:
        pinswitch.read(file)
    assert "unit.Load" in (caught.value.help or "")
    assert pinswitch.read(file, set={"unit.Load": "kg"})["load_N"][0] == pytest.approx(9.80665)


def test_folders_are_read_in_natural_order(tmp_path: Path) -> None:
    for grams in (500, 1500, 10000):
        text = "direction,force_N\nup,{}\ndown,{}\n".format(grams / 80, grams / 130)
        (tmp_path / f"{grams}g.csv").write_text(text)
    table = pinswitch.read(tmp_path, pattern="{load_g}g.csv")
    assert table["load_mass_g"].tolist() == sorted(table["load_mass_g"].tolist()) and len(table) == 6
    with pytest.raises(PinswitchError, match="cannot read"):
        pinswitch.read(tmp_path / "absent.csv")


def test_calibrations_attribute_an_effect(calibration: pinswitch.Calibration) -> None:
    assert calibration.verdict == "attributed" and list(calibration.effects) == ["load_cell_offset"]
    value, low, high = calibration.intervals["load_cell_offset.b"]
    assert low < 0.8 < high and value == pytest.approx(0.8, abs=0.05)
    assert next(iter(calibration.probabilities)) == "load_cell_offset"
    assert calibration.report["augmented"]["heldout_rmse_N"] < calibration.report["baseline"]["heldout_rmse_N"]
    error = calibration.expected_error_n
    assert error is not None and 0 < error < 1


@pytest.mark.parametrize("convert", [pinswitch.Table.to_pandas, pinswitch.Table.to_polars, lambda table: table])
def test_models_predict_frames(
    calibration: pinswitch.Calibration, session: pinswitch.Simulation, convert: Any
) -> None:
    predicted, sd = calibration.predict(convert(session), fitted_session=True)
    assert predicted.shape == sd.shape == (len(session),)
    assert np.abs(predicted - session["force_N"]).mean() < 3 * sd.mean()
    residuals = calibration.residuals
    model, baseline = (np.sqrt(np.mean(residuals[f"residual_{name}_N"] ** 2)) for name in ("model", "baseline"))
    assert model < 0.5 * baseline


def test_draws_follow_the_intervals(calibration: pinswitch.Calibration) -> None:
    draws = calibration.draws(4000, seed=2)
    value, low, high = calibration.intervals["load_cell_offset.b"]
    quantiles = np.quantile(draws["load_cell_offset.b"], [0.025, 0.5, 0.975])
    assert quantiles == pytest.approx([low, value, high], abs=0.1 * (high - low))
    assert np.array_equal(calibration.draws(5, seed=2)["mu_s"], draws["mu_s"][:5])


def test_calibrations_are_saved_and_read(calibration: pinswitch.Calibration, tmp_path: Path) -> None:
    calibration.save(tmp_path)
    model = pinswitch.Model.load(tmp_path / "model.toml")
    assert model.constants == calibration.model.constants
    config = pinswitch.Config("three-double")
    curve = pinswitch.predict(config, [20.0, 40.0], model=tmp_path / "model.toml")
    assert curve.law == "calibrated" and np.array_equal(curve.friction_n, calibration.curve(config, [20, 40]).friction_n)
    assert "<svg" in calibration.to_html() and "load_cell_offset" in calibration._repr_html_()
    (tmp_path / "model.toml").write_text("schema = 1")
    with pytest.raises(PinswitchError):
        pinswitch.Model.load(tmp_path / "model.toml")


def test_experiments_are_planned(calibration: pinswitch.Calibration) -> None:
    plan = calibration.experiment(30)
    assert plan.runs.startswith("run,") or "," in plan.runs.splitlines()[0]
    assert "<html" in plan.sheet and plan.report["minutes"] <= 30
    with pytest.raises(PinswitchError):
        calibration.experiment(0)


@pinswitch.effect(side="rig", covariate="dwell", acts_on="reading", combine="factor", confused_with=["dwell_relaxation"])
def cell_creep(row: Any, k: Any = pinswitch.size(0.02)) -> Any:
    return k * np.log(row.dwell_s / 3)


def test_effects_are_functions(tmp_path: Path) -> None:
    assert cell_creep.formula == "k * ln((dwell_s / 3.0))"
    session = pinswitch.simulate(randomised=True, acting={"cell_creep": 0.03}, effects=[cell_creep], seed=5)
    calibration = pinswitch.calibrate(session, effects=[cell_creep])
    effect = calibration.effects.get("cell_creep") or calibration.effects["dwell_relaxation"]
    assert effect["probability"] > 0.5
    ids = {*calibration.effects, *(rival["id"] for rival in effect["rivals"])}
    assert "cell_creep" in ids
    file = tmp_path / "creep.toml"
    file.write_text(pinswitch.effect_file([cell_creep]))
    again = pinswitch.calibrate(session, effects=[file])
    assert again.report["effects"] == calibration.report["effects"]


def test_formulas_have_the_value_of_the_function() -> None:
    """The formula, evaluated by Python, equals the function on arrays."""

    def function(row: Any, a: Any = pinswitch.size(0.1), w: Any = pinswitch.shape(8, 3, 30, "%")) -> Any:
        return -a * np.exp(-(((row.speed_pct - 50) / w) ** 2)) * np.maximum(row.speed_pct > 20, 0.5)

    made = pinswitch.effect(side="switch", covariate="speed", acts_on="mu", combine="factor")(function)
    speed = np.linspace(5, 100, 7)
    row = type("Row", (), {"speed_pct": speed})()
    names = {"speed_pct": speed, "a": 0.3, "w": 9.0, "exp": np.exp, "max": np.maximum}
    by_formula = eval(made.formula.replace("^", "**"), {"__builtins__": {}}, names)
    assert np.allclose(by_formula, function(row, 0.3, 9.0))


@pytest.mark.parametrize(
    ("function", "problem"),
    [
        (lambda row, k=pinswitch.size(1.0): k if row.time > 0.5 else 0, "decides with if"),
        (lambda row, k=pinswitch.size(1.0): k * __import__("math").exp(row.time), "converts a value"),
        (lambda row, k=pinswitch.size(1.0): k * np.arctan(row.time), "no counterpart of numpy.arctan"),
        (lambda row, k=1.0: k * row.time, "no constant as its default"),
        (lambda row, k=pinswitch.size(1.0), j=pinswitch.size(1.0): (k + j) * row.time, "not identifiable"),
        (lambda row, k=pinswitch.size(1.0, "s"): k * row.time, "unit"),
    ],
)
def test_invalid_effects_are_refused(function: Any, problem: str) -> None:
    with pytest.raises(PinswitchError, match=problem):
        pinswitch.effect(side="rig", covariate="time", acts_on="reading", combine="factor", id="wrong")(function)


def test_logs_are_segmented(tmp_path: Path) -> None:
    import shutil
    import subprocess

    command = shutil.which("pinswitch")
    if command is None:
        pytest.skip("the command line makes the logs")
    subprocess.run([command, "simulate", "--raw", "--out", str(tmp_path)], check=True)
    table = pinswitch.segment(tmp_path / "run.toml", figures=False)
    assert len(table) > 100 and table.report["series"]


def test_power_lists_every_effect(tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_text("layouts = []\nproxy = false\nrepetitions = [4, 4]\nrepetitions_spread = 0\n")
    rates = pinswitch.power(plan, runs=1)
    assert len(rates) > 20 and all(r["named"] + r["ambiguous"] + r["missed"] <= r["runs"] for r in rates)


def test_invalid_tables_have_a_line() -> None:
    rows = pinswitch.simulate(seed=1).to_csv().splitlines()
    rows[2] = rows[2].replace("silicone", "sillicone").replace("proxy", "sillicone")
    with pytest.raises(PinswitchError) as caught:
        pinswitch.calibrate(pinswitch.read_csv("\n".join(rows) + "\n"))
    assert caught.value.line == 3


def test_models_are_pickled_and_calibrations_say_why_not(calibration: pinswitch.Calibration) -> None:
    restored = pickle.loads(pickle.dumps(calibration.model))
    assert restored.text == calibration.model.text and restored.constants == calibration.model.constants
    with pytest.raises(TypeError, match="pickle its model"):
        pickle.dumps(calibration)


def test_arviz_takes_the_draws(calibration: pinswitch.Calibration) -> None:
    arviz = pytest.importorskip("arviz")
    data = calibration.to_arviz(50)
    assert data["posterior"]["mu_s"].shape == (1, 50) and arviz.__version__


def test_what_is_no_effect_is_refused() -> None:
    table = pinswitch.read(EXAMPLES / "capstan.csv")
    for effects, code in (([1], "wrong-type"), (["no-such.toml"], "cannot-read"), ("no-such.toml", "cannot-read")):
        with pytest.raises(pinswitch.PinswitchError) as raised:
            pinswitch.calibrate(table, effects=effects)
        assert raised.value.code == code


def test_a_model_of_a_capstan_has_no_switch() -> None:
    """The table has neither pins nor silicone, whose friction would be that of the prior."""
    calibration = pinswitch.calibrate(pinswitch.read(EXAMPLES / "capstan.csv"))
    for attempt in (
        lambda: calibration.curve(pinswitch.Config("three-double")),
        lambda: pinswitch.predict(pinswitch.Config("silicone-only"), model=calibration),
        lambda: pinswitch.design({"targets": {"threshold_n": 26}}, model=calibration, best=1),
    ):
        with pytest.raises(pinswitch.PinswitchError, match="silicone") as raised:
            attempt()
        assert raised.value.code == "model-beyond-rig"
