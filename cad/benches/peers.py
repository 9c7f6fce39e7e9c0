#!/usr/bin/env python3
"""Compares pinswitch with other CAD programs (peers): the same shell and tolerance, in one run on one machine.

usage: cargo build --release && cad/benches/peers.py [name part ...]

The folder PEERS_DIR has the peers' script run_peers.sh, which installs what it needs. The arguments select peers; "none"
omits them. The script runs first, then this program adds the rows of pinswitch to its table. pinswitch does more for each
part: it checks and hashes the mesh, and writes a manifest with friction curve and bill of materials, a table, plots and a
page. The figures include all of that.
"""
import csv, json, os, shutil, statistics, subprocess, sys, tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PEERS = os.environ.get("PEERS_DIR", os.path.join(ROOT, "..", "shared", "tools", "peers"))
VENV = "/tmp/peers-venv/bin/python"
BINARY = os.environ.get("PINSWITCH", os.path.join(ROOT, "target", "release", "pinswitch"))
RUNS = int(os.environ.get("RUNS", 3))

# Reference shell of the peers (spec.py): contact radius 22, wall 3, width 10, 15 grooves of 0.5, no holes, no label.
SHELL = """
[sweep]
parts = ["shell"]
[set]
"shell.outer_radius_mm" = 22.0
"shell.wall_mm" = 3.0
"shell.width_mm" = 10.0
"fasteners.count" = 0
"shell.stop_mm" = 0
"label.engrave" = false
"mould.kind" = "none"
"mesh.chord_tolerance_mm" = 0.01
[rows]
file = "rows.csv"
"""


def sweep(folder, radii):
    with open(f"{folder}/sweep.toml", "w") as f:
        f.write(SHELL)
    with open(f"{folder}/rows.csv", "w") as f:
        f.write("shell.outer_radius_mm\n" + "".join(f"{r!r}\n" for r in radii))


def run(folder, threads):
    """Returns wall time, processor time (both in s) and peak memory (MB) of one batch in an empty folder."""
    shutil.rmtree(f"{folder}/out", ignore_errors=True)
    command = [BINARY, "-q", "batch", "sweep.toml", "--out", "out", "--threads", str(threads)]
    import time
    start = time.perf_counter()
    child = subprocess.Popen(command, cwd=folder)
    _, status, used = os.wait4(child.pid, 0)
    wall = time.perf_counter() - start
    if status:
        raise SystemExit(f"{command}: status {status}")
    return wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def shells(folder, into, pattern):
    os.makedirs(into, exist_ok=True)
    for i, row in enumerate(csv.DictReader(open(f"{folder}/out/variants.csv"))):
        shutil.copy(f"{folder}/out/variants/{row['id']}/shell.stl", f"{into}/{pattern.format(i)}")


def row(name, threads):
    with tempfile.TemporaryDirectory() as folder:
        sweep(folder, [22.0])
        run(folder, threads)
        ones = [run(folder, threads) for _ in range(RUNS)]
        shells(folder, f"{folder}/one", "shell.stl")
        sweep(folder, [20.0 + 4.0 * i / 19 for i in range(20)])
        loops = [run(folder, threads) for _ in range(RUNS)]
        shells(folder, f"{folder}/loop", "v{:02}.stl")
        stl = f"{folder}/one/shell.stl"
        report = subprocess.check_output([VENV, "check.py", "--json", stl, f"{folder}/loop", "20"], cwd=PEERS, text=True)
        c = json.loads(report)
    med = statistics.median
    yes = lambda good: "yes" if good else "NO"
    print(f"| **{name}** | {yes(c['watertight'] and c['winding'])} / {yes(c['all_watertight'])} | {c['vol_err_pct']:+.3f} ({c['worst_vol_err_pct']:+.3f}) "
          f"| {c['triangles']} | {c['min_height_mm']:.4f} | {med(o[0] for o in ones):.2f} ({med(o[1] for o in ones):.2f}) "
          f"| {med(l[0] for l in loops) * 50:.1f} ({med(l[1] for l in loops) * 50:.1f}) | {max(l[2] for l in ones + loops):.0f} |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] != ["none"]:
        # Without its last line, a footnote, so that the rows of pinswitch follow in the same table.
        table = subprocess.run([f"{PEERS}/run_peers.sh", *sys.argv[1:]], text=True, stdout=subprocess.PIPE, check=True).stdout
        print(table[: table.rindex("\n\n")].rstrip())
    row("pinswitch batch, whole process", 1)
    row("pinswitch batch, whole process, 2 threads", 2)
    print("\n\\* one process per part (no in-process API)")
