"""The softest, the spread and the best compromises of very many designs, of which none is stored.

    python examples/very_many.py --nodes 1000 1000 20

A quarter car over a grid of springs, dampers and unsprung masses. Its metrics are lazy, since its parameters are Dask
arrays: a block of designs is computed, what is asked for is taken from it, and it is forgotten. In one pass

- the least body acceleration: any reduction of xarray;
- quantiles of the suspension's travel, from a histogram of fixed bins, whose width is their error;
- the Pareto front of both: the front of all designs is the front of the blocks' fronts.

Memory holds a few blocks, whatever the number of designs. With a ``distributed.Client`` at hand the workers of its
cluster compute, and only fronts and counts travel.
"""

import argparse
import time
from typing import NamedTuple

import dask
import dask.array
import numpy as np
import xarray as xr

import susp_ss as ss

RANGES = {"ks": (12e3, 25e3), "cs": (800.0, 2200.0), "mu": (35.0, 55.0)}

# Designs of a block: as many as keep a processor busy for a tenth of a second.
BLOCK = 500_000

# Travel that no design here reaches, m, and bins up to it.
MOST_TRAVEL, BINS = 0.05, 5000

QUANTILES = (0.05, 0.5, 0.95)


class Found(NamedTuple):
    """Least acceleration (m/s^2), quantiles of travel (m), and the front (2, n) of acceleration and travel."""

    softest: float
    quantiles: np.ndarray
    front: np.ndarray


def grid(nodes):
    """A quarter car along three axes, in blocks."""
    block = {"ks": max(BLOCK // nodes[1], 1), "cs": BLOCK, "mu": 1}
    axes = {name: np.linspace(*RANGES[name], count) for name, count in zip(RANGES, nodes, strict=True)}
    along = {name: xr.DataArray(values, {name: values}).chunk({name: block[name]}) for name, values in axes.items()}
    return ss.QuarterCar(**along)


def front(points):
    """Those of the points (2, n) that no other beats in both coordinates, by the first coordinate."""
    ordered = points[:, np.lexsort(points[::-1])]
    least = np.minimum.accumulate(ordered[1])
    return ordered[:, np.append(True, least[1:] < least[:-1])]


def front_of_blocks(*metrics):
    """The front of two lazy metrics: of each block, then of all blocks' fronts."""
    blocks = zip(*(metric.data.to_delayed().ravel() for metric in metrics), strict=True)
    fronts = [dask.delayed(front)(dask.delayed(stacked)(*block)) for block in blocks]
    return dask.delayed(front)(dask.delayed(np.concatenate)(fronts, axis=1))


def stacked(*values):
    return np.stack([value.ravel() for value in values])


def reduced(car, road):
    """Everything in one pass over the designs."""
    metrics = ss.ride_metrics(car, road)
    counts, edges = dask.array.histogram(metrics.sws.data, bins=BINS, range=(0.0, MOST_TRAVEL))
    softest, counts, best = dask.compute(metrics.bacc.min(), counts, front_of_blocks(metrics.bacc, metrics.sws))
    below = np.append(0.0, np.cumsum(counts)) / metrics.sws.size
    return Found(float(softest), np.interp(QUANTILES, below, edges), best)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--nodes", type=int, nargs=3, default=(100, 100, 5), metavar="N", help="of ks, cs and mu")
    nodes = parser.parse_args(arguments).nodes
    begun = time.perf_counter()
    found = reduced(grid(nodes), ss.Road())
    designs, seconds = int(np.prod(nodes)), time.perf_counter() - begun
    print(f"{designs:,} quarter cars: softest {found.softest:.4f} m/s^2")
    travel = ", ".join(f"{1e3 * value:.2f}" for value in found.quantiles)
    print(f"5, 50 and 95 % have a travel below {travel} mm (RMS)")
    print(f"{found.front.shape[1]} best compromises, from {found.front[0, 0]:.3f} to {found.front[0, -1]:.3f} m/s^2")
    return designs / seconds


if __name__ == "__main__":
    main()
