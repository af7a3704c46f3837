"""Voronoi vertices, edges and faces, whole or cut, as points and what joins them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import for_chunks
from tetraskel.kernels.voronoi_clip import clipped_faces
from tetraskel.kernels.voronoi_crossings import Crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_faces import EDGES, VoronoiFaces, closed_rings, voronoi_faces
from tetraskel.kernels.voronoi_lines import found_in
from tetraskel.kernels.voronoi_sides import pieces_of_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Elements:
    """Elements before simplification: points, and for each kind of element its points and what it is dual to.

    Attributes
    ----------
    points, radius, cells : (p, d), (p,), (p,)
        As in `VoronoiSkeleton`.
    vertices, lines, offsets, connectivity : (v,), (s, 2), (f+1,), (total,) int
        Points of each element.
    simplices, edges, keys : (v,), (s,), (f,) int
        Delaunay simplex of each vertex, Voronoi edge of each line, key of the Delaunay edge of each polygon.
    wedges : (total,) int, optional
        Of each corner of the polygons (`VoronoiFaces`), where they are whole and no points are merged.
    """

    points: Floats
    radius: Floats
    cells: Ints
    vertices: Ints
    lines: Ints
    offsets: Ints
    connectivity: Ints
    simplices: Ints
    edges: Ints
    keys: Ints
    wedges: Ints | None = None


def whole_faces(diagram: VoronoiDiagram, whole: Bools, crossed: Ints, doubtful: Bools | None = None) -> VoronoiFaces:
    """Ordered Voronoi faces that have all their edges.

    Parameters
    ----------
    whole : (m, 4) bool
        Half-facets whose Voronoi edges are whole.
    crossed : (c,) int
        Keys of faces that are left out.
    doubtful : (m,) bool, optional
        A face all of whose vertices are doubtful is left out.
    """
    between = wedges_between(whole)
    faces = voronoi_faces(diagram, between)
    if (diagram.signs == 0).any():  # flat simplices may lie around an edge twice
        crossed = np.concatenate([crossed, voronoi_faces(diagram, ~between).keys])
    if len(crossed):
        faces = faces.some(np.flatnonzero(~found_in(faces.keys, crossed)))
    faces = closed_rings(diagram, faces)
    if doubtful is not None and doubtful.any():
        faces = faces.some(np.flatnonzero(faces.any_of(~doubtful[faces.cells])))
    return faces


def wedges_between(flags: Bools) -> Bools:
    """(m, 6) tetrahedra at those of their edges beside which both half-facets have (m, 4) flags."""
    beside = np.array([others for _, _, *others in EDGES]).T
    return np.asarray(flags[:, beside[0]] & flags[:, beside[1]])


def of_cells(diagram: VoronoiDiagram, cells: Ints, edges: Ints, faces: VoronoiFaces | None) -> Elements:
    """Whole Voronoi vertices, edges and faces."""
    m, none = len(diagram.simplices), np.empty(0, np.int64)
    number = np.full(m, -1, np.int64)
    number[cells] = np.arange(len(cells))
    corners = none if faces is None else faces.cells
    return Elements(
        diagram.positions[cells],
        diagram.radii[cells],
        cells,
        np.arange(len(cells)),
        number[diagram.ends[edges]],
        np.zeros(1, np.int64) if faces is None else faces.starts,
        corners if len(cells) == m else number[corners],
        cells,
        edges,
        none if faces is None else faces.keys,
        none if faces is None else faces.wedges,
    )


def separations(diagram: VoronoiDiagram, simplices: Ints) -> Floats:
    """(k,) longest edge of simplices of any dimension: how far apart the points are that an element is nearest to."""
    x = diagram.coordinates
    found = np.empty(len(simplices))

    def work(piece: slice) -> None:
        corners = x[simplices[piece].T]  # (corner, k, axis)
        pairs = combinations(range(simplices.shape[1]), 2)
        squares = [np.einsum("ka,ka->k", way, way) for way in (corners[i] - corners[j] for i, j in pairs)]
        found[piece] = np.sqrt(np.max(squares, axis=0))

    for_chunks(work, len(simplices))
    return found


def with_pieces(diagram: VoronoiDiagram, whole: Elements, crossings: Crossings, inside: Bools) -> Elements:
    """The elements with the parts of Voronoi edges inside, in the plane."""
    edges, places = pieces_of_edges(diagram, crossings, inside)
    start, stop = diagram.positions[diagram.ends[edges, 0]], diagram.positions[diagram.ends[edges, 1]]
    positions = start[:, None] + places[:, :, None] * (stop - start)[:, None]
    generators = diagram.facet_points(edges)
    number = np.full(len(diagram.positions), -1, np.int64)
    number[whole.cells] = np.arange(len(whole.cells))
    vertex = number[diagram.ends[edges]]
    own = (places == [0.0, 1.0]) & (vertex >= 0)
    added = np.flatnonzero(~own.ravel())
    lines = np.where(own, vertex, 0).ravel()
    lines[added] = len(whole.points) + np.arange(len(added))
    points = positions.reshape(-1, 2)[added]
    away = points - diagram.coordinates[generators[added // 2, 0]]
    return replace(
        whole,
        points=np.concatenate([whole.points, points]),
        radius=np.concatenate([whole.radius, np.sqrt((away**2).sum(axis=1))]),
        cells=np.concatenate([whole.cells, np.full(len(added), -1)]),
        lines=lines.reshape(-1, 2),
        edges=edges,
    )


def with_polygons(
    diagram: VoronoiDiagram, whole: Elements, crossings: Crossings, inside: Bools, cut: VoronoiFaces
) -> Elements:
    """The elements with the parts inside of the faces that the boundary cuts."""
    face, starts, corners = clipped_faces(diagram, crossings, inside, cut)
    generators = cut.generators[face]
    away = corners - diagram.coordinates[np.repeat(generators[:, 0], np.diff(starts))]
    n_whole = len(whole.points)
    return replace(
        whole,
        points=np.concatenate([whole.points, corners]),
        radius=np.concatenate([whole.radius, np.sqrt((away**2).sum(axis=1))]),
        cells=np.concatenate([whole.cells, np.full(len(corners), -1)]),
        offsets=np.concatenate([whole.offsets, starts[1:] + whole.offsets[-1]]),
        connectivity=np.concatenate([whole.connectivity, n_whole + np.arange(len(corners))]),
        keys=np.concatenate([whole.keys, cut.keys[face]]),
        wedges=None,
    )
