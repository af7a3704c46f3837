"""Voronoi vertices, edges and faces, whole or cut, as points and what joins them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import for_chunks
from tetraskel.kernels.voronoi_clip import clipped_faces
from tetraskel.kernels.voronoi_crossings import Crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_faces import VoronoiFaces, ordered, voronoi_faces
from tetraskel.kernels.voronoi_lines import found_in
from tetraskel.kernels.voronoi_sides import pieces_of_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Elements:
    """Elements before simplification: points, and for each kind of element its points and its separation."""

    points: Floats
    radius: Floats
    cells: Ints
    vertices: Ints
    lines: Ints
    offsets: Ints
    connectivity: Ints
    separations: tuple[Floats, Floats, Floats]


def whole_faces(diagram: VoronoiDiagram, whole: Bools, crossed: Ints) -> VoronoiFaces | None:
    """Ordered Voronoi faces all of whose edges are `whole`, without those that are crossed; none in the plane."""
    if diagram.dim == 2:
        return None
    flags = whole[diagram.edge_of_half].reshape(-1, 4)
    faces = voronoi_faces(diagram, np.flatnonzero(flags.any(axis=1)))
    chosen = faces.closed & faces.all_of(flags.ravel()[faces.ahead])
    chosen &= ~found_in(faces.keys, crossed)
    return ordered(diagram, faces, np.flatnonzero(chosen))


def of_cells(diagram: VoronoiDiagram, cells: Ints, edges: Ints, faces: VoronoiFaces | None) -> Elements:
    """Whole Voronoi vertices, edges and faces."""
    number = np.full(len(diagram.simplices), -1, np.int64)
    number[cells] = np.arange(len(cells))
    keys = np.empty(0, np.int64) if faces is None else faces.keys
    ends = np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1)
    x = diagram.coordinates
    return Elements(
        diagram.positions[cells],
        diagram.radii[cells],
        cells,
        np.arange(len(cells)),
        number[diagram.ends[edges]],
        np.zeros(1, np.int64) if faces is None else faces.starts,
        np.empty(0, np.int64) if faces is None else number[faces.cells],
        (_longest(x, diagram.simplices[cells]), _longest(x, diagram.facet_points(edges)), _longest(x, ends)),
    )


def _longest(x: Floats, simplices: Ints) -> Floats:
    """(k,) longest edge of simplices."""
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
    return Elements(
        np.concatenate([whole.points, points]),
        np.concatenate([whole.radius, np.sqrt((away**2).sum(axis=1))]),
        np.concatenate([whole.cells, np.full(len(added), -1)]),
        whole.vertices,
        lines.reshape(-1, 2),
        whole.offsets,
        whole.connectivity,
        (whole.separations[0], _longest(diagram.coordinates, generators), whole.separations[2]),
    )


def with_polygons(
    diagram: VoronoiDiagram, whole: Elements, crossings: Crossings, inside: Bools, cut: VoronoiFaces
) -> Elements:
    """The elements with the parts inside of the faces that the boundary cuts."""
    face, starts, corners = clipped_faces(diagram, crossings, inside, cut)
    generators = cut.generators[face]
    away = corners - diagram.coordinates[np.repeat(generators[:, 0], np.diff(starts))]
    n_whole = len(whole.points)
    return Elements(
        np.concatenate([whole.points, corners]),
        np.concatenate([whole.radius, np.sqrt((away**2).sum(axis=1))]),
        np.concatenate([whole.cells, np.full(len(corners), -1)]),
        whole.vertices,
        whole.lines,
        np.concatenate([whole.offsets, starts[1:] + whole.offsets[-1]]),
        np.concatenate([whole.connectivity, n_whole + np.arange(len(corners))]),
        (*whole.separations[:2], np.concatenate([whole.separations[2], _longest(diagram.coordinates, generators)])),
    )
