"""Whether edges stay in the interior: followed from simplex to simplex."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import ON_FACET, barycentric_coordinates
from tetraskel.kernels.inner_mesh import InnerMesh
from tetraskel.kernels.walking import walk_to

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

LONGEST_EDGE = 5000  # simplices that one edge may cross


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
    good = _is_clear(inner, positions, edges)
    unsure = np.flatnonzero(~good)
    if len(unsure) == 0:
        return good
    points = np.unique(edges[unsure])
    homes = np.full(len(positions), -1, np.int64)
    homes[points] = walk_to(inner.coordinates, inner.simplices, inner.neighbors, near[points], positions[points])
    unsure = unsure[homes[edges[unsure]].min(axis=1) >= 0]
    a, b = edges[unsure].T
    good[unsure] = _follow(inner, homes[a], positions[a], positions[b])
    return good


def _is_clear(inner: InnerMesh, positions: Floats, edges: Ints) -> Bools:
    """Edges too far from every point to cross the boundary.

    No place on the boundary is farther from the nearest point than its widest door, and no place on an edge ab is
    nearer to a point than (r_a + r_b - |ab|) / 2, with r the distances of the ends.
    """
    if len(positions) == 0:
        return np.zeros(len(edges), bool)
    radii = inner.cloud.query(positions)[0]
    a, b = edges.T
    long = np.sqrt(((positions[a] - positions[b]) ** 2).sum(axis=1))
    return np.asarray(0.5 * (radii[a] + radii[b] - long) > inner.widest_door)


def _follow(inner: InnerMesh, cells: Ints, start: Floats, end: Floats) -> Bools:
    """Whether each segment, begun in its simplex, reaches its end without leaving the mesh.

    Strategy: all segments step at once, each out of its simplex where it leaves it: there its barycentric
    coordinate of the vertex opposite falls to 0 first. Among simplices without volume a segment may circle, which is
    noticed as in `walk_to`; it does not arrive.
    """
    at, entered = cells.copy(), np.full(len(cells), -1)
    mark, mark_entered, next_mark = at.copy(), entered.copy(), 1
    arrived = np.zeros(len(cells), bool)
    active = np.arange(len(cells))
    for round_ in range(1, LONGEST_EDGE + 1):
        if len(active) == 0:
            break
        here = inner.simplices[at[active]]
        first = barycentric_coordinates(inner.coordinates, here, start[active])
        last = barycentric_coordinates(inner.coordinates, here, end[active])
        ahead = inner.neighbors[at[active]]
        arrived[active] = (last >= ON_FACET).all(axis=1)
        leaves = (last < ON_FACET) & (last < first) & ((ahead != entered[active, None]) | (ahead < 0))
        with np.errstate(invalid="ignore", divide="ignore"):
            when = np.where(leaves, first / (first - last), np.inf)
        # a simplex without volume has no inside to leave: on through any other facet
        when[np.isneginf(first) & (ahead >= 0) & (ahead != entered[active, None])] = 0.0
        when[np.isnan(when)] = np.inf
        way = when.argmin(axis=1)
        rows = np.arange(len(active))
        target = np.where(np.isfinite(when[rows, way]), ahead[rows, way], -1)
        going = ~arrived[active] & (target >= 0)
        entered[active], at[active] = at[active], target
        active = active[going]
        active = active[(at[active] != mark[active]) | (entered[active] != mark_entered[active])]
        if round_ == next_mark:
            mark[active], mark_entered[active], next_mark = at[active], entered[active], 2 * next_mark
    return arrived


def facets_between(inner: InnerMesh, start: int, stop: int) -> Floats:
    """(k, d) barycentres of the facets on a shortest way, in simplices, from one simplex to another.

    Straight from one to the next, and from and to any place in the two simplices, no edge leaves the interior.
    """
    came_from, queue = {start: -1}, [start]
    for cell in queue:  # grows while it is walked
        if cell == stop:
            break
        for other in inner.neighbors[cell].tolist():
            if other >= 0 and other not in came_from:
                came_from[other] = cell
                queue.append(other)
    way = [stop]
    while way[-1] != start:
        way.append(came_from[way[-1]])
    shared = [np.intersect1d(inner.simplices[a], inner.simplices[b]) for a, b in pairwise(way)]
    middles = [inner.coordinates[points].mean(axis=0) for points in shared[::-1]]
    return np.array(middles).reshape(len(middles), inner.coordinates.shape[1])
