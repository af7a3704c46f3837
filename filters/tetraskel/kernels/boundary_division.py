"""The object's boundary divided among the Voronoi cells: a restricted Voronoi diagram.

First its edges are divided, then in space its triangles. Every corner lies in its own cell, and a cell's part of an
edge or triangle ends where a neighbour's begins, so all parts are found from the corners, exactly. Nothing but the
boundary is looked at.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.chunks import Tick
from tetraskel.kernels.loops_in_python import gather_compiled
from tetraskel.kernels.voronoi_lines import (
    ON_BORDER,
    Intervals,
    Neighbours,
    edge_keys_of,
    nearest_on_lines,
    ranges,
    split_keys,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


FACETS = 1 << 14  # of the boundary at a time: those of a piece know the same neighbours


class Met(NamedTuple):
    """Places where d cells meet on the boundary, the boundary's normal there, and whether it is within a facet."""

    generators: Ints
    positions: Floats
    normals: Floats
    sure: Bools


class Segments(NamedTuple):
    """Straight pieces in which Voronoi faces cross the boundary.

    Attributes
    ----------
    faces : (s,) int
        Keys (`edge_keys_of`) of the two generators of each face.
    places : (s, 2, 3) float
        First and last place: the object is on the left of the way, seen from the larger generator.
    outward : (s, 3) float
        Unit normal of the boundary.
    ends : (s, 2) int
        What the first and last place are: a row of `Met`, or -1 - the key of the side of a triangle of the boundary.
    """

    faces: Ints
    places: Floats
    outward: Floats
    ends: Ints


def no_segments(dim: int) -> Segments:
    """None, which is what the plane has."""
    return Segments(np.empty(0, np.int64), np.empty((0, 2, dim)), np.empty((0, dim)), np.empty((0, 2), np.int64))


def on_edges(neighbours: Neighbours, keys: Ints, tick: Tick) -> tuple[Ints, Ints, Floats]:
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
        ahead = np.flatnonzero(cells != stop[lines])  # the cell of the edge's end is the last one
        lines, cells = lines[ahead], cells[ahead]
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


def on_edges_compiled(around: tuple[Floats, Ints, Ints, Ints], keys: Ints) -> tuple[Ints, Ints, Floats]:
    """The same as `on_edges`, by numba, in the plane: an edge is done before the next.

    Parameters
    ----------
    around : (n, 2) float, (m, 3) int, (n+1,) int, (total,) int
        Points, simplices, where the simplices around each point begin, and these.
    """
    coordinates, *star = around
    in_space = np.column_stack([coordinates, np.zeros(len(coordinates))])
    ends = np.stack(split_keys(keys), axis=1)
    found, places = gather_compiled(
        "boundary_loops.on_edges", lambda piece: (in_space, *star, piece.start, ends[piece]), len(ends), chunk=FACETS
    )
    order = np.lexsort([places[:, 0], found[:, 1], found[:, 0]])
    return found[order, 0], found[order, 1], places[order, 0]


def on_triangles_compiled(
    around: tuple[Floats, Ints, Ints, Ints], same: float, facets: Ints, outward: Floats, tick: Tick
) -> tuple[Met, Segments]:
    """The same as `on_triangles`, by numba: a triangle is done before the next, its edges with it.

    Places closer than `same` where the same cells meet on a triangle are one; `around` is as in `on_edges_compiled`.
    """
    met, spots, pairs, places = gather_compiled(
        "boundary_loops.on_triangles",
        lambda piece: (*around, same, piece.start, facets[piece], outward[piece]),
        len(facets),
        tick,
        FACETS,
    )
    found = Met(met[:, :3], spots, outward[met[:, 3]], met[:, 4] != 0)
    counts = np.bincount(met[:, 3], minlength=len(facets))
    ends = pairs[:, 2:]
    ends = np.where(ends < 0, ends, ends + (np.cumsum(counts) - counts)[pairs[:, 1], None])
    return found, Segments(pairs[:, 0], places.reshape(-1, 2, 3), outward[pairs[:, 1]], ends)


def on_triangles(
    neighbours: Neighbours,
    facets: Ints,
    outward: Floats,
    on_edges: tuple[Ints, Ints, Ints],
    tick: Tick,
) -> tuple[Met, Segments]:
    """Segments in which Voronoi faces cross the triangles of the boundary, and where they end at Voronoi edges."""
    triangles, pairs = _starts(facets, *on_edges)
    seen = np.empty(0, np.uint64)
    segments: list[Segments] = []
    corners: list[Met] = []
    n_corners = 0
    while len(pairs):
        tick(0.5)
        low, high = split_keys(pairs)
        given = facets[triangles], outward[triangles]
        origins, ways, spans, sides = _common_lines(neighbours.coordinates, *given, low, high)
        got = nearest_on_lines(neighbours, low, high, origins, ways, spans)
        jobs = np.sort(_job_keys(triangles, pairs))
        seen = np.insert(seen, np.searchsorted(seen, jobs), jobs)
        there = got.high > got.low
        places = np.where(there[:, None], np.stack([got.low, got.high], axis=1), 0.0)
        spots = origins[:, None] + places[:, :, None] * ways[:, None]
        ends = -1 - sides
        for side, (rows, others, _) in enumerate(_ends_of(got, there)):
            triples = np.sort(np.stack([low[rows], high[rows], others], axis=1), axis=1)
            place, (least, most) = (got.low, got.high)[side][rows], spans[rows].T
            sure = np.minimum(place - least, most - place) > ON_BORDER * (most - least)
            corners.append(Met(triples, spots[rows, side], outward[triangles[rows]], sure))
            ends[rows, side] = n_corners + np.arange(len(rows))
            n_corners += len(rows)
        segments.append(Segments(pairs[there], spots[there, ::-1], outward[triangles[there]], ends[there, ::-1]))
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
        return Met(np.empty((0, 3), np.int64), none, none, np.empty(0, bool)), no_segments(3)
    met = Met(*(np.concatenate(column) for column in zip(*corners, strict=True)))
    return met, Segments(*(np.concatenate(column) for column in zip(*segments, strict=True)))


def _starts(facets: Ints, keys: Ints, lines: Ints, pairs: Ints) -> tuple[Ints, Ints]:
    """Pairs of cells that meet on the edges of each triangle."""
    sides = np.stack([edge_keys_of(facets[:, i], facets[:, j]) for i, j in ((0, 1), (0, 2), (1, 2))], axis=1)
    edge = np.searchsorted(keys, sides)
    first, last = np.searchsorted(lines, edge.ravel()), np.searchsorted(lines, edge.ravel() + 1)
    counts = last - first
    places = ranges(first, counts)
    triangles = np.repeat(np.repeat(np.arange(len(facets)), 3), counts)
    new = _not_yet(_job_keys(triangles, pairs[places]), np.empty(0, np.uint64))
    return triangles[new], pairs[places][new]


def _common_lines(
    x: Floats, triangles: Ints, normals: Floats, low: Ints, high: Ints
) -> tuple[Floats, Floats, Floats, Ints]:
    """Lines in the triangles' planes that are equally far from two generators, and their parts in the triangles.

    Where the planes are parallel the part is empty: the Voronoi face lies in the boundary and does not cross it.

    Returns
    -------
    origins, ways : (k, 3) float
    spans : (k, 2) float
        Least and largest place.
    sides : (k, 2) int
        Keys of the sides of the triangles on which these lie.
    """
    across = x[high] - x[low]
    in_plane = across - normals * dots(across, normals)[:, None]
    ways = np.cross(normals, in_plane)
    square = dots(in_plane, in_plane)
    corners = x[triangles]
    to_middle = dots((x[high] + x[low]) / 2 - corners[:, 0], across)
    parallel = square <= np.finfo(float).eps * dots(across, across)
    origins = corners[:, 0] + in_plane * (to_middle / np.where(parallel, 1.0, square))[:, None]
    spans = np.tile([-np.inf, np.inf], (len(low), 1))
    sides = np.zeros((len(low), 2), np.int64)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        inward = np.cross(normals, corners[:, j] - corners[:, i])
        inward *= np.sign(dots(inward, corners[:, k] - corners[:, i]))[:, None]
        gap = dots(inward, origins - corners[:, i])
        slope = dots(inward, ways)
        key = edge_keys_of(triangles[:, i], triangles[:, j])
        with np.errstate(divide="ignore", invalid="ignore"):
            place = -gap / slope
        for end, nearer in enumerate(((slope > 0) & (place > spans[:, 0]), (slope < 0) & (place < spans[:, 1]))):
            spans[:, end] = np.where(nearer, place, spans[:, end])
            sides[:, end] = np.where(nearer, key, sides[:, end])
        spans[(slope == 0) & (gap < 0), 1] = -np.inf
    spans[parallel | ~np.isfinite(spans).all(axis=1)] = 0.0
    return origins, ways, spans, sides
