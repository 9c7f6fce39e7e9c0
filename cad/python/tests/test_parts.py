"""Parts, designs, sweeps and checks of meshes."""

from __future__ import annotations

import gc
import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import pinswitch
from pinswitch import PinswitchError


@pytest.fixture(scope="module")
def parts(config: pinswitch.Config) -> pinswitch.Parts:
    return pinswitch.build(config)


def test_meshes_are_views(parts: pinswitch.Parts) -> None:
    shell = parts["shell"]
    again = parts._native.mesh("shell")[0]
    assert again.__array_interface__["data"] == shell.vertices.__array_interface__["data"], "not a copy"
    assert not shell.vertices.flags.writeable and not shell.vertices.flags.owndata
    with pytest.raises(ValueError, match="read-only"):
        shell.vertices[0, 0] = 1.0
    a, b, c = (shell.vertices[shell.triangles[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(shell.volume_mm3, rel=1e-9)


def test_meshes_outlive_their_parts(config: pinswitch.Config) -> None:
    vertices = pinswitch.build(config)["shell"].vertices
    expected = vertices.copy()
    gc.collect()
    pinswitch.build(config.replace(shell__width_mm=13))
    assert np.array_equal(vertices, expected)


def test_sets_are_saved_whole(parts: pinswitch.Parts, tmp_path: Path) -> None:
    written = parts.save(tmp_path / "set", ["stl"])
    assert written[-1].name == "manifest.json" and (tmp_path / "set" / "friction.csv").is_file()
    manifest = json.loads(written[-1].read_text())
    assert len(manifest["parts"]) == len(parts)
    assert (tmp_path / "set" / "shell.stl").read_bytes() == parts["shell"].to_stl()
    with pytest.raises(PinswitchError, match="overwrite=True"):
        parts.save(tmp_path / "set", ["stl"])
    parts.save(tmp_path / "set", ["stl"], overwrite=True)
    with pytest.raises(PinswitchError, match="unknown format"):
        parts.to_files(["stp"])


def test_parts_turn_in_a_notebook(parts: pinswitch.Parts) -> None:
    import matplotlib

    matplotlib.use("Agg")
    assert parts._native.turning(40, 30, 4).count(b"fdAT") == 3, "frames after the first"
    assert "data:image/png;base64," in parts._repr_html_()
    assert parts.plot().get_xlabel() == "mm"


def test_meshes_are_checked(parts: pinswitch.Parts, tmp_path: Path) -> None:
    parts.save(tmp_path, ["stl", "3mf"])
    good = pinswitch.check(tmp_path / "shell.stl")
    assert good and good.report["format"] == "stl" and pinswitch.check(tmp_path / "assembly.3mf")
    whole = parts["shell"].to_stl()
    count = int.from_bytes(whole[80:84], "little") - 1
    (tmp_path / "open.stl").write_bytes(whole[:80] + count.to_bytes(4, "little") + whole[84:-50])
    bad = pinswitch.check(tmp_path / "open.stl")
    assert not bad.is_valid and bad.faults[0]["check"] == "open edge" and "NOT VALID" in str(bad)
    (tmp_path / "no.stl").write_bytes(b"solid\nnothing")
    with pytest.raises(PinswitchError):
        pinswitch.check(tmp_path / "no.stl")
    assert pinswitch.Config(tmp_path / "assembly.3mf").layout.pins == [5, 8, 11]


def test_parts_are_pickled_as_their_configuration() -> None:
    parts = pinswitch.build(pinswitch.Config("three-double", shell__width_mm=14.0))
    restored = pickle.loads(pickle.dumps(parts))
    assert "shell" in parts and "shel" not in parts and [one.name for one in parts[:2]] == parts.names[:2]
    assert restored.config == parts.config and restored["shell"].to_stl() == parts["shell"].to_stl()


def test_designs_meet_a_request() -> None:
    designs = pinswitch.design({"targets": {"threshold_n": 24, "max_friction_n": "at most 9"}}, best=2, draws=200)
    assert designs.is_possible and len(designs) == 2
    best = designs[0]
    assert best.friction_n <= 9 and best.threshold_n == pytest.approx(24, rel=0.1)
    curve = pinswitch.predict(best.config)
    assert best.status == curve.status and f"<td>{best.status}</td>" in designs._repr_html_()
    assert curve.threshold_n == pytest.approx(best.threshold_n, rel=0.02)


def test_impossible_requests_name_the_limit() -> None:
    designs = pinswitch.design({"targets": {"max_friction_n": "at least 30"}}, best=1, draws=100)
    assert not designs.is_possible and designs.blocked is not None and len(designs) == 1
    with pytest.raises(PinswitchError) as caught:
        pinswitch.design({"targets": {"threshhold_n": 20}})
    assert caught.value.line == 2


def test_batches_are_made_and_resumed(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.toml"
    sweep.write_text(
        '[sweep]\nbase = "three-double"\nparts = ["shell"]\n[axes]\n"shell.width_mm" = { from = 13, to = 15, step = 1 }\n'
    )
    batch = pinswitch.batch(sweep, tmp_path / "out")
    assert batch.tally["made"] == 3 and len(batch.variants) == 3
    assert pinswitch.batch(sweep, tmp_path / "out").tally == batch.tally
    with pytest.raises(PinswitchError) as caught:
        pinswitch.batch(sweep, tmp_path / "other", shard="5/4")
    assert caught.value.field == "shard"
