"""Voronoi faces in space: the ring of tetrahedra around each Delaunay edge, in order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import for_chunks
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
    starts = np.concatenate([[0], np.cumsum(faces.counts[chosen])])
    order = np.empty(starts[-1], np.int64)

    def work(piece: slice) -> None:
        order[starts[piece.start] : starts[piece.stop]] = _by_angle(diagram, faces, chosen[piece])

    for_chunks(work, len(chosen))
    sorted_ = VoronoiFaces(
        faces.keys[chosen], starts, faces.cells[order], faces.behind[order], faces.ahead[order], faces.closed[chosen]
    )
    return _relinked(diagram, sorted_, np.flatnonzero(_broken(diagram, sorted_)))


def _by_angle(diagram: VoronoiDiagram, faces: VoronoiFaces, chosen: Ints) -> Ints:
    """Rows of the rings of some faces, counter-clockwise."""
    rows, starts = faces.rows(chosen)
    face = np.repeat(np.arange(len(chosen)), np.diff(starts))
    behind = faces.behind[rows]
    low, high = split_keys(faces.keys[chosen])
    x = diagram.coordinates
    first_way, second_way, _ = frames(x[high] - x[low])
    third = diagram.simplices.ravel()[faces.ahead[rows]]  # the facet behind holds the vertex opposite to the one ahead
    way = x[third] - x[low][face]
    angle = np.arctan2(np.einsum("ka,ka->k", way, second_way[face]), np.einsum("ka,ka->k", way, first_way[face]))
    open_at = np.flatnonzero(diagram.neighbors.ravel()[behind] < 0)
    zero = np.full(len(chosen), -np.pi)
    zero[face[open_at]] = angle[open_at]
    angle = np.mod(angle - zero[face], 2 * np.pi)
    angle[open_at] = 0.0
    return np.asarray(rows[np.argsort(8.0 * face + angle)])  # one key, several times faster to sort by than two


def _broken(diagram: VoronoiDiagram, faces: VoronoiFaces) -> Bools:
    """(q,) faces whose ring does not go from neighbour to neighbour: angles of flat tetrahedra are rounding."""
    after = np.arange(1, len(faces.cells) + 1)
    last = faces.starts[1:] - 1
    after[last] = faces.starts[:-1]
    beyond, before = diagram.neighbors.ravel()[faces.ahead], diagram.neighbors.ravel()[faces.behind]
    linked = (beyond == faces.cells[after]) & (before[after] == faces.cells)
    ends = last[~faces.closed]
    linked[ends] = (beyond[ends] < 0) & (before[after[ends]] < 0)
    return ~faces.all_of(linked)


def _relinked(diagram: VoronoiDiagram, faces: VoronoiFaces, broken: Ints) -> VoronoiFaces:
    """The faces with the rings of `broken` ones followed from neighbour to neighbour, all at once."""
    if len(broken) == 0:
        return faces
    rows, starts = faces.rows(broken)
    face = np.repeat(np.arange(len(broken)), np.diff(starts))
    sides = np.stack([faces.ahead[rows], faces.behind[rows]], axis=1)
    beside = _rows_of(diagram.neighbors.ravel()[sides], faces.cells[rows], face, len(diagram.simplices))
    first = starts[:-1].copy()
    at_gap = np.flatnonzero((beside < 0).any(axis=1))
    first[face[at_gap]] = at_gap
    order, by_second = np.empty(len(rows), np.int64), np.zeros(len(rows), bool)
    here, came, counts = first, np.full(len(broken), -1), np.diff(starts)
    for step in range(int(counts.max())):
        walking = np.flatnonzero(counts > step)
        now = here[walking]
        back = (beside[now, 0] == came[walking]) if step else beside[now, 0] < 0
        order[starts[walking] + step], by_second[starts[walking] + step] = now, back
        came[walking], here[walking] = now, beside[now, back.astype(np.int64)]
        here[walking] = np.where(here[walking] < 0, now, here[walking])
    solid = diagram.signs[faces.cells[rows[order]]] != 0
    backwards = np.bincount(face, np.where(solid, np.where(by_second, 1, -1), 0), minlength=len(broken)) > 0
    turned = backwards[face]
    place = np.where(turned, starts[face] + starts[face + 1] - 1 - np.arange(len(rows)), np.arange(len(rows)))
    order, by_second = order[place], by_second[place] ^ turned
    cells, behind, ahead = faces.cells.copy(), faces.behind.copy(), faces.ahead.copy()
    cells[rows] = faces.cells[rows[order]]
    ahead[rows] = sides[order, by_second.astype(np.int64)]
    behind[rows] = sides[order, 1 - by_second.astype(np.int64)]
    return VoronoiFaces(faces.keys, faces.starts, cells, behind, ahead, faces.closed)


def _rows_of(wanted: Ints, cells: Ints, face: Ints, n_cells: int) -> Ints:
    """(k, 2) rows of the wanted cells (k, 2) in the ring of each row's face, -1 where they are not in it."""
    keys = face * np.int64(n_cells) + cells
    by_key = np.argsort(keys)
    asked = face[:, None] * np.int64(n_cells) + wanted
    place = np.minimum(np.searchsorted(keys[by_key], asked), len(keys) - 1)
    found = by_key[place]
    return np.where((keys[found] == asked) & (wanted >= 0), found, -1)


def frames(axes: Floats) -> tuple[Floats, Floats, Floats]:
    """Right-handed orthonormal frames (u, v, w), w along each of (k, 3) axes."""
    w = axes / np.sqrt((axes**2).sum(axis=1, keepdims=True))
    helper = np.eye(3)[np.abs(w).argmin(axis=1)] if len(w) else np.empty((0, 3))
    u = np.cross(helper, w)
    u /= np.sqrt((u**2).sum(axis=1, keepdims=True))
    return u, np.cross(w, u), w
