#!/usr/bin/env python3
"""Measures every performance figure that README and the documents quote, and keeps them in cad/benches/ledger.json.

    cargo build --release && cad/benches/ledger.py measure      measure all figures and write the ledger
    cad/benches/ledger.py ratios                                print three ratios, measured in one run
    cad/benches/ledger.py check                                 the same; exit 1 if one is over twice that of the ledger
    cad/benches/ledger.py texts                                 print the sentences that the documents must contain

PINSWITCH names another binary than target/release/pinswitch. Ratios divide processor times of one run on one machine, so
that they hold on other machines; they depend on the profile, and each profile has its own in the ledger. A test compares
the sentences with the documents. Standard library only.
"""
import json, os, resource, shutil, statistics, subprocess, sys, tempfile, zlib

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LEDGER = os.path.join(ROOT, "cad", "benches", "ledger.json")
BINARY = os.path.abspath(os.environ.get("PINSWITCH", os.path.join(ROOT, "target", "release", "pinswitch")))
REPEATS = 3
# A ratio that has doubled fails: noise of a shared machine stays below, a lost cache or an accidental square does not.
DOUBLED = 2.0

# Five parts a variant, none equal to that of another variant, one curve.
DIFFERENT = """
[sweep]
base = "three-double"
parts = ["shell", "mould-core", "mould-ring", "support-left", "support-right"]
[axes]
"shell.outer_radius_mm" = { from = 19.5, to = 24.5, count = %d }
"shell.width_mm" = { from = 13, to = 15, count = %d }
"""
# The same parts; every variant has a friction curve of its own.
OWN_CURVES = DIFFERENT.split("[axes]")[0] + """[axes]
"silicone.hardness_shore_a" = { from = 40, to = 60, count = 40 }
"""
# The same parts; all variants share one curve.
SHARED_CURVE = DIFFERENT.split("[axes]")[0] + """[axes]
"tendon.length_mm" = { from = 200, to = 239, count = 40 }
"""


def run(folder, *arguments):
    """Processor seconds and peak memory in MB of one run."""
    child = subprocess.Popen([BINARY, "-q", *arguments], cwd=folder, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(arguments)}: status {status}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def cpu(folder, *arguments, fresh=None):
    """Median processor seconds of a command; `fresh` is a folder that is removed before each run."""
    times = []
    for _ in range(REPEATS):
        if fresh:
            shutil.rmtree(os.path.join(folder, fresh), ignore_errors=True)
        times.append(run(folder, *arguments)[0])
    return statistics.median(times)


def sweep(folder, name, text):
    with open(os.path.join(folder, name), "w") as f:
        f.write(text)
    return name


def fixed_work():
    """Processor seconds of a fixed piece of work that is not ours: zlib on 24 MB."""
    state, block = 1, bytearray()
    for _ in range(1 << 16):
        state = (state * 1103515245 + 12345) & 0x7FFFFFFF
        block.append(state >> 16 & 0xFF if state & 64 else 0x20)
    data = bytes(block) * 384
    times = []
    for _ in range(REPEATS):
        start = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        zlib.compress(data, 6)
        times.append(resource.getrusage(resource.RUSAGE_SELF).ru_utime - start)
    return statistics.median(times)


def ratios(folder):
    """Three ratios of processor time, each measured in this run."""
    one_set = cpu(folder, "generate", "three-double", "--out", "set", fresh="set")
    own = cpu(folder, "batch", sweep(folder, "own.toml", OWN_CURVES), "--out", "own", fresh="own")
    shared = cpu(folder, "batch", sweep(folder, "shared.toml", SHARED_CURVE), "--out", "shared", fresh="shared")
    resumed = cpu(folder, "batch", "shared.toml", "--out", "shared")
    return {
        "set / fixed work": one_set / fixed_work(),
        "batch with own curves / with one shared curve": own / shared,
        "resumed batch / fresh batch": resumed / shared,
    }


def figures(folder):
    """Every quoted figure: its value, the command, the sentence, and the documents that contain the sentence."""
    made = {}

    def add(name, values, command, text, documents):
        made[name] = {"values": values, "command": command, "text": text.format(**values), "documents": documents}

    for variants, (radii, widths) in {100: (10, 10), 1000: (50, 20)}.items():
        name = sweep(folder, f"different-{variants}.toml", DIFFERENT % (radii, widths))
        used, memory = run(folder, "batch", name, "--out", f"different-{variants}")
        values = {"variants": variants, "cpu_s": used, "per_variant_ms": 1e3 * used / variants, "memory_mb": memory}
        values["per_second"] = variants / used
        text = "| {variants:,} | {cpu_s:.1f} s | {per_variant_ms:.1f} ms | {per_second:.0f} | {memory_mb:.0f} MB |"
        add(f"batch of {variants}", values, f"pinswitch batch {name}", text, ["cad/doc/batch.md"])
    add("batch in README", made["batch of 1000"]["values"], "pinswitch batch different-1000.toml",
        "1,000 variants take {cpu_s:.0f} s of processor time", ["README.md"])
    hours = made["batch of 1000"]["values"]["per_variant_ms"] * 1e6 / 3.6e6
    add("million variants", {"hours": hours, "minutes": 0.6 * hours}, "from the batch of 1,000",
        "**A million variants** like these take {hours:.0f} hours of one processor", ["cad/doc/batch.md"])
    add("shard", {"minutes": 0.6 * hours}, "from the batch of 1,000",
        "Each of 100 shards of 10,000 variants takes {minutes:.0f} minutes of one processor", ["cad/doc/batch.md"])
    meshes = [os.path.join(at, name) for at, _, names in os.walk(os.path.join(folder, "different-1000", "variants")) for name in names if name.endswith(".stl")]
    used = run(folder, "check", *meshes)[0]
    add("check", {"meshes": len(meshes), "cpu_s": used}, "pinswitch check different-1000/variants/*/*.stl",
        "reports all {meshes:,} meshes of the 1,000 variants as valid, in {cpu_s:.0f} s of processor time", ["cad/doc/batch.md"])
    own = cpu(folder, "batch", sweep(folder, "own.toml", OWN_CURVES), "--out", "own-figure", fresh="own-figure")
    shared = cpu(folder, "batch", sweep(folder, "shared.toml", SHARED_CURVE), "--out", "shared-figure", fresh="shared-figure")
    add("curves of a batch", {"own_ms": 1e3 * own / 40, "shared_ms": 1e3 * shared / 40}, "pinswitch batch own.toml; pinswitch batch shared.toml",
        "a variant takes {own_ms:.0f} ms of processor time with a curve of its own and {shared_ms:.0f} ms with a shared one", ["cad/doc/batch.md"])
    one_set = cpu(folder, "generate", "three-double", "--out", "set-figure", fresh="set-figure")
    verified = cpu(folder, "generate", "three-double", "--verify", "--out", "verified", fresh="verified")
    add("set", {"cpu_s": one_set, "verified_s": verified}, "pinswitch generate three-double [--verify]",
        "a set of `three-double` takes {cpu_s:.2f} s of processor time, and {verified_s:.2f} s with `--verify`", ["cad/doc/meshes.md"])
    arguments = "--threshold 24 --max-friction 9 --vary pitch_deg,layer_mm,pin_diameter_mm,radius_mm,width_mm".split()
    used = run(folder, "design", *arguments, "--out", "designs")[0]
    add("design", {"cpu_s": used}, "pinswitch design " + " ".join(arguments),
        "takes {cpu_s:.0f} s of processor time", ["cad/doc/design.md"])
    # The fixed configuration has 20 grooves.
    refused, accepted = (cpu(folder, "generate", "three-double", "--set", f"segment.grooves={n}", "--fix", "--out", "fixed", fresh="fixed") for n in (40, 20))
    add("fix", {"more_ms": 1e3 * (refused - accepted)}, "pinswitch generate three-double --set segment.grooves=40 --fix",
        "The search takes {more_ms:.0f} ms of processor time for a configuration with overlapping grooves", ["cad/doc/dimensions.md"])
    return made


def profile():
    """Name of the profile of the binary, by its folder."""
    return os.path.basename(os.path.dirname(BINARY))


def commit():
    git = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True)
    return git.stdout.strip()


def kept():
    with open(LEDGER) as f:
        return json.load(f)


def main():
    command = sys.argv[1] if len(sys.argv) == 2 else "help"
    if command == "texts":
        for entry in kept()["figures"].values():
            print(f"{', '.join(entry['documents'])}: {entry['text']}")
        return
    if command not in ("measure", "ratios", "check"):
        raise SystemExit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        now = ratios(folder)
        if command == "measure":
            ledger = kept() if os.path.exists(LEDGER) else {"ratios": {}}
            ledger["ratios"][profile()] = now
            if profile() == "release":
                ledger["figures"] = figures(folder)
                ledger["commit"], ledger["processors"] = commit(), os.cpu_count()
            with open(LEDGER, "w") as f:
                json.dump(ledger, f, indent=1, sort_keys=True)
                f.write("\n")
    then = kept()["ratios"][profile()] if command == "check" else {}
    grown = []
    for name, value in now.items():
        print(f"{name}: {value:.3f}" + (f" (ledger {then[name]:.3f})" if name in then else ""))
        if name in then and value > DOUBLED * then[name]:
            grown.append(name)
    if grown:
        raise SystemExit(f"over twice the ledger's value: {', '.join(grown)}")


if __name__ == "__main__":
    main()
