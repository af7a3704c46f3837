"""Voronoi faces in space: the ring of tetrahedra around each Delaunay edge, in order."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.loops_in_python import call_compiled, gather_compiled
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_lines import edge_keys_of, found_in, ranges, split_keys

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Edges (i, j) of a tetrahedron with the two others (k, l), so that (i, j, k, l) is an even permutation: in a positive
# one, k to l is counter-clockwise around i to j.
EDGES = ((0, 1, 2, 3), (0, 2, 3, 1), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 2, 0), (2, 3, 0, 1))


# A wedge is a tetrahedron at one of its edges, as 16 * tetrahedron + 2 * row of EDGES + whether the others change
# places: l is ahead and k behind then, else k ahead and l behind.
WEDGE_BITS = 4
AHEAD = np.array([side for edge in EDGES for side in (edge[2], edge[3])] + [0] * 4)
BEHIND = np.array([side for edge in EDGES for side in (edge[3], edge[2])] + [0] * 4)
MOST_BITS = 63
LONGEST_RING = 32  # longer rings are rare, and comparing each of their tetrahedra with each other is slow


@dataclass(frozen=True)
class VoronoiFaces:
    """Voronoi faces, one for each Delaunay edge, ascending by its points.

    Attributes
    ----------
    keys : (q,) int
        `edge_keys_of` the two generators.
    starts : (q+1,) int
        Where the ring of each face begins in the wedges.
    wedges : (total,) int
        Tetrahedra around the edge: the face's vertices are their circumcentres. Counter-clockwise around the edge from
        its smaller to its larger point once `ordered`, else ascending.
    """

    keys: Ints
    starts: Ints
    wedges: Ints

    @property
    def counts(self) -> Ints:
        """(q,) tetrahedra around each edge."""
        return np.diff(self.starts)

    @property
    def generators(self) -> Ints:
        """(q, 2) points of each edge."""
        return np.stack(split_keys(self.keys), axis=1)

    @cached_property
    def cells(self) -> Ints:
        """(total,) tetrahedron of each wedge."""
        return self.wedges >> WEDGE_BITS

    @property
    def ahead(self) -> Ints:
        """(total,) half-facets (simplex * 4 + opposite vertex) between each tetrahedron and the one after it."""
        return _half_facets(self.wedges, AHEAD)

    @property
    def behind(self) -> Ints:
        """(total,) half-facets between each tetrahedron and the one before it."""
        return _half_facets(self.wedges, BEHIND)

    def any_of(self, flags: Bools) -> Bools:
        """(q,) faces some of whose ring has (total,) flags."""
        found = np.concatenate([[0], np.cumsum(flags)])[self.starts]
        return np.asarray(found[1:] > found[:-1])

    def rows(self, faces: Ints) -> tuple[Ints, Ints]:
        """Places in the rings of some faces, face after face, and where each begins."""
        counts = self.counts[faces]
        starts = np.concatenate([[0], np.cumsum(counts)])
        return ranges(self.starts[faces], counts), starts

    def rings(self, piece: slice) -> tuple[Ints, Ints]:
        """Starts and wedges of consecutive faces alone."""
        starts = self.starts[piece.start : piece.stop + 1]
        return starts - starts[0], self.wedges[starts[0] : starts[-1]]

    def some(self, faces: Ints) -> VoronoiFaces:
        """Some of the faces."""
        rows, starts = self.rows(faces)
        return VoronoiFaces(self.keys[faces], starts, self.wedges[rows])


def _half_facets(wedges: Ints, opposite: Ints) -> Ints:
    return np.asarray((wedges >> WEDGE_BITS) * 4 + opposite[wedges & (2**WEDGE_BITS - 1)])


def facets_beside(wedges: Ints, n_simplices: int) -> Bools:
    """(m, 4) facets of tetrahedra that lie at one of their edges in some wedges."""
    found = call_compiled("voronoi_loops.facets_beside", (wedges, n_simplices))
    if found is not None:
        return np.asarray(found)
    result = np.zeros(4 * n_simplices, bool)
    result[_half_facets(wedges, AHEAD)] = result[_half_facets(wedges, BEHIND)] = True
    return result.reshape(-1, 4)


def closed_faces(diagram: VoronoiDiagram, wanted: Bools, tick: Tick = silent) -> VoronoiFaces:
    """Faces all of whose wedges are wanted, and whose rings close, counter-clockwise, from the first tetrahedron.

    Parameters
    ----------
    wanted : (m, 6) bool
        Tetrahedra at their edges, in the order of EDGES.
    """
    faces, ended, misled = _rings(diagram, wanted, np.empty(0, np.int64), tick, every=True)
    doubtful: Ints = np.flatnonzero(misled)
    beside, starts = _beside(diagram, faces, doubtful)[1:]
    gaps = np.concatenate([[0], np.cumsum((beside < 0).any(axis=1))])[starts]
    ended[doubtful[gaps[1:] > gaps[:-1]]] = True
    if ended.any():
        kept = np.flatnonzero(~ended)
        faces, misled = faces.some(kept), misled[kept]
    return _relinked(diagram, faces, np.flatnonzero(misled))


def ordered_faces(diagram: VoronoiDiagram, wanted: Bools, also: Ints, tick: Tick = silent) -> VoronoiFaces:
    """Faces one of whose wedges is wanted, and those of some keys, ascending, with their rings counter-clockwise.

    A ring begins with the first tetrahedron, one without an end behind its gap.
    """
    faces, ended, misled = _rings(diagram, wanted, also, tick, every=False)
    return _relinked(diagram, faces, np.flatnonzero(ended | misled))


def _rings(
    diagram: VoronoiDiagram, wanted: Bools, also: Ints, tick: Tick, every: bool
) -> tuple[VoronoiFaces, Bools, Bools]:
    """The faces with their rings followed ahead as far as they close; which have an end, and which are misled."""
    if diagram.stars is None:
        return _walked(diagram, _faces_of_all(diagram, wanted) if every else _faces_of_any(diagram, wanted, also))
    given = (diagram.simplices, diagram.neighbors, diagram.signs, *diagram.stars, wanted)

    def arguments_of(piece: slice) -> tuple:
        first, last = np.searchsorted(also, np.array([piece.start, piece.stop], np.int64) << 32)
        return (*given, also[first:last], every, piece.start, piece.stop)

    found = gather_compiled("voronoi_loops.rings", arguments_of, len(diagram.coordinates), tick)
    keys, counts, wedges, ended, misled = found
    return VoronoiFaces(keys, np.concatenate([[0], np.cumsum(counts)]), wedges), ended, misled


def _faces_of_all(diagram: VoronoiDiagram, wanted: Bools) -> VoronoiFaces:
    """Faces all of whose wedges are wanted; some of others too, which do not close without the rest."""
    faces = _faces_as_far(diagram, wanted)
    if (diagram.signs == 0).any():  # flat simplices may lie around an edge twice, and it close without them
        faces = faces.some(np.flatnonzero(~found_in(faces.keys, _faces_as_far(diagram, ~wanted).keys)))
    return faces


def _faces_of_any(diagram: VoronoiDiagram, wanted: Bools, also: Ints) -> VoronoiFaces:
    """Faces one of whose wedges is wanted, and those of some keys."""
    x = diagram.simplices
    keys = [edge_keys_of(x[wanted[:, s], i], x[wanted[:, s], j]) for s, (i, j, _, _) in enumerate(EDGES)]
    asked = np.concatenate([*keys, also])
    at_end = np.zeros(len(diagram.coordinates), bool)
    for end in split_keys(asked):
        at_end[end] = True
    around = at_end[x]
    faces = _faces_as_far(diagram, np.stack([around[:, i] & around[:, j] for i, j, _, _ in EDGES], axis=1))
    return faces.some(np.flatnonzero(found_in(faces.keys, asked)))


def _faces_as_far(diagram: VoronoiDiagram, wanted: Bools) -> VoronoiFaces:
    """Faces around edges of tetrahedra, their rings as far as the wanted wedges go, not yet in order.

    Strategy: every tetrahedron names its edges; sorting the names brings the rings together. Where edge and wedge fit
    into one number, the numbers alone are sorted, which is several times faster than to find their order.
    """
    edge_bits = max(len(diagram.coordinates) - 1, 1).bit_length()
    wedge_bits = max(len(diagram.simplices), 1).bit_length() + WEDGE_BITS
    in_one = 2 * edge_bits + wedge_bits <= MOST_BITS
    names, wedges = [], []
    negative = diagram.signs < 0
    for slot, (i, j, _, _) in enumerate(EDGES):
        cells = np.flatnonzero(wanted[:, slot])
        first, second = diagram.simplices[cells, i].astype(np.int64), diagram.simplices[cells, j].astype(np.int64)
        swapped = (first > second) ^ negative[cells]
        wedge = cells << WEDGE_BITS
        wedge += 2 * slot
        wedge += swapped
        name = np.minimum(first, second) << edge_bits
        name |= np.maximum(first, second)
        names.append((name << wedge_bits) | wedge if in_one else name)
        wedges.append(wedge)
    ranked, ring = _sorted(np.concatenate(names), np.concatenate(wedges), wedge_bits if in_one else 0)
    begins = np.flatnonzero(np.diff(ranked, prepend=-1) != 0)
    keys = ((ranked[begins] >> edge_bits) << 32) | (ranked[begins] & ((1 << edge_bits) - 1))
    return VoronoiFaces(keys, np.append(begins, len(ranked)), ring)


def _sorted(names: Ints, wedges: Ints, wedge_bits: int) -> tuple[Ints, Ints]:
    """Names ascending, with their wedges, ascending among equal names; both are in the names if these have the bits."""
    if wedge_bits:
        names.sort()
        return names >> wedge_bits, names & ((1 << wedge_bits) - 1)
    order = np.lexsort([wedges, names])
    return names[order], wedges[order]


def _walked(diagram: VoronoiDiagram, faces: VoronoiFaces) -> tuple[VoronoiFaces, Bools, Bools]:
    """The faces with their rings followed ahead, and whose do not close.

    Returns
    -------
    faces : VoronoiFaces
        As before where the ring does not close.
    ended : (q,) bool
        The ring has an end.
    misled : (q,) bool
        It does not close though every tetrahedron has one ahead: flat ones do not tell ahead from behind.
    """
    counts = faces.counts
    wedges = faces.wedges.copy()
    ended, misled = np.zeros(len(counts), bool), np.zeros(len(counts), bool)
    by_count = np.argsort(np.minimum(counts, LONGEST_RING + 1).astype(np.uint8), kind="stable")
    bounds = np.searchsorted(counts[by_count], np.arange(LONGEST_RING + 2))
    misled[by_count[bounds[-1] :]] = True

    def work(piece: slice, chosen: Ints, count: int) -> None:
        some = chosen[piece]
        rows = faces.starts[some] + np.arange(count)[:, None]
        wedges[rows], ended[some], misled[some] = _follow(diagram, faces.wedges[rows])

    for count in range(1, LONGEST_RING + 1):
        chosen = by_count[bounds[count] : bounds[count + 1]]
        for_chunks(partial(work, chosen=chosen, count=count), len(chosen))
    return VoronoiFaces(faces.keys, faces.starts, wedges), ended, misled


def _follow(diagram: VoronoiDiagram, rings: Ints) -> tuple[Ints, Bools, Bools]:
    """(count, k) rings, one per column, each wedge before the one ahead of it; which have an end, and which are misled.

    Strategy: all tetrahedra of a ring are compared with all that lie ahead of one, a row with a row.
    """
    count, k = rings.shape
    cells = (rings >> WEDGE_BITS).astype(np.int32)
    wanted = diagram.neighbors.ravel()[_half_facets(rings, AHEAD)].astype(np.int32)
    after = np.zeros((count, k), np.int8)  # row of the next one, from 1 on
    for row in range(count):
        after += (cells[row] == wanted).view(np.int8) * np.int8(row + 1)
    ended = (after == 0).any(axis=0)
    result = rings.copy()
    column, at, closes = np.arange(k), np.zeros(k, np.int64), ~ended
    for row in range(1, count):
        at = np.maximum(after.ravel()[at * k + column].astype(np.int64) - 1, 0)
        closes &= at > 0
        result[row] = rings.ravel()[at * k + column]
    closes &= after.ravel()[at * k + column] == 1
    closes &= count > 2  # one flat one turned the wrong way, and two look at each other
    return np.where(closes, result, rings), ended, ~closes & ~ended


def _beside(diagram: VoronoiDiagram, faces: VoronoiFaces, chosen: Ints) -> tuple[Ints, Ints, Ints]:
    """Of the wedges of some faces: their rows, those of the wedges ahead and behind (k, 2) among them, -1 where there
    is none, and where each face begins.
    """
    rows, starts = faces.rows(chosen)
    face = np.repeat(np.arange(len(chosen)), np.diff(starts))
    wedges = faces.wedges[rows]
    sides = np.stack([_half_facets(wedges, AHEAD), _half_facets(wedges, BEHIND)], axis=1)
    cells = wedges >> WEDGE_BITS
    return rows, _rows_of(diagram.neighbors.ravel()[sides], cells, face, len(diagram.simplices)), starts


def _relinked(diagram: VoronoiDiagram, faces: VoronoiFaces, broken: Ints) -> VoronoiFaces:
    """The faces with the rings of `broken` ones followed from neighbour to neighbour, all at once."""
    if len(broken) == 0:
        return faces
    rows, beside, starts = _beside(diagram, faces, broken)
    face = np.repeat(np.arange(len(broken)), np.diff(starts))
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
    votes = np.where(by_second, 1, -1) * np.where(solid, len(rows) + 1, 1)  # the flat ones say what they can
    backwards = np.bincount(face, votes, minlength=len(broken)) > 0
    turned = backwards[face]
    place = np.where(turned, starts[face] + starts[face + 1] - 1 - np.arange(len(rows)), np.arange(len(rows)))
    order, by_second = order[place], by_second[place] ^ turned
    wedges = faces.wedges.copy()
    wedges[rows] = faces.wedges[rows[order]] ^ by_second  # the last bit tells ahead from behind
    return VoronoiFaces(faces.keys, faces.starts, wedges)


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
    w = axes / np.sqrt(dots(axes, axes))[:, None]
    helper = np.eye(3)[np.abs(w).argmin(axis=1)] if len(w) else np.empty((0, 3))
    u = np.cross(helper, w)
    u /= np.sqrt(dots(u, u))[:, None]
    return u, np.cross(w, u), w
