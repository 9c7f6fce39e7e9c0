"""A first switch: a configuration, its curve, its parts, and their files."""

from __future__ import annotations

import tempfile

import pinswitch

config = pinswitch.Config("three-double", preset="printer-fff-0.4")
config.layout.pins = [5, 7, 9, 11]
curve = pinswitch.predict(config)
print(curve)
for reason in curve.reasons:
    print(" ", reason)
print(f"silicone carries half of the friction at {curve.threshold_n:.1f} N")

parts = pinswitch.build(config)
for part in parts:
    print(f"{part.name}: {part.volume_mm3:.0f} mm3, {len(part.triangles)} triangles")
with tempfile.TemporaryDirectory() as folder:
    print(len(parts.save(folder, ["stl", "3mf"])), "files")

try:
    config.segment.grooves = 40
    pinswitch.build(config)
except pinswitch.PinswitchError as error:
    print(f"{error.field}: {error.problem}; possible: {error.changes}")
