"""Whether edges stay in the interior: followed from simplex to simplex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.inner_mesh import InnerMesh
from tetraskel.kernels.medial_nodes import LONGEST_WALK, ON_FACET, barycentric_coordinates, walk_to

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


def stays_inside(inner: InnerMesh, positions: Floats, near: Ints, edges: Ints) -> Bools:
    """(s,) edges that lie in the interior from end to end.

    Parameters
    ----------
    positions : (p, d) float
    near : (p,) int
        A simplex from which the one that holds each point is looked for.
    edges : (s, 2) int
        Pairs of points.
    """
    homes = walk_to(inner.coordinates, inner.simplices, inner.neighbors, near, positions)
    good = homes[edges].min(axis=1, initial=0) >= 0
    followed = np.flatnonzero(good)
    a, b = edges[followed].T
    good[followed] = _follow(inner, homes[a], positions[a], positions[b])
    return good


def _follow(inner: InnerMesh, cells: Ints, start: Floats, end: Floats) -> Bools:
    """Whether each segment, begun in its simplex, reaches its end without leaving the mesh.

    Strategy: all segments step at once, each out of its simplex where it leaves it: there its barycentric
    coordinate of the vertex opposite falls to 0 first.
    """
    at, entered = cells.copy(), np.full(len(cells), -1)
    arrived = np.zeros(len(cells), bool)
    active = np.arange(len(cells))
    for _ in range(LONGEST_WALK):
        if len(active) == 0:
            break
        here = inner.simplices[at[active]]
        first = barycentric_coordinates(inner.coordinates, here, start[active])
        last = barycentric_coordinates(inner.coordinates, here, end[active])
        ahead = inner.neighbors[at[active]]
        arrived[active] = (last >= ON_FACET).all(axis=1)
        leaves = (last < ON_FACET) & (last < first) & ((ahead != entered[active, None]) | (ahead < 0))
        with np.errstate(invalid="ignore"):
            when = np.where(leaves, first / (first - last), np.inf)  # simplices without volume give nan
        way = np.where(np.isnan(when), np.inf, when).argmin(axis=1)
        rows = np.arange(len(active))
        target = np.where(np.isfinite(when[rows, way]), ahead[rows, way], -1)
        going = ~arrived[active] & (target >= 0)
        entered[active], at[active] = at[active], target
        active = active[going]
    return arrived
