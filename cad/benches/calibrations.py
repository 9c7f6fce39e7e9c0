#!/usr/bin/env python3
"""Measures processor time and memory of calibrations of 800, 3,000 and 30,000 readings, without and with effects.

usage: cargo build --release && cad/benches/calibrations.py [BINARY ...]

With several binaries, such as one of an earlier commit, each table is calibrated by all of them in turn. The first one
simulates the tables. RUNS (default 1) is the number of runs, of which the medians are printed, as a Markdown table.
"""
import os, statistics, subprocess, sys, tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BINARIES = sys.argv[1:] or [os.path.join(ROOT, "target", "release", "pinswitch")]
RUNS = int(os.environ.get("RUNS", 1))
# Least and most repetitions of a series.
REPETITIONS = {800: (3, 8), 3000: (12, 29), 30000: (120, 260)}
EFFECTS = {
    "none": [],
    "offset and drag": ["load_cell_offset=0.2", "guide_drag=0.3"],
    "ploughing": ["coating_ploughing=0.02"],
}


def simulated(folder, repetitions, effects):
    with open(f"{folder}/plan.toml", "w") as f:
        f.write(f"repetitions = {list(repetitions)}\nrepetitions_spread = 0\n")
    arguments = [x for effect in effects for x in ("--effect", effect)]
    subprocess.run([BINARIES[0], "-q", "simulate", "plan.toml", *arguments, "--seed", "5", "--out", "rig"],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL)
    with open(f"{folder}/rig/plateaus.csv") as f:
        return sum(1 for _ in f) - 1


def calibrated(binary, folder, number):
    arguments = [binary, "-q", "calibrate", "rig/plateaus.csv", "--out", f"out-{number}"]
    with subprocess.Popen(arguments, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = status
    assert status == 0, arguments
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


print("| readings | effects | " + " | ".join(f"{os.path.basename(b)}: s, MB" for b in BINARIES) + " |")
print("|---|---|" + "---|" * len(BINARIES))
number = 0
for repetitions in REPETITIONS.values():
    for name, effects in EFFECTS.items():
        with tempfile.TemporaryDirectory() as folder:
            rows = simulated(folder, repetitions, effects)
            runs = {binary: [] for binary in BINARIES}
            for _ in range(RUNS):
                for binary in BINARIES:
                    number += 1
                    runs[binary].append(calibrated(binary, folder, number))
            cells = ["{:.2f}, {:.0f}".format(*map(statistics.median, zip(*runs[binary]))) for binary in BINARIES]
            print(f"| {rows:,} | {name} | " + " | ".join(cells) + " |", flush=True)
