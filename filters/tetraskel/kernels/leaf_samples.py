"""One point of each leaf of an octree, and what else is known of the points there, from pieces that are put together.

All of it is the same in whatever order the pieces come: the best point is a minimum, and all that is summed is whole
numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.octree import WITHIN, Octree
from tetraskel.kernels.points import PIECE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

# Points of a leaf lie on a piece of a surface that is not bent much when they are flat: their standard deviation
# across is less than the first share of the leaf's side. Those of a limb thinner than the leaf are as wide one way
# across as the other, up to the second share, and not wide, of the side up to the third.
THICK, ROUND, SLENDER = 0.04, 0.3, 0.15
ENOUGH = 12  # points of a leaf, to tell


@dataclass(frozen=True)
class Sample:
    """One point of each leaf.

    Attributes
    ----------
    leaf : (k,) int
        Ascending.
    points : (k, d) float
    ids : (k,) int
        Which of the input each is; of equal ones the first.
    away : (k,) float
        Square of its distance from the leaf's middle.
    counts : (k,) int
        Points in the leaf.
    octants : (k,) int
        Bit o is set when there are points in octant o of the leaf.
    sums : (k, d + d (d+1) / 2) int
        Of the places of the points in the leaf, and of their products: whole numbers, so that they are the same in
        any order.
    differ : (k,) bool
        The points of the leaf are not all in one place.
    """

    leaf: Ints
    points: Floats
    ids: Ints
    away: Floats
    counts: Ints
    octants: Ints
    sums: Ints
    differ: Bools

    def __len__(self) -> int:
        return len(self.leaf)


def sample_of_all(points: NDArray, ids: Ints | int, octree: Octree, tick: Tick = silent) -> Sample:
    """One point of each leaf, from (n, d) points that are read a piece at a time.

    `ids` are theirs, or that of the first when they are numbered.
    """
    sample = _sample_of(np.empty((0, octree.dim)), np.empty(0, np.int64), octree)
    for start in range(0, len(points), PIECE):
        tick(start / len(points))
        piece = np.asarray(points[start : start + PIECE], float)
        numbered = ids + np.arange(start, start + len(piece)) if isinstance(ids, int) else ids[start : start + PIECE]
        sample = joined([sample, _sample_of(piece, numbered, octree)])
    return sample


def joined(samples: Sequence[Sample]) -> Sample:
    """One point of each leaf, from those of parts of the points."""
    return _best(Sample(*(np.concatenate([getattr(one, field.name) for one in samples]) for field in fields(Sample))))


def _sample_of(points: Floats, ids: Ints, octree: Octree) -> Sample:
    """One point of each leaf."""
    points = points + 0.0  # -0.0 and 0.0 are one place
    leaf, octant, away, within = octree.located(points)
    products = [within[:, i] * within[:, j] for i, j in _pairs(octree.dim)]
    sums = np.column_stack([within, *products])
    counts, differ = np.ones(len(points), np.int64), np.zeros(len(points), bool)
    return _best(Sample(leaf, points, ids, away, counts, np.left_shift(1, octant), sums, differ))


def _pairs(dim: int) -> list[tuple[int, int]]:
    """Axes whose products are summed."""
    return [(i, j) for i in range(dim) for j in range(i, dim)]


def _best(whole: Sample) -> Sample:
    """Of each leaf the point least away from its middle; ties go to the smaller coordinates, then to the smaller id."""
    if len(whole) == 0:
        return whole
    order = np.argsort(whole.leaf, kind="stable")
    leaf, points, ids, away = whole.leaf, whole.points, whole.ids, whole.away
    begins = np.flatnonzero(np.diff(leaf[order], prepend=-1))
    sizes = np.diff(np.append(begins, len(leaf)))
    rows = order[away[order] == np.repeat(np.minimum.reduceat(away[order], begins), sizes)]
    rows = rows[np.lexsort([ids[rows], *points[rows].T[::-1], leaf[rows]])]
    rows = rows[np.flatnonzero(np.diff(leaf[rows], prepend=-1))]
    others = (points[order] != np.repeat(points[rows], sizes, axis=0)).any(axis=1) | whole.differ[order]
    return Sample(
        leaf[rows],
        points[rows],
        ids[rows],
        away[rows],
        np.add.reduceat(whole.counts[order], begins),
        np.bitwise_or.reduceat(whole.octants[order], begins),
        np.add.reduceat(whole.sums[order], begins),
        np.logical_or.reduceat(others, begins),
    )


def is_thick(sample: Sample) -> Bools:
    """(k,) leaves whose points are no flat piece of a surface: both sides of a thin part, or a slender limb."""
    thick = np.zeros(len(sample), bool)
    rows = np.flatnonzero(sample.counts >= ENOUGH)
    dim = sample.points.shape[1]
    sums = sample.sums[rows] / sample.counts[rows, None]
    spread = np.empty((len(rows), dim, dim))
    for (i, j), products in zip(_pairs(dim), sums[:, dim:].T, strict=True):
        spread[:, i, j] = spread[:, j, i] = products - sums[:, i] * sums[:, j]
    across = np.sqrt(np.maximum(np.linalg.eigvalsh(spread), 0)) / (1 << WITHIN)
    thick[rows] = across[:, 0] > THICK
    if dim == 3:
        thick[rows] |= (across[:, 0] > ROUND * across[:, 1]) & (across[:, 1] < SLENDER) & (across[:, 2] > SLENDER)
    return thick
