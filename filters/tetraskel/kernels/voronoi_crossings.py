"""Where the Voronoi diagram of the points crosses the object's boundary, which is made of Delaunay facets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.boundary_division import Met, on_edges, on_triangles
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram, outward_normals
from tetraskel.kernels.voronoi_lines import Neighbours, edge_keys_of, split_keys, unique_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Crossings of one edge closer than this share of the bounding-box diagonal are one.
SAME = 1e-9
LIKELY_BITS = 22


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
    lines, pairs, places = on_edges(neighbours, keys, tick)
    low, high = split_keys(keys[lines])
    start, stop = diagram.coordinates[low], diagram.coordinates[high]
    positions = start + places[:, None] * (stop - start)
    if diagram.dim == 2:
        of_edge = np.empty(len(keys), np.int64)
        of_edge[np.searchsorted(keys, edge_keys_of(*facets.T))] = np.arange(len(facets))
        normals = outward[of_edge[lines]]
        none = np.empty((0, 2, 2)), np.empty((0, 2))
        met = Met(np.stack(split_keys(pairs), axis=1), positions, normals, np.ones(len(pairs), bool))
        return _sorted(diagram, met, np.empty(0, np.int64), *none)
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


def _sorted(diagram: VoronoiDiagram, met: Met, faces: Ints, segments: Floats, outward: Floats) -> Crossings:
    """Crossings in canonical order; those of generators that share no Voronoi edge (they only touch) are left out."""
    edges = _edges_of(diagram, met.generators)
    kept = edges >= 0
    edges, positions, normals, sure = edges[kept], met.positions[kept], met.normals[kept], met.sure[kept]
    start, stop = (diagram.positions[diagram.ends[edges, k]] for k in (0, 1))
    way = stop - start
    length = np.einsum("ka,ka->k", way, way)
    places = np.einsum("ka,ka->k", positions - start, way) / np.where(length == 0, 1.0, length)
    entering = np.einsum("ka,ka->k", way, normals) < 0
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
