"""Voronoi vertices, edges and faces, whole or cut, as points and what joins them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.chunks import Tick, for_chunks
from tetraskel.kernels.polygon_slabs import THIN
from tetraskel.kernels.voronoi_clip import clipped_faces
from tetraskel.kernels.voronoi_crossings import Crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_faces import EDGES, VoronoiFaces, closed_faces
from tetraskel.kernels.voronoi_lines import found_in, ranges, split_keys
from tetraskel.kernels.voronoi_parts import parts_of_faces
from tetraskel.kernels.voronoi_sides import parts_of_edges

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


def whole_faces(diagram: VoronoiDiagram, whole: Bools, crossed: Ints, tick: Tick) -> VoronoiFaces:
    """Ordered Voronoi faces that have all their edges.

    Parameters
    ----------
    whole : (m, 4) bool
        Half-facets whose Voronoi edges are whole.
    crossed : (c,) int
        Keys of faces that are left out.
    """
    faces = closed_faces(diagram, wedges_between(whole), tick)
    return faces.some(np.flatnonzero(~found_in(faces.keys, crossed))) if len(crossed) else faces


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


def with_pieces(
    diagram: VoronoiDiagram, whole: Elements, crossings: Crossings, inside: Bools, whole_edges: Bools
) -> Elements:
    """The elements with the parts of Voronoi edges inside, in the plane; (f,) edges that are wholly inside."""
    edges, nodes = parts_of_edges(diagram, crossings, inside, whole_edges)
    found, lines = _with_nodes(diagram, whole, crossings, nodes.ravel(), np.empty((0, 2)), np.empty(0, np.int64))
    return replace(found, lines=lines.reshape(-1, 2), edges=edges)


def with_polygons(
    diagram: VoronoiDiagram,
    whole: Elements,
    crossings: Crossings,
    inside: Bools,
    whole_edges: Bools,
    faces: VoronoiFaces,
    tick: Tick,
) -> Elements:
    """The elements with the parts of Voronoi faces inside.

    Parameters
    ----------
    whole_edges : (f,) bool
        Voronoi edges that are wholly inside.
    faces : VoronoiFaces
        All that have such a part, ordered.
    """
    parts, segments = parts_of_faces(diagram, crossings, inside, whole_edges, faces, tick), crossings.segments
    rest, begins, corners = clipped_faces(diagram, crossings, inside, faces.some(parts.unsure))
    n_segments = len(diagram.positions) + len(crossings.edges)
    n_corners = n_segments + len(segments.faces)
    places = np.concatenate([diagram.positions, crossings.positions, segments.places[:, 0], corners])
    nodes = np.concatenate([parts.nodes, n_corners + np.arange(len(corners))])
    face = np.concatenate([parts.faces, parts.unsure[rest]])
    face, starts, nodes = _by_face(face, np.concatenate([parts.counts, np.diff(begins)]), nodes)
    kept, starts, nodes = _without_straight(places, starts, nodes, (nodes >= n_segments) & (nodes < n_corners))
    owners = np.concatenate(
        [split_keys(segments.faces)[0], faces.generators[parts.unsure[rest], 0].repeat(np.diff(begins))]
    )
    found, connectivity = _with_nodes(diagram, whole, crossings, nodes, places[n_segments:], owners)
    return replace(found, offsets=starts, connectivity=connectivity, keys=faces.keys[face[kept]], wedges=None)


def _by_face(face: Ints, counts: Ints, nodes: Ints) -> tuple[Ints, Ints, Ints]:
    """Polygons in the order of their faces: these, where each begins, and the nodes."""
    order = np.argsort(face, kind="stable")
    starts = np.concatenate([[0], np.cumsum(counts[order])])
    if (np.diff(face) < 0).any():
        nodes = nodes[ranges((np.cumsum(counts) - counts)[order], counts[order])]
    return face[order], starts, nodes


def _without_straight(places: Floats, starts: Ints, nodes: Ints, asked: Bools) -> tuple[Ints, Ints, Ints]:
    """Polygons without those of the nodes asked that lie straight between the ones before and after, and which keep
    three nodes or more. Of two in one place the second goes.
    """
    rows = np.flatnonzero(asked)
    straight = np.zeros(len(nodes), bool)
    before, after = np.arange(-1, len(nodes) - 1), np.arange(1, len(nodes) + 1)
    before[starts[:-1]], after[starts[1:] - 1] = starts[1:] - 1, starts[:-1]

    def work(piece: slice) -> None:
        some = rows[piece]
        here = places[nodes[some]]
        back, ahead = here - places[nodes[before[some]]], places[nodes[after[some]]] - here
        turn = np.cross(back, ahead)
        lengths = dots(ahead, ahead)
        straight[some] = (lengths > 0) & (dots(turn, turn) <= THIN**2 * dots(back, back) * lengths)

    for_chunks(work, len(rows))
    counts = np.diff(np.concatenate([[0], np.cumsum(~straight)])[starts])
    kept = np.flatnonzero(counts >= 3)
    straight |= np.repeat(counts < 3, np.diff(starts))
    return kept, np.concatenate([[0], np.cumsum(counts[kept])]), nodes[~straight]


def _with_nodes(
    diagram: VoronoiDiagram, whole: Elements, crossings: Crossings, nodes: Ints, spots: Floats, owners: Ints
) -> tuple[Elements, Ints]:
    """The elements with points for the nodes that are cut, and (k,) the point of each node.

    Parameters
    ----------
    nodes : (k,) int
        Voronoi vertices that are among the elements, after all positions of the diagram crossings, after these spots,
        each of them once.
    owners : (s,) int
        A generator nearest to each of the spots.
    """
    n_positions, n_others = len(diagram.positions), len(diagram.positions) + len(crossings.edges)
    number = np.empty(n_others + len(spots), np.int64)
    number[whole.cells] = np.arange(len(whole.cells))
    crossed = np.zeros(len(crossings.edges), bool)
    crossed[nodes[(nodes >= n_positions) & (nodes < n_others)] - n_positions] = True
    at_crossing, at_spot = np.flatnonzero(crossed), nodes[nodes >= n_others] - n_others
    added = np.concatenate([n_positions + at_crossing, n_others + at_spot])
    number[added] = len(whole.cells) + np.arange(len(added))
    points = np.concatenate([crossings.positions[at_crossing], spots[at_spot]])
    generators = np.concatenate([diagram.facet_points(crossings.edges[at_crossing])[:, 0], owners[at_spot]])
    away = points - diagram.coordinates[generators]
    found = replace(
        whole,
        points=np.concatenate([whole.points, points]),
        radius=np.concatenate([whole.radius, np.sqrt(dots(away, away))]),
        cells=np.concatenate([whole.cells, np.full(len(added), -1)]),
    )
    return found, number[nodes]
