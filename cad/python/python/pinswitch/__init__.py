"""Printable friction switches, their friction curves, and the calibration of the model with measurements.

>>> import pinswitch
>>> config = pinswitch.Config("three-double")
>>> curve = pinswitch.predict(config)
>>> curve.status
'published'

Errors are :class:`PinswitchError`, with the fields of the diagnostic. Long calls release the interpreter lock, and
Ctrl-C ends them. Forces are in N, lengths in mm, angles in degrees, as the names say.
"""

from __future__ import annotations

from ._errors import PinswitchError
from ._pinswitch import __version__
from .calibration import Calibration, Experiment, calibrate, experiment
from .config import Config, parameters, templates
from .curve import Curve, CurveTable, predict, predict_table
from .effects import Constant, Effect, effect, effect_file, shape, size
from .measurements import Measurements, Segmentation, Simulation, power, read, segment, simulate
from .model import Model
from .parts import Part, Parts, build
from .search import Batch, Designs, MeshCheck, Proposal, batch, check, design
from .table import Table, read_csv

__all__ = [
    "Batch",
    "Calibration",
    "Config",
    "Constant",
    "Curve",
    "CurveTable",
    "Designs",
    "Effect",
    "Experiment",
    "Measurements",
    "MeshCheck",
    "Model",
    "Part",
    "Parts",
    "PinswitchError",
    "Proposal",
    "Segmentation",
    "Simulation",
    "Table",
    "__version__",
    "batch",
    "build",
    "calibrate",
    "check",
    "design",
    "effect",
    "effect_file",
    "experiment",
    "parameters",
    "power",
    "predict",
    "predict_table",
    "read",
    "read_csv",
    "segment",
    "shape",
    "simulate",
    "size",
    "templates",
]
