"""The points of all ranks, dealt anew by place: each rank gets a stretch of the Morton curve.

The serial code sorts points along the same curve before it triangulates and numbers simplices by it. A rank that owns a
stretch of the curve therefore owns a stretch of the serial numbers: the ranks' results, one after another, are the
serial result.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.kernels.points import lexicographic_order, morton_codes

Floats = NDArray[np.float64]
Ints = NDArray[Any]

SAMPLES = 64  # for each rank a rank sends to find where the curve is cut; blocks then differ by a few per cent


@dataclass(frozen=True)
class Block:
    """One rank's share of the distinct points, in their order along the curve.

    Attributes
    ----------
    points : (n, d) float
        Coordinates.
    names : (n, 4) int
        Of each point its row in the serial mesh (its place among the distinct points of all ranks by input id), its
        input id (of equal points the smallest), the rank that brought it, and its index there.
    codes : (n,) uint64
        Morton code of each, over a cube around the points of all ranks.
    extent : float
        Side of that cube.
    first : int
        Place of the first one along the whole curve.
    total : int
        Number of distinct points on all ranks.
    """

    points: Floats
    names: Ints
    codes: NDArray[np.uint64]
    extent: float
    first: int
    total: int

    def __len__(self) -> int:
        return len(self.points)

    @property
    def place(self) -> Ints:
        """(n,) place of each point along the whole curve."""
        return np.arange(self.first, self.first + len(self), dtype=index_type(self.total))


def deal_by_place(comm: Communicator, points: Floats, ids: Ints) -> Block:
    """Give each rank its stretch of the curve, of about equal length; equal points are merged.

    Parameters
    ----------
    points : (k, d) float
        What this rank brings, in no order; copies of points of other ranks may be among them.
    ids : (k,) int
        Input id of each, the same for all copies of a point.
    """
    low = comm.lowest(points.min(axis=0, initial=np.inf))
    extent = float((comm.highest(points.max(axis=0, initial=-np.inf)) - low).max())
    home = np.stack([np.full(len(points), comm.rank), np.arange(len(points))], axis=1).astype(np.int64)
    mine = comm.keep(*_distinct(points, ids, home, morton_codes(points, low, extent)))
    del points, ids, home
    route = Route(comm, np.searchsorted(_cuts(comm, mine[3]), mine[3], side="right"))
    received = [route.forward(column) for column in mine]
    del mine
    points, ids, home, codes = comm.keep(*_distinct(*received))
    del received
    names = np.column_stack([places_of(comm, ids), ids, home])
    largest = int(comm.highest(np.array([np.abs(names).max(initial=0)]))[0])
    points, names, codes = comm.keep(points, names.astype(index_type(largest)), codes)
    return Block(points, names, codes, extent, comm.before(len(ids)), comm.total(len(ids)))


Columns = tuple[Floats, Ints, Ints, NDArray[np.uint64]]


def _distinct(points: Floats, ids: Ints, home: Ints, codes: NDArray[np.uint64]) -> Columns:
    """Sorted along the curve, ties by coordinates; of equal points the one with the smallest id."""
    order = np.argsort(codes, kind="stable")
    if np.any(codes[order][1:] == codes[order][:-1]):
        order = np.lexsort([ids, *points.T[::-1], codes])
        ranked = points[order]
        new = np.ones(len(order), bool)
        new[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
        order = order[new]
    return points[order], ids[order], home[order], codes[order]


def _cuts(comm: Communicator, codes: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """(size - 1,) codes at which the next rank begins: quantiles of evenly spaced samples of all ranks."""
    count = min(SAMPLES * comm.size, len(codes))
    at = (np.arange(count) * len(codes)) // max(count, 1)
    samples = np.concatenate(comm.allgather(codes[at]))
    weights = np.concatenate(comm.allgather(np.full(count, len(codes) / max(count, 1))))
    order = np.argsort(samples, kind="stable")
    share = np.cumsum(weights[order]) / max(weights.sum(), 1.0)
    wanted = np.searchsorted(share, np.arange(1, comm.size) / comm.size)
    return samples[order][np.minimum(wanted, len(samples) - 1)] if len(samples) else np.empty(0, np.uint64)


def places_of(comm: Communicator, ids: Ints) -> Ints:
    """(k,) place of each id among the ids of all ranks, which all differ: 0 for the smallest."""
    low = int(comm.lowest(np.array([ids.min(initial=np.iinfo(np.int64).max)]))[0])
    high = int(comm.highest(np.array([ids.max(initial=low)]))[0])
    step = max((high - low) // comm.size + 1, 1)
    route = Route(comm, (ids - low) // step)
    received = route.forward(ids)
    first = comm.before(len(received))
    place = np.empty(len(received), np.int64)
    place[np.argsort(received, kind="stable")] = np.arange(first, first + len(received))
    return route.back(place)


def affine_basis(points: Floats) -> Ints:
    """Indices of a few points that span what all span: first and last along the axes, and the widest simplex."""
    if len(points) == 0:
        return np.empty(0, np.int64)
    chosen = [0, *points.argmin(axis=0), *points.argmax(axis=0), *lexicographic_order(points)[[0, -1]]]
    apart = points - points[0]
    for _ in range(points.shape[1]):
        squares = (apart / (np.abs(apart).max() or 1.0)) ** 2
        chosen.append(int(np.argmax(squares.sum(axis=1))))
        unit = apart[chosen[-1]] / (np.abs(apart[chosen[-1]]).max() or 1.0)
        unit = unit / (np.sqrt((unit**2).sum()) or 1.0)
        apart = apart - (apart * unit).sum(axis=1)[:, None] * unit
    return np.unique(np.array(chosen, np.int64))
