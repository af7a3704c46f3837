"""Where the Voronoi diagram of the points crosses the object's boundary, which is made of Delaunay facets.

The boundary is divided among the Voronoi cells, exactly (a restricted Voronoi diagram): first its edges, then in space
its triangles. Every corner lies in its own cell, and a cell's part of an edge or triangle ends where a neighbour's
begins, so all parts are found from the corners. Nothing but the boundary is looked at.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram, outward_normals
from tetraskel.kernels.voronoi_lines import (
    ON_BORDER,
    Intervals,
    Neighbours,
    edge_keys_of,
    nearest_on_lines,
    split_keys,
    unique_edges,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


# Crossings of one edge closer than this share of the bounding-box diagonal are one.
SAME = 1e-9


class _Met(NamedTuple):
    """Places where d cells meet on the boundary, the boundary's normal there, and whether it is within a facet."""

    generators: Ints
    positions: Floats
    normals: Floats
    sure: Bools


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
    faces : (s,) int
        Keys (`edge_keys_of`) of the Delaunay edges dual to the Voronoi faces that cross the boundary, ascending.
    segments : (s, 2, d) float
        Straight pieces of the boundary on those faces.
    outward : (s, d) float
        Unit normal of the boundary there.
    """

    edges: Ints
    places: Floats
    positions: Floats
    entering: Bools
    sure: Bools
    faces: Ints
    segments: Floats
    outward: Floats


def find_crossings(diagram: VoronoiDiagram, tick: Tick = silent) -> Crossings:
    """Every place where the diagram crosses the object's boundary, in the plane and in space."""
    cells, opposite = _boundary(diagram)
    facets = _corners(diagram.simplices, cells, opposite)
    outward = outward_normals(diagram.coordinates, diagram.simplices, cells, opposite)
    asked = np.zeros(len(diagram.coordinates), bool)
    asked[facets] = True
    neighbours = Neighbours(diagram.coordinates, diagram.simplices, asked)
    keys = unique_edges(facets) if len(facets) else np.empty(0, np.int64)
    lines, pairs, places = _on_edges(neighbours, keys, tick)
    low, high = split_keys(keys[lines])
    start, stop = diagram.coordinates[low], diagram.coordinates[high]
    positions = start + places[:, None] * (stop - start)
    if diagram.dim == 2:
        of_edge = np.empty(len(keys), np.int64)
        of_edge[np.searchsorted(keys, edge_keys_of(*facets.T))] = np.arange(len(facets))
        normals = outward[of_edge[lines]]
        none = np.empty((0, 2, 2)), np.empty((0, 2))
        met = _Met(np.stack(split_keys(pairs), axis=1), positions, normals, np.ones(len(pairs), bool))
        return _sorted(diagram, met, np.empty(0, np.int64), *none)
    return _on_triangles(diagram, neighbours, facets, outward, (keys, lines, pairs), tick)


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


def _on_edges(neighbours: Neighbours, keys: Ints, tick: Tick) -> tuple[Ints, Ints, Floats]:
    """Edges of the boundary, between which cells each passes (their key), and where, as a share of its length."""
    start, stop = split_keys(keys)
    lines, cells = np.arange(len(keys)), start
    found: list[tuple[Ints, Ints, Floats]] = []
    x = neighbours.coordinates
    while len(lines):  # along a line each cell has its turn once, so no walk comes back
        tick(0.1)
        origins, spans = x[start[lines]], np.tile([0.0, 1.0], (len(lines), 1))
        none = np.full(len(lines), -1)
        got = nearest_on_lines(neighbours, cells, none, origins, x[stop[lines]] - origins, spans)
        on = np.flatnonzero(got.after >= 0)
        lines, before, cells = lines[on], cells[on], got.after[on]
        # a cell whose whole share rounding took ends where it begins, anywhere: the place is on the edge all the same
        found.append((lines, edge_keys_of(before, cells), np.fmax(np.fmin(got.high[on], 1.0), 0.0)))
    if not found:
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
    line, pair, place = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.lexsort([place, pair, line])
    return line[order], pair[order], place[order]


def _holds_a_place(got: Intervals, spans: Floats) -> Bools:
    """Intervals that hold a place, up to rounding.

    Where more cells meet in one place than three, some have nothing of a line but that place: the search goes on from
    there too.
    """
    return np.asarray(got.high - got.low > -ON_BORDER * (spans[:, 1] - spans[:, 0]))


def _ends_of(got: Intervals, there: Bools) -> list[tuple[Ints, Ints, Floats]]:
    """Rows whose interval is there and ends at another cell, that cell, and where; for the two sides."""
    result: list[tuple[Ints, Ints, Floats]] = []
    for other, place in ((got.before, got.low), (got.after, got.high)):
        rows = np.flatnonzero(there & (other >= 0))
        result.append((rows, other[rows], place[rows]))
    return result


def _job_keys(first: Ints, second: Ints) -> NDArray[np.uint64]:
    """A number for each pair: which of 2^64 is random-looking, so that no two of some millions meet."""
    return scramble(scramble(first.astype(np.uint64)) + second.astype(np.uint64))


def _not_yet(keys: NDArray[np.uint64], seen: NDArray[np.uint64]) -> Ints:
    """Rows whose key is not among the ascending ones seen before, one for each key."""
    once, first = np.unique(keys, return_index=True)
    if len(seen) == 0:
        return np.asarray(first)
    return np.asarray(first[seen[np.minimum(np.searchsorted(seen, once), len(seen) - 1)] != once])


def _on_triangles(
    diagram: VoronoiDiagram,
    neighbours: Neighbours,
    facets: Ints,
    outward: Floats,
    on_edges: tuple[Ints, Ints, Ints],
    tick: Tick,
) -> Crossings:
    """Segments in which Voronoi faces cross the triangles of the boundary, and where they end at Voronoi edges."""
    triangles, pairs = _starts(facets, *on_edges)
    seen = np.empty(0, np.uint64)
    segments: list[tuple[Ints, Floats, Floats]] = []
    corners: list[_Met] = []
    while len(pairs):
        tick(0.5)
        low, high = split_keys(pairs)
        origins, ways, spans = _common_lines(diagram.coordinates, facets[triangles], outward[triangles], low, high)
        got = nearest_on_lines(neighbours, low, high, origins, ways, spans)
        jobs = np.sort(_job_keys(triangles, pairs))
        seen = np.insert(seen, np.searchsorted(seen, jobs), jobs)
        there = got.high > got.low
        places = np.where(there[:, None], np.stack([got.low, got.high], axis=1), 0.0)
        ends = origins[:, None] + places[:, :, None] * ways[:, None]
        segments.append((pairs[there], ends[there], outward[triangles[there]]))
        for side, (rows, others, _) in enumerate(_ends_of(got, there)):
            triples = np.sort(np.stack([low[rows], high[rows], others], axis=1), axis=1)
            place, (least, most) = (got.low, got.high)[side][rows], spans[rows].T
            sure = np.minimum(place - least, most - place) > ON_BORDER * (most - least)
            corners.append(_Met(triples, ends[rows, side], outward[triangles[rows]], sure))
        further = _ends_of(got, _holds_a_place(got, spans))
        ahead = [(triangles[rows], one[rows], others) for rows, others, _ in further for one in (low, high)]
        triangle, one, other = (np.concatenate(column) for column in zip(*ahead, strict=True))
        neighbours.prepare(other)
        joined = neighbours.joined(one, other)
        triangle, next_pairs = triangle[joined], edge_keys_of(one[joined], other[joined])
        new = _not_yet(_job_keys(triangle, next_pairs), seen)
        triangles, pairs = triangle[new], next_pairs[new]
    if not segments:
        none = np.empty((0, 3))
        met = _Met(np.empty((0, 3), np.int64), none, none, np.empty(0, bool))
        return _sorted(diagram, met, np.empty(0, np.int64), np.empty((0, 2, 3)), none)
    met = _Met(*(np.concatenate(column) for column in zip(*corners, strict=True)))
    faces, lines, sides = (np.concatenate(column) for column in zip(*segments, strict=True))
    return _sorted(diagram, met, faces, lines, sides)


def _starts(facets: Ints, keys: Ints, lines: Ints, pairs: Ints) -> tuple[Ints, Ints]:
    """Pairs of cells that meet on the edges of each triangle."""
    sides = np.stack([edge_keys_of(facets[:, i], facets[:, j]) for i, j in ((0, 1), (0, 2), (1, 2))], axis=1)
    edge = np.searchsorted(keys, sides)
    first, last = np.searchsorted(lines, edge.ravel()), np.searchsorted(lines, edge.ravel() + 1)
    counts = last - first
    places = np.arange(counts.sum()) + np.repeat(first - (np.cumsum(counts) - counts), counts)
    triangles = np.repeat(np.repeat(np.arange(len(facets)), 3), counts)
    new = _not_yet(_job_keys(triangles, pairs[places]), np.empty(0, np.uint64))
    return triangles[new], pairs[places][new]


def _common_lines(x: Floats, triangles: Ints, normals: Floats, low: Ints, high: Ints) -> tuple[Floats, Floats, Floats]:
    """Lines in the triangles' planes that are equally far from two generators, and their parts in the triangles.

    Where the planes are parallel the part is empty: the Voronoi face lies in the boundary and does not cross it.
    """
    across = x[high] - x[low]
    in_plane = across - normals * (across * normals).sum(axis=1, keepdims=True)
    ways = np.cross(normals, in_plane)
    square = (in_plane**2).sum(axis=1)
    corners = x[triangles]
    to_middle = (((x[high] + x[low]) / 2 - corners[:, 0]) * across).sum(axis=1)
    parallel = square <= np.finfo(float).eps * (across**2).sum(axis=1)
    origins = corners[:, 0] + in_plane * (to_middle / np.where(parallel, 1.0, square))[:, None]
    spans = np.tile([-np.inf, np.inf], (len(low), 1))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        inward = np.cross(normals, corners[:, j] - corners[:, i])
        inward *= np.sign((inward * (corners[:, k] - corners[:, i])).sum(axis=1))[:, None]
        gap = (inward * (origins - corners[:, i])).sum(axis=1)
        slope = (inward * ways).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            place = -gap / slope
        spans[:, 0] = np.where(slope > 0, np.maximum(spans[:, 0], place), spans[:, 0])
        spans[:, 1] = np.where(slope < 0, np.minimum(spans[:, 1], place), spans[:, 1])
        spans[(slope == 0) & (gap < 0), 1] = -np.inf
    spans[parallel | ~np.isfinite(spans).all(axis=1)] = 0.0
    return origins, ways, spans


def _sorted(diagram: VoronoiDiagram, met: _Met, faces: Ints, segments: Floats, outward: Floats) -> Crossings:
    """Crossings in canonical order; those of generators that share no Voronoi edge (they only touch) are left out."""
    edges = _edges_of(diagram, met.generators)
    kept = edges >= 0
    edges, positions, normals, sure = edges[kept], met.positions[kept], met.normals[kept], met.sure[kept]
    start, stop = (diagram.positions[diagram.ends[edges, k]] for k in (0, 1))
    way = stop - start
    length = (way**2).sum(axis=1)
    places = ((positions - start) * way).sum(axis=1) / np.where(length == 0, 1.0, length)
    entering = (way * normals).sum(axis=1) < 0
    order = np.lexsort([entering, places, edges])
    edges, places, positions = edges[order], np.clip(places[order], 0.0, 1.0), positions[order]
    entering, sure = entering[order], sure[order]
    # each of the cells that meet there has found the place, and where it is on a border, on both sides of that
    away = np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=1)) > SAME * diagram.size
    first = np.ones(len(edges), bool)
    first[1:] = (edges[1:] != edges[:-1]) | (entering[1:] != entering[:-1]) | away
    once = np.flatnonzero(first)
    sure = np.logical_or.reduceat(sure, once) if len(once) else sure
    by_face = np.argsort(faces, kind="stable")
    return Crossings(
        edges[once],
        places[once],
        positions[once],
        entering[once],
        sure,
        faces[by_face],
        segments[by_face],
        outward[by_face],
    )


def _edges_of(diagram: VoronoiDiagram, generators: Ints) -> Ints:
    """(k,) Voronoi edge between each set of d generators, -1 where there is none.

    Facets are compared by the sums of random-looking numbers of their points, and then by the points.
    """
    wanted = scramble(generators.astype(np.uint64)).sum(axis=1, dtype=np.uint64)
    once, back = np.unique(wanted, return_inverse=True)
    found = np.full(len(once), -1, np.int64)
    touched = np.zeros(len(diagram.coordinates), bool)
    touched[generators] = True
    cells = np.flatnonzero(touched[diagram.simplices].sum(axis=1) >= diagram.dim)
    if len(once) and len(cells):
        numbers = scramble(diagram.simplices[cells].astype(np.uint64))
        sums = (numbers.sum(axis=1, dtype=np.uint64)[:, None] - numbers).ravel()
        place = np.minimum(np.searchsorted(once, sums), len(once) - 1)
        hits = np.flatnonzero(once[place] == sums)
        width = diagram.dim + 1
        halves = cells[hits // width] * np.int64(width) + hits % width
        found[place[hits]] = diagram.edge_of_half[halves]
    edges = found[back.ravel()]
    rows = np.flatnonzero(edges >= 0)
    wrong = (diagram.facet_points(edges[rows]) != np.sort(generators[rows], axis=1)).any(axis=1)
    edges[rows[wrong]] = -1
    return edges
