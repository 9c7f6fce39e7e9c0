"""Configurations, and the errors of the package."""

from __future__ import annotations

import copy
import json
import pickle
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pinswitch
from pinswitch import PinswitchError, bam
from pinswitch.mujoco import Surface

PACKAGE = Path(__file__).parents[1]


def test_values_are_attributes_with_units() -> None:
    config = pinswitch.Config("three-double", shell__width_mm=12.5)
    assert (config.layout.pins, config.shell.width_mm) == ([5, 8, 11], 12.5)
    config.layout.pins = np.array([4, 8, 12])
    config.pins.diameter_mm = np.float64(1.2)
    assert (config["layout.pins"], config["pins.diameter_mm"]) == ([4, 8, 12], 1.2)
    assert config.to_dict()["shell"]["width_mm"] == 12.5


def test_sources_are_equivalent(tmp_path: Path) -> None:
    nested = pinswitch.Config({"layout": {"pins": [5, 8, 11]}, "switch": {"name": "a"}})
    flat = pinswitch.Config({"layout.pins": [5, 8, 11], "switch.name": "a"})
    file = tmp_path / "a.toml"
    nested.save(file)
    assert nested == flat == pinswitch.Config(file) == pinswitch.Config.from_toml(file.read_text())
    assert nested != nested.replace(shell__width_mm=12)
    assert pickle.loads(pickle.dumps(nested)) == nested


def test_presets_are_overridden() -> None:
    preset = pinswitch.Config("printer-fff-0.4")
    over = pinswitch.Config("three-double", preset="printer-fff-0.4")
    assert over.layout.pins == [5, 8, 11]
    changed = {path for path in preset._changed() if not path.startswith(("switch.", "layout.", "mesh."))}
    assert changed and all(over[path] == preset[path] for path in changed)


def test_errors_have_the_fields_of_the_diagnostic() -> None:
    config = pinswitch.Config("three-double", segment__grooves=40)
    with pytest.raises(PinswitchError) as caught:
        pinswitch.build(config)
    error = caught.value
    assert (error.field, error.value) == ("segment.grooves", "40")
    assert error.code == "grooves-overlap"
    assert error.changes == {"segment.grooves": "20"}
    assert error.problem.startswith("grooves overlap") and error.help is not None
    assert str(error).startswith("segment.grooves = 40: grooves overlap")
    restored = pickle.loads(pickle.dumps(error))
    assert (restored.code, restored.changes, str(restored)) == (error.code, error.changes, str(error))


def test_errors_have_the_line_of_a_file() -> None:
    with pytest.raises(PinswitchError) as caught:
        pinswitch.Config.from_toml("[shell]\nwidth_mm = 999\n", "mine.toml")
    assert (caught.value.file, caught.value.line, caught.value.field) == ("mine.toml", 2, "shell.width_mm")
    config = pinswitch.Config.from_toml("[segment]\ngrooves = 40\n", "mine.toml")
    with pytest.raises(PinswitchError) as caught:
        config.check()
    assert (caught.value.file, caught.value.line) == ("mine.toml", 2)
    # A value that was set later has no line.
    config.segment.grooves = 41
    with pytest.raises(PinswitchError) as caught:
        config.check()
    assert caught.value.file is None


@pytest.mark.parametrize(
    ("path", "value", "problem"),
    [
        ("shell.width_mm", 999, "outside"),
        ("shell.width_mm", "wide", "not a number"),
        ("shell.widht_mm", 1, "unknown"),
        ("layout.pins", object(), "not a number, a text or a list"),
    ],
)
def test_invalid_values_are_refused(path: str, value: object, problem: str) -> None:
    with pytest.raises(PinswitchError, match=problem):
        pinswitch.Config()[path] = value


def test_unknown_names_are_refused() -> None:
    with pytest.raises(PinswitchError, match="the nearest template is 'three-double'"):
        pinswitch.Config("three-duoble")
    config = pinswitch.Config()
    with pytest.raises(AttributeError, match="has no 'widht_mm'"):
        config.shell.widht_mm  # noqa: B018
    with pytest.raises(AttributeError, match="set a value of a table"):
        config.width_mm = 1  # type: ignore[misc]


def test_invalid_configurations_are_repaired() -> None:
    repaired, changes = pinswitch.Config("three-double", segment__grooves=40).repaired()
    assert repaired.check() is not None and "segment.grooves" in changes


def test_lists_are_assigned_not_changed() -> None:
    config = pinswitch.Config("three-double")
    for change in (lambda pins: pins.append(14), lambda pins: pins.sort(), lambda pins: pins.__setitem__(0, 1)):
        with pytest.raises(TypeError, match="assign a new list"):
            change(config.layout.pins)
        with pytest.raises(TypeError, match="assign a new list"):
            change(config["layout.pins"])
    config.layout.pins += [14]
    assert config.layout.pins == [5, 8, 11, 14]
    plain = pickle.loads(pickle.dumps(config.layout.pins))
    plain.append(15)
    assert type(copy.copy(config.layout.pins)) is list and plain == [5, 8, 11, 14, 15]


MISSING = "no-such-folder/file"
BINARY = b"\xff\xfe\x00\x81"
READERS: dict[str, Callable[[Any], object]] = {
    "Config": pinswitch.Config,
    "segment": pinswitch.segment,
    "power": pinswitch.power,
    "simulate": pinswitch.simulate,
    "design": pinswitch.design,
    "calibrate": pinswitch.calibrate,
    "check": pinswitch.check,
    "Model.load": pinswitch.Model.load,
    "Surface.load": Surface.load,
    "bam.read": bam.read,
    "map": lambda path: pinswitch.read(PACKAGE / "README.md", map=path),
    "noise": lambda path: pinswitch.simulate(noise=path),
    "model": lambda path: pinswitch.predict("three-double", model=path),
    "effects": lambda path: pinswitch.calibrate({}, effects=[path]),
    "table": lambda path: pinswitch.predict_table(path, "three-double"),
}


@pytest.mark.parametrize("name", READERS)
def test_files_that_cannot_be_read_are_one_kind_of_error(name: str, tmp_path: Path) -> None:
    binary = tmp_path / "binary"
    binary.write_bytes(BINARY)
    for path in (MISSING, tmp_path, binary, Path(MISSING)):
        with pytest.raises(PinswitchError) as caught:
            READERS[name](path)
        assert caught.value.file == str(path)


def test_every_code_has_a_page() -> None:
    program = shutil.which("pinswitch")
    if program is None:
        pytest.skip("the command line lists the codes")
    listed = subprocess.run([program, "explain", "--json"], capture_output=True, text=True, check=True).stdout
    known = {page["code"] for page in json.loads(listed)}
    sources = "".join(file.read_text(encoding="utf-8") for file in (PACKAGE / "python" / "pinswitch").glob("*.py"))
    used = set(re.findall(r'code="([a-z-]+)"', sources))
    assert len(used) > 15 and used <= known


def test_every_template_and_parameter_is_listed() -> None:
    assert all(pinswitch.Config(name).check() is not None for name in pinswitch.templates())
    assert {"table", "key", "unit", "range", "origin", "reason", "default"} == set(pinswitch.parameters()[0])


def test_sections_are_generated() -> None:
    sys.path.insert(0, str(PACKAGE / "tools"))
    try:
        import sections
    finally:
        sys.path.pop(0)
    assert sections.text() == sections.FILE.read_text(encoding="utf-8"), "run tools/sections.py"


def test_native_stubs_match_the_module() -> None:
    command = [sys.executable, "-m", "mypy.stubtest", "pinswitch._pinswitch", "--ignore-missing-stub"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_representations_show_changes() -> None:
    config = pinswitch.Config(shell__width_mm=12)
    assert repr(config) == "Config(shell.width_mm=12.0)"
    assert "<td><code>shell.width_mm</code></td><td>12.0</td>" in config._repr_html_()
