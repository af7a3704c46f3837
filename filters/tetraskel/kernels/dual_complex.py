"""The dual of an interior mesh as a cell complex: simplices are its points, facets its edges, rings its faces.

The complex is homotopy equivalent to the open interior: a 0-cell per simplex, a 1-cell per facet between two
simplices, a 2-cell per ridge (edge of tetrahedra, vertex of triangles) whose ring of simplices closes, and in 3D a
3-cell per vertex inside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.loops_in_python import call_compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

FACET_SECONDS, RING_SECONDS = 5e-8, 2e-7  # per cell, compiled; for the progress bar only


@dataclass(frozen=True)
class DualComplex:
    """Cells and their incidences.

    Attributes
    ----------
    n_nodes : int
        0-cells, the simplices.
    facets : (f, 2) int
        The two simplices of each 1-cell, smaller id first, in lexicographic order of (first simplex, vertex).
    facet_ridges : (f, d) int
        2-cells around each 1-cell, -1 where the ridge lies on the boundary.
    ring_start : (r+1,) int
        Where the ring of each 2-cell begins in `ring_facets`.
    ring_facets : (total,) int
        1-cells of each 2-cell, in ascending order.
    ridge_points : (r, d-1) int
        Mesh points of each 2-cell.
    inner_points : (v,) int
        Mesh points that are 3-cells (none in 2D).
    """

    n_nodes: int
    facets: Ints
    facet_ridges: Ints
    ring_start: Ints
    ring_facets: Ints
    ridge_points: Ints
    inner_points: Ints

    @property
    def n_ridges(self) -> int:
        """Number of 2-cells."""
        return len(self.ring_start) - 1

    @property
    def euler_characteristic(self) -> int:
        """Alternating sum of the numbers of cells."""
        return self.n_nodes - len(self.facets) + self.n_ridges - len(self.inner_points)


@dataclass(frozen=True)
class Facets:
    """The facets of an interior mesh.

    Attributes
    ----------
    between : (f, 2) int
        The two simplices of each facet between simplices, smaller id first, in lexicographic order of (first simplex,
        vertex opposite).
    points : (f, d) int
        Their points, ascending.
    outer : (g, d) int
        Points of the facets on the boundary, ascending, in the same order.
    """

    between: Ints
    points: Ints
    outer: Ints


def facets_of(simplices: Ints, neighbors: Ints, tick: Tick = silent) -> Facets:
    """The facets between simplices, and those on the boundary.

    Parameters
    ----------
    simplices, neighbors : (m, d+1) int
        The points of each ascending; -1 beyond the boundary.
    """
    if simplices.shape[1] == 4:
        found = call_compiled("incidence_loops.facets_of", (simplices, neighbors), tick, FACET_SECONDS * len(simplices))
        if found is not None:
            return Facets(*found)
    cells, opposite = np.nonzero(neighbors > np.arange(len(neighbors), dtype=neighbors.dtype)[:, None])
    between = np.stack([cells, neighbors[cells, opposite]], axis=1).astype(np.int32)
    points = _without(simplices[cells], opposite)
    cells, opposite = np.nonzero(neighbors < 0)
    tick(1.0)
    return Facets(between, points, _without(simplices[cells], opposite))


def dual_complex(simplices: Ints, facets: Facets, n_points: int, tick: Tick = silent) -> DualComplex:
    """Cells of the dual of an interior mesh.

    Parameters
    ----------
    simplices : (m, d+1) int
    facets : Facets
        Of the simplices.
    n_points : int
    """
    m, width = simplices.shape
    on_boundary, used = np.zeros(n_points, bool), np.zeros(n_points, bool)
    on_boundary[facets.outer], used[simplices] = True, True
    inner = np.flatnonzero(used & ~on_boundary) if width == 4 else np.empty(0, np.int64)
    tick(0.1)
    rings = _rings_of_edges if width == 4 else _rings_of_points
    return DualComplex(m, facets.between, *rings(facets, n_points, part(tick, 0.1, 1.0)), inner)


def _without(simplices: Ints, column: Ints) -> Ints:
    """(k, d) the vertices of each simplex but the one in its `column`, ascending."""
    width = simplices.shape[1]
    kept = simplices[np.arange(width)[None, :] != column[:, None]].reshape(len(simplices), width - 1)
    return np.sort(kept, axis=1)


def edge_keys(triangles: Ints) -> NDArray[np.int64]:
    """(k, 3) one number per edge of triangles with ascending vertices."""
    low, middle, high = triangles.astype(np.int64).T
    return np.stack([(low << 32) | middle, (low << 32) | high, (middle << 32) | high], axis=1)


def _rings_of_edges(facets: Facets, n_points: int, tick: Tick) -> tuple[Ints, Ints, Ints, Ints]:
    """Ridges of each facet, rings of each ridge, and the ridges' points, of a mesh of tetrahedra."""
    arguments = (facets.points, facets.outer, n_points)
    found = call_compiled("incidence_loops.rings", arguments, tick, RING_SECONDS * len(facets.points))
    if found is not None:
        facet_ridges, ring_start, ring_facets, ridge_points = found
        return facet_ridges, ring_start, ring_facets, ridge_points
    ridges, start, around, keys = _rings(edge_keys(facets.points), np.unique(edge_keys(facets.outer)), tick)
    return ridges, start, around, np.stack(np.divmod(keys, np.int64(1) << 32), axis=1)


def _rings_of_points(facets: Facets, n_points: int, tick: Tick) -> tuple[Ints, Ints, Ints, Ints]:
    """The same of a mesh of triangles, in which a ridge is a point."""
    ridges, start, around, points = _rings(facets.points, np.unique(facets.outer), tick)
    return ridges, start, around, points[:, None]


def _rings(keys: Ints, open_keys: Ints, tick: Tick) -> tuple[Ints, Ints, Ints, Ints]:
    """Ridges of each facet, rings of each ridge, and the keys of the ridges, ascending.

    Strategy: sorting the keys of all facets' ridges brings the facets around one ridge together; ridges on the
    boundary are then looked up and left out.
    """
    flat = keys.ravel()
    order = np.argsort(flat, kind="stable")
    tick(0.7)
    ranked = flat[order]
    first = np.flatnonzero(np.r_[True, ranked[1:] != ranked[:-1]]) if len(flat) else np.empty(0, np.int64)
    ridges = ranked[first]
    sizes = np.diff(np.r_[first, len(flat)])
    place = np.searchsorted(open_keys, ridges)
    closed = np.ones(len(ridges), bool)
    within = place < len(open_keys)
    closed[within] = open_keys[place[within]] != ridges[within]
    number = np.where(closed, np.cumsum(closed) - 1, -1).astype(np.int32)
    facet_ridges = np.empty(len(flat), np.int32)
    facet_ridges[order] = np.repeat(number, sizes)
    in_ring = np.repeat(closed, sizes)
    ring_start = np.concatenate([[0], np.cumsum(sizes[closed])])
    ring_facets = (order[in_ring] // keys.shape[1]).astype(np.int32)
    return facet_ridges.reshape(keys.shape), ring_start, ring_facets, ridges[closed]
