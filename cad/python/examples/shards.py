"""Blocks of a large table on several processes: ``python shards.py processes``, ``dask`` or ``ray``.

Each worker predicts a block of rows on one thread. Workers are started as new processes: a process that is forked
after a prediction would inherit threads that do not run.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np

import pinswitch

BASE = pinswitch.Config("three-double", friction__points=21)


def mean_friction_n(widths_mm: list[float]) -> float:
    """Return the mean friction of a block of rows at the heaviest load, N."""
    curves = pinswitch.predict_table({"shell.width_mm": widths_mm}, BASE, threads=1)
    heaviest = curves["load_N"] == curves["load_N"].max()
    return float(curves["friction_N"][heaviest].mean())


def main(backend: str) -> list[float]:
    """Return the mean of each block."""
    blocks = [block.tolist() for block in np.array_split(np.linspace(12.5, 15.0, 400), 4)]
    if backend == "dask":
        import dask.bag

        bag: Any = dask.bag
        tasks = bag.from_sequence(blocks, npartitions=len(blocks)).map(mean_friction_n)
        return list(tasks.compute(scheduler="processes"))
    if backend == "ray":
        import ray

        remote: Any = ray.remote(mean_friction_n)
        return list(ray.get([remote.remote(block) for block in blocks]))
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as workers:
        return list(workers.map(mean_friction_n, blocks))


if __name__ == "__main__":
    print([round(mean, 3) for mean in main(*sys.argv[1:] or ["processes"])])
