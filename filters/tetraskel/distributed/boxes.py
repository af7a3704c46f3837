"""Boxes around stretches of points, in a binary tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def boxes_of_stretches(points: Floats, starts: Ints) -> Floats:
    """(k, 2 d) lowest and highest corner of the points `starts[j]` to `starts[j+1]`; no stretch is empty."""
    if len(starts) < 2:
        return np.empty((0, 2 * points.shape[1]))
    low = np.minimum.reduceat(points, starts[:-1])
    high = np.maximum.reduceat(points, starts[:-1])
    return np.concatenate([low, high], axis=1)


def even_stretches(n: int, length: int) -> Ints:
    """(k+1,) where stretches of at most `length` of n items begin, and n."""
    return np.append(np.arange(0, n, max(length, 1)), n).astype(np.int64)


def stretches_by_cells(codes: NDArray[np.uint64], length: int, bits: int) -> tuple[Ints, Ints]:
    """Stretches of a Morton curve that each lie in one cell of an octree: compact, where even ones are not.

    A cell with more than `length` points is cut into its eight, down to cells of `bits` bits.

    Returns
    -------
    starts : (k+1,) int
        Where they begin, and n.
    levels : (k,) int
        How often the cube was halved for each.
    """
    starts, levels = np.array([0, len(codes)]), np.zeros(1, np.int64)
    if len(codes) == 0:
        return np.zeros(1, np.int64), np.empty(0, np.int64)
    for level in range(1, bits + 1):
        crowded = np.diff(starts) > length
        if not crowded.any():
            break
        cells = codes >> np.uint64(3 * (bits - level))
        cuts = np.flatnonzero(cells[1:] != cells[:-1]) + 1
        cuts = cuts[crowded[np.searchsorted(starts, cuts, side="right") - 1]]
        levels = np.where(crowded, level, levels)
        merged = np.union1d(starts, cuts)
        levels = levels[np.searchsorted(starts, merged[:-1], side="right") - 1]
        starts = merged
    return starts, levels


def tree_of_boxes(boxes: Floats) -> Floats:
    """(2 l - 1, 2 d) the boxes as the last of a heap in which each node holds its two sons; l is a power of two.

    Leaves without a box are empty: their lowest corner is infinite.
    """
    dim = boxes.shape[1] // 2
    n_leaves = 1
    while n_leaves < len(boxes):
        n_leaves *= 2
    level = np.concatenate([np.full((n_leaves, dim), np.inf), np.full((n_leaves, dim), -np.inf)], axis=1)
    level[: len(boxes)] = boxes
    levels = [level]
    while len(level) > 1:
        low = np.minimum(level[::2, :dim], level[1::2, :dim])
        high = np.maximum(level[::2, dim:], level[1::2, dim:])
        level = np.concatenate([low, high], axis=1)
        levels.append(level)
    return np.ascontiguousarray(np.concatenate(levels[::-1]))
