"""The Python lines of the package's README."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

PACKAGE = Path(__file__).parents[1]


def test_the_lines_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The lines name files from the top of the repository.
    (tmp_path / "model").symlink_to(PACKAGE.parents[1] / "model")
    monkeypatch.chdir(tmp_path)
    text = (PACKAGE / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 2
    names: dict[str, Any] = {}
    exec(compile(blocks[0], "README.md", "exec"), names)
    assert (tmp_path / "out" / "four-pins" / "shell.stl").is_file()
    assert 0 < names["low"] < names["value"] < names["high"] < 1
    exec(compile(blocks[1], "README.md", "exec"), names)
    calibration = names["calibration"]
    assert calibration.probabilities["cell_creep"] > 0.5
    low, high = calibration.effects["cell_creep"]["parameters"]["k"]["ci95"]
    assert low < 0.03 < high
