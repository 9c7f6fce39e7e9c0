"""Times `predict_table` and `build` against native calls, and writes the table into README.md.

``python cad/python/benches/predict.py`` compiles the native program; ``--check`` compares without writing, and fails
above the bound.
"""

from __future__ import annotations

import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import pinswitch

PACKAGE = Path(__file__).parents[1]
#: Largest ratio of the Python call to the native call.
BOUND = 1.1
ROWS = 1_000
ROUNDS = 15


def seconds_of(call: Callable[[], object]) -> float:
    """Return the seconds of a call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def main() -> int:
    """Measure, print and write; return the exit code."""
    build = ["cargo", "build", "--release", "--quiet", "--example", "native", "--manifest-path"]
    subprocess.run([*build, str(PACKAGE / "Cargo.toml")], check=True)
    native_program = PACKAGE / "target" / "release" / "examples" / "native"
    widths = np.linspace(12.5, 16.0, ROWS // 4)
    table = {
        "shell.width_mm": np.repeat(widths, 4),
        "layout.pins": [[5, 8, 11], [4, 8, 12], [5, 7, 9, 11], [3, 5, 7, 9, 11, 13]] * (ROWS // 4),
    }
    base = pinswitch.Config("three-double")
    native, python, frame = [], [], []
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        file.write(pinswitch.table.csv_text(table))
        file.flush()
        # Alternating, so that both see the same load of the machine.
        for _ in range(ROUNDS):
            run = subprocess.run([native_program, file.name, "1"], check=True, capture_output=True, text=True)
            seconds, rows = run.stdout.split()
            assert int(rows) == ROWS
            native.append(float(seconds))
            python.append(seconds_of(lambda: pinswitch.predict_table(table, base)))
            frame.append(seconds_of(lambda: pinswitch.predict_table(table, base).to_pandas()))
    parts = pinswitch.build(base)
    meshes = [seconds_of(lambda: parts._native.mesh("shell")) for _ in range(200)]
    ratio = statistics.median(p / n for p, n in zip(python, native))
    lines = [
        "| call | median | minimum |",
        "| --- | --- | --- |",
        *(
            f"| {name} | {1e3 * statistics.median(times):.3g} ms | {1e3 * min(times):.3g} ms |"
            for name, times in (
                (f"native `predict_table`, {ROWS:,} rows of 101 loads", native),
                ("Python `predict_table`, the same rows", python),
                ("the same with `to_pandas()`", frame),
                ("vertices and triangles of the shell as arrays", meshes),
            )
        ),
        "",
        f"The Python call takes {ratio:.2f} times the native call (median of {ROUNDS} pairs; bound {BOUND}).",
    ]
    print("\n".join(lines))
    if "--check" not in sys.argv:
        readme = PACKAGE / "README.md"
        text = readme.read_text(encoding="utf-8")
        block = "<!-- times -->\n" + "\n".join(lines) + "\n<!-- /times -->"
        readme.write_text(re.sub(r"<!-- times -->.*<!-- /times -->", lambda _: block, text, flags=re.S), encoding="utf-8")
    return int(ratio > BOUND)


if __name__ == "__main__":
    sys.exit(main())
