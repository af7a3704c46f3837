"""Voronoi faces in space: the ring of tetrahedra around each Delaunay edge, in order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_lines import edge_keys_of, split_keys

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Edges (i, j) of a tetrahedron with the two others (k, l), so that (i, j, k, l) is an even permutation: in a positive
# one, k to l is counter-clockwise around i to j.
EDGES = ((0, 1, 2, 3), (0, 2, 3, 1), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 2, 0), (2, 3, 0, 1))


@dataclass(frozen=True)
class VoronoiFaces:
    """Voronoi faces, one for each Delaunay edge, ascending by its points.

    Attributes
    ----------
    keys : (q,) int
        `edge_keys_of` the two generators.
    starts : (q+1,) int
        Where the ring of each face begins in the arrays below.
    cells : (total,) int
        Tetrahedra around the edge: the face's vertices are their circumcentres. Counter-clockwise around the edge from
        its smaller to its larger point once `ordered`.
    behind, ahead : (total,) int
        Half-facets (simplex * 4 + opposite vertex) between each tetrahedron and the one before and after it.
    closed : (q,) bool
        The ring closes; else the face has no end.
    """

    keys: Ints
    starts: Ints
    cells: Ints
    behind: Ints
    ahead: Ints
    closed: Bools

    @property
    def counts(self) -> Ints:
        """(q,) tetrahedra around each edge."""
        return np.diff(self.starts)

    @property
    def generators(self) -> Ints:
        """(q, 2) points of each edge."""
        return np.stack(split_keys(self.keys), axis=1)

    def all_of(self, flags: Bools) -> Bools:
        """(q,) faces all of whose ring has (total,) flags."""
        return np.logical_and.reduceat(flags, self.starts[:-1]) if len(self.keys) else np.empty(0, bool)

    def any_of(self, flags: Bools) -> Bools:
        """(q,) faces some of whose ring has (total,) flags."""
        return np.logical_or.reduceat(flags, self.starts[:-1]) if len(self.keys) else np.empty(0, bool)

    def rows(self, faces: Ints) -> tuple[Ints, Ints]:
        """Places in the rings of some faces, face after face, and where each begins."""
        counts = self.counts[faces]
        starts = np.concatenate([[0], np.cumsum(counts)])
        return np.arange(starts[-1]) + np.repeat(self.starts[faces] - starts[:-1], counts), starts


def voronoi_faces(diagram: VoronoiDiagram, cells: Ints) -> VoronoiFaces:
    """Faces around the edges of some tetrahedra, their rings as far as those tetrahedra go, not yet in order.

    Strategy: every tetrahedron names its six edges; sorting the names brings the rings together.
    """
    simplices, n = diagram.simplices[cells], len(cells)
    keys = np.stack([edge_keys_of(simplices[:, i], simplices[:, j]) for i, j, _, _ in EDGES])
    order = np.argsort(keys.ravel())
    ranked = keys.ravel()[order]
    first = np.flatnonzero(np.diff(ranked, prepend=-1) != 0)
    slot, row = np.divmod(order, n) if n else (order, order)
    # which of the others lies ahead depends on the orientation, of the tetrahedron and of the edge
    swapped = np.stack([simplices[:, i] > simplices[:, j] for i, j, _, _ in EDGES]).ravel()[order]
    swapped ^= (diagram.signs[cells] < 0)[row]
    table = np.array(EDGES)
    third, fourth = table[slot, 2], table[slot, 3]
    back, front = np.where(swapped, third, fourth), np.where(swapped, fourth, third)
    cell = cells[row]
    behind, ahead = cell * np.int64(4) + back, cell * np.int64(4) + front
    starts = np.append(first, len(ranked))
    taken = np.zeros(len(diagram.simplices) + 1, bool)
    taken[cells] = True
    gap = ~taken[diagram.neighbors.ravel()[behind]]
    closed = ~np.logical_or.reduceat(gap, first) if len(first) else np.empty(0, bool)
    return VoronoiFaces(ranked[first], starts, cell, behind, ahead, closed)


def ordered(diagram: VoronoiDiagram, faces: VoronoiFaces, chosen: Ints) -> VoronoiFaces:
    """Some of the faces with their rings counter-clockwise; one without an end begins behind the gap.

    A tetrahedron's place is the angle at which its facet `behind` stands around the Delaunay edge.
    """
    rows, starts = faces.rows(chosen)
    face = np.repeat(np.arange(len(chosen)), np.diff(starts))
    cells, behind, ahead = faces.cells[rows], faces.behind[rows], faces.ahead[rows]
    low, high = faces.generators[chosen].T
    x = diagram.coordinates
    first_way, second_way, _ = frames(x[high] - x[low])
    third = diagram.simplices.ravel()[ahead]  # behind lies the facet with the vertex opposite to the one ahead
    way = x[third] - x[low][face]
    angle = np.arctan2((way * second_way[face]).sum(axis=1), (way * first_way[face]).sum(axis=1))
    open_at = np.flatnonzero(diagram.neighbors.ravel()[behind] < 0)
    zero = np.full(len(chosen), -np.pi)
    zero[face[open_at]] = angle[open_at]
    angle = np.mod(angle - zero[face], 2 * np.pi)
    angle[open_at] = 0.0
    order = np.lexsort([angle, face])
    return VoronoiFaces(faces.keys[chosen], starts, cells[order], behind[order], ahead[order], faces.closed[chosen])


def frames(axes: Floats) -> tuple[Floats, Floats, Floats]:
    """Right-handed orthonormal frames (u, v, w), w along each of (k, 3) axes."""
    w = axes / np.sqrt((axes**2).sum(axis=1, keepdims=True))
    helper = np.eye(3)[np.abs(w).argmin(axis=1)] if len(w) else np.empty((0, 3))
    u = np.cross(helper, w)
    u /= np.sqrt((u**2).sum(axis=1, keepdims=True))
    return u, np.cross(w, u), w
