"""Where the Voronoi diagram of the points crosses the object's boundary, which is made of Delaunay facets."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.boundary_division import (
    Met,
    Segments,
    no_segments,
    on_edges,
    on_edges_compiled,
    on_triangles,
    on_triangles_compiled,
)
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.loops_in_python import call_compiled
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram, outward_normals
from tetraskel.kernels.voronoi_lines import (
    Neighbours,
    edge_keys_of,
    found_in,
    grid_keys,
    ranges,
    split_keys,
    unique_edges,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Crossings of one edge closer than this share of the bounding-box diagonal are one.
SAME = 1e-9
LIKELY_BITS = 22
# An edge that meets the boundary within this share of its length from an end does so at that end: the end lies on the
# boundary up to rounding.
AT_END = 1e-9
LOST = np.iinfo(np.int64).min  # the end of a segment where cells only touch


@dataclass(frozen=True)
class Crossings:
    """Places where Voronoi edges, and in space Voronoi faces, cross the boundary.

    Attributes
    ----------
    edges : (k,) int
        Voronoi edges, ascending, and along each from its first end to its second.
    places : (k,) float
        Share of the way from the first end to the second.
    positions : (k, d) float
    entering : (k,) bool
        The edge comes into the object, seen from its first end; else it leaves.
    sure : (k,) bool
        The edge goes through a boundary facet, not through its border, which it may merely touch.
    touching : (m + h,) bool
        Positions of the diagram that lie on the boundary, up to rounding; in general position there are none. Nothing
        follows from such a vertex for those it is joined to.
    segments : Segments
        Straight pieces of the boundary on Voronoi faces; their ends are crossings instead of rows of `Met`, or `LOST`.
    by_face : (s,) int
        The segments in the order of their faces.
    """

    edges: Ints
    places: Floats
    positions: Floats
    entering: Bools
    sure: Bools
    touching: Bools
    segments: Segments
    by_face: Ints

    @cached_property
    def faces(self) -> Ints:
        """(s,) faces of the segments, ascending."""
        return self.segments.faces[self.by_face]

    def of_faces(self, keys: Ints) -> Ints:
        """(q, 2) where in `by_face` the segments of faces begin and end."""
        return np.stack([np.searchsorted(self.faces, keys, side) for side in ("left", "right")], axis=1)

    def segments_of(self, bounds: Ints) -> tuple[Ints, Ints]:
        """Row of the face of each of their segments, and the segments, of what `of_faces` found."""
        counts = bounds[:, 1] - bounds[:, 0]
        return np.repeat(np.arange(len(counts)), counts), self.by_face[ranges(bounds[:, 0], counts)]


def find_crossings(diagram: VoronoiDiagram, tick: Tick = silent) -> Crossings:
    """Every place where the diagram crosses the object's boundary, in the plane and in space."""
    cells, opposite = _boundary(diagram)
    facets = _corners(diagram.simplices, cells, opposite)
    outward = outward_normals(diagram.coordinates, diagram.simplices, cells, opposite)
    if diagram.stars is not None:
        around = (diagram.coordinates, diagram.simplices, *diagram.stars)
        if diagram.dim == 3:
            return _sorted(diagram, *on_triangles_compiled(around, SAME * diagram.size, facets, outward, tick))
    keys = unique_edges(facets) if len(facets) else np.empty(0, np.int64)
    if diagram.stars is not None:
        lines, pairs, places = on_edges_compiled(around, keys)
    else:
        asked = np.zeros(len(diagram.coordinates), bool)
        asked[facets] = True
        neighbours = Neighbours(diagram.coordinates, diagram.simplices, asked)
        lines, pairs, places = on_edges(neighbours, keys, tick)
    low, high = split_keys(keys[lines])
    start, stop = diagram.coordinates[low], diagram.coordinates[high]
    positions = start + places[:, None] * (stop - start)
    if diagram.dim == 2:
        of_edge = np.empty(len(keys), np.int64)
        of_edge[np.searchsorted(keys, edge_keys_of(*facets.T))] = np.arange(len(facets))
        normals = outward[of_edge[lines]]
        met = Met(np.stack(split_keys(pairs), axis=1), positions, normals, np.ones(len(pairs), bool))
        return _sorted(diagram, met, no_segments(2))
    return _sorted(diagram, *on_triangles(neighbours, facets, outward, (keys, lines, pairs), tick))


def _boundary(diagram: VoronoiDiagram) -> tuple[Ints, Ints]:
    """Simplices of the object and their vertices opposite to the boundary."""
    labels = np.append(diagram.inside, False)
    rows = np.flatnonzero(diagram.inside)
    place, opposite = np.nonzero(~labels[diagram.neighbors[rows]])
    return rows[place], opposite


def _corners(simplices: Ints, cells: Ints, opposite: Ints) -> Ints:
    width = simplices.shape[1]
    kept = np.arange(width)[None, :] != opposite[:, None]
    return np.sort(simplices[cells][kept].reshape(len(cells), width - 1), axis=1)


def _sorted(diagram: VoronoiDiagram, met: Met, segments: Segments) -> Crossings:
    """Crossings in canonical order; those of generators that share no Voronoi edge (they only touch) are left out."""
    edges = _edges_of(diagram, met.generators)
    kept = edges >= 0
    edges, positions, normals, sure = edges[kept], met.positions[kept], met.normals[kept], met.sure[kept]
    start, stop = (diagram.positions[diagram.ends[edges, k]] for k in (0, 1))
    way = stop - start
    length = np.einsum("ka,ka->k", way, way)
    places = np.einsum("ka,ka->k", positions - start, way) / np.where(length == 0, 1.0, length)
    entering = np.einsum("ka,ka->k", way, normals) < 0
    spots = _spots(diagram, edges, places, positions)
    order = _ranked(spots, np.zeros(len(spots)), entering, len(spots))
    edges, places, positions = edges[order], np.clip(places[order], 0.0, 1.0), positions[order]
    entering, sure, spot = entering[order], sure[order], spots[order]
    # each of the cells that meet there has found the place, and where it is on a border, on both sides of that
    first = np.ones(len(edges), bool)
    first[1:] = (spot[1:] != spot[:-1]) | (entering[1:] != entering[:-1])
    once = np.flatnonzero(first)
    sure = np.logical_or.reduceat(sure, once) if len(once) else sure
    chosen = _first_places(positions, once)
    places, positions = places[chosen], positions[chosen]
    both = np.flatnonzero(np.diff(spot[once]) == 0)  # ways in and out at one spot have one place
    places[both + 1] = places[both]
    touching = _touched(diagram, positions[(places <= AT_END) | (places >= 1 - AT_END) | ~sure])
    number = np.full(len(kept), LOST)
    number[np.flatnonzero(kept)[order]] = np.cumsum(first) - 1
    ends = segments.ends.copy()
    rows = ends >= 0
    ends[rows] = number[ends[rows]]
    low, high = split_keys(segments.faces)
    by_face = _ranked(low, high.astype(float), np.zeros(len(low), bool), len(diagram.coordinates))
    segments = segments._replace(ends=ends)
    return Crossings(edges[once], places, positions, entering[once], sure, touching, segments, by_face)


def _spots(diagram: VoronoiDiagram, edges: Ints, places: Floats, positions: Floats) -> Ints:
    """A number for each place, ascending by edges and along these; the same where they differ by rounding."""
    order = _ranked(edges, places, np.zeros(len(edges), bool), len(diagram.ends))
    step = np.diff(positions[order], axis=0)
    apart = np.ones(len(edges), bool)
    apart[1:] = (np.diff(edges[order]) != 0) | (np.sqrt(dots(step, step)) > SAME * diagram.size)
    result = np.empty(len(edges), np.int64)
    result[order] = np.cumsum(apart) - 1
    return result


def _first_places(positions: Floats, begins: Ints) -> Ints:
    """The row of the first position, in lexicographic order, of each run of rows."""
    counts = np.diff(np.append(begins, len(positions)))
    result, several = begins.copy(), np.flatnonzero(counts > 1)
    run = np.repeat(several, counts[several])
    rows = ranges(begins[several], counts[several])
    order = np.lexsort([*positions[rows].T[::-1], run])
    ahead = order[np.diff(run[order], prepend=-1) != 0]
    result[run[ahead]] = rows[ahead]
    return result


def _touched(diagram: VoronoiDiagram, touched: Floats) -> Bools:
    """(m + h,) positions of the diagram that are among some places, up to rounding."""
    if len(touched) == 0:
        return np.zeros(len(diagram.positions), bool)
    step = AT_END * diagram.size
    beside = np.sort(touched[:, 0])  # few: hardly a position is as far along the first axis as one of them
    place = np.searchsorted(beside, diagram.positions[:, 0] - 2 * step)
    near = np.flatnonzero(np.append(beside, np.inf)[place] <= diagram.positions[:, 0] + 2 * step)
    result = np.zeros(len(diagram.positions), bool)
    result[near] = found_in(grid_keys(diagram.positions[near], step), grid_keys(touched, step))
    return result


def _ranked(edges: Ints, places: Floats, entering: Bools, n_edges: int) -> Ints:
    """Order by edge, then place, then direction."""
    found = call_compiled("voronoi_loops.ranked", (edges, places, entering, n_edges))
    return np.asarray(np.lexsort([entering, places, edges]) if found is None else found)


def _edges_of(diagram: VoronoiDiagram, generators: Ints) -> Ints:
    """(k,) Voronoi edge between each set of d generators, -1 where there is none.

    Facets are compared by the sums of random-looking numbers of their points, and then by the points.
    """
    if diagram.dim == 3 and diagram.stars is not None:
        arguments = (generators, diagram.simplices, *diagram.stars)
        halves = call_compiled("voronoi_loops.facets_between", arguments)
        found = np.full(len(halves), -1, np.int64)
        rows = np.flatnonzero(halves >= 0)
        found[rows] = diagram.edges_of_halves(halves[rows])
        return found
    names = scramble(np.arange(len(diagram.coordinates), dtype=np.uint64))
    wanted = names[generators].sum(axis=1, dtype=np.uint64)
    once, back = np.unique(wanted, return_inverse=True)
    found = np.full(len(once), -1, np.int64)
    if len(once):
        of_simplex = names[diagram.simplices]
        total = of_simplex[:, 0].copy()
        for column in of_simplex.T[1:]:  # faster than a sum along the short axis
            total += column
        sums = total[diagram.ends[:, 0]]
        sums -= of_simplex.ravel()[diagram.halves]
        likely = np.zeros(1 << LIKELY_BITS, bool)  # a look into this table is all that most facets cost
        likely[once >> np.uint64(64 - LIKELY_BITS)] = True
        candidates = np.flatnonzero(likely[sums >> np.uint64(64 - LIKELY_BITS)])
        place = np.minimum(np.searchsorted(once, sums[candidates]), len(once) - 1)
        hits = once[place] == sums[candidates]
        found[place[hits]] = candidates[hits]
    edges = found[back.ravel()]
    rows = np.flatnonzero(edges >= 0)
    wrong = (diagram.facet_points(edges[rows]) != np.sort(generators[rows], axis=1)).any(axis=1)
    edges[rows[wrong]] = -1
    return edges
