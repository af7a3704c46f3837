"""Fewer edges for the same solid: runs of edges that are straight, and taper evenly, become one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.ball_graph import BallGraph
from tetraskel.kernels.curve_skeleton import line_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


def straightened(branches: BallGraph, tolerance: float) -> tuple[Ints, Ints]:
    """(s, 2) edges between points, and the branch of each; their balls are within `tolerance` of those of the branches.

    Strategy: runs of 2, 4, 8, ... edges from the beginning of a branch, where both halves are already one edge and
    every point between lies on the new one within the tolerance, its place and its radius taken together.
    """
    ids, offsets = branches.connectivity, branches.offsets
    sizes = np.diff(offsets)
    place = np.arange(len(ids)) - np.repeat(offsets[:-1], sizes)
    last = np.repeat(sizes - 1, sizes)
    stays = np.ones(len(ids), bool)
    run = 2
    while run < sizes.max(initial=0):
        start = np.flatnonzero((place % run == 0) & (place + run <= last))
        start = start[_is_one_edge(stays, start, run // 2) & _is_one_edge(stays, start + run // 2, run // 2)]
        start = start[_deviation(branches, start, run) <= tolerance]
        if len(start) == 0:
            break
        stays[start + run // 2] = False
        run *= 2
    left = np.add.reduceat(stays, offsets[:-1]) if len(sizes) else sizes
    edges = line_edges(np.concatenate([[0], np.cumsum(left)]).astype(np.int64), ids[stays])
    return edges, np.repeat(np.arange(len(left)), np.maximum(left - 1, 0))


def _is_one_edge(stays: Bools, start: Ints, run: int) -> Bools:
    """(k,) nothing is left between the ends of a run."""
    total = np.concatenate([[0], np.cumsum(stays)])
    return total[start + run] == total[start + 1]


def _deviation(branches: BallGraph, start: Ints, run: int) -> Floats:
    """(k,) largest change of any point between the ends of a run by becoming one edge, its radius included."""
    balls = np.column_stack([branches.points, branches.radius])[branches.connectivity]
    first, way = balls[start], balls[start + run] - balls[start]
    square = np.maximum((way**2).sum(axis=1), 1e-300)
    worst = np.zeros(len(start))
    for step in range(1, run):
        away = balls[start + step] - first
        share = np.clip((away * way).sum(axis=1) / square, 0, 1)
        off = away - share[:, None] * way
        worst = np.maximum(worst, np.sqrt((off[:, :-1] ** 2).sum(axis=1)) + np.abs(off[:, -1]))
    return worst
