"""The four Voronoi skeletons of an object that is a union of Delaunay simplices.

Sk1: the Voronoi vertices inside. Sk2: all points of Voronoi edges (and faces, in space) inside. Sk3: the Voronoi
elements wholly inside. Sk4: the duals of the Delaunay elements strictly inside. Sk1 lies in Sk3, and Sk3 in Sk2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.curve import lifted
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.interior import inside_by_labels
from tetraskel.kernels.mesh import Triangulation, expect_mesh
from tetraskel.kernels.voronoi_clip import clipped_faces
from tetraskel.kernels.voronoi_crossings import Crossings, find_crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram, voronoi_diagram, without_flat_rim
from tetraskel.kernels.voronoi_faces import VoronoiFaces, ordered, voronoi_faces
from tetraskel.kernels.voronoi_lines import edge_keys_of, found_in
from tetraskel.kernels.voronoi_sides import edges_wholly_inside, pieces_of_edges, vertices_inside
from tetraskel.options import VoronoiOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Voronoi vertices closer than this share of the bounding-box diagonal are one: cospherical points have one centre.
SAME = 1e-9


@dataclass(frozen=True)
class VoronoiSkeleton:
    """Vertices, lines and polygons of a Voronoi skeleton, in the order of the mesh's simplices.

    Attributes
    ----------
    points : (p, e) float
        In the input's unit and space.
    radius : (p,) float
        Distance to the nearest points of the mesh (`MaximumInscribedSphereRadius`).
    cells : (p,) int
        Simplex whose circumcentre a point is, -1 where a Voronoi element was cut (`CellId`).
    vertices : (v,) int
        Points that end no line and no polygon.
    lines : (s, 2) int
        In space those that bound no polygon.
    offsets, connectivity : (f+1,), (total,) int
        Polygons, in space: where each begins among the points of all. Corners are in order; a polygon that was cut
        need not be convex.
    separation : (v + s + f,) float
        Of each vertex, line and polygon, in this order: largest distance between two of the points it is nearest to.
    angle : (v + s + f,) float
        Angle, in degrees, at which these two are seen from the widest place of the element.
    """

    points: Floats
    radius: Floats
    cells: Ints
    vertices: Ints
    lines: Ints
    offsets: Ints
    connectivity: Ints
    separation: Floats
    angle: Floats

    def __len__(self) -> int:
        return len(self.points)

    @property
    def n_polygons(self) -> int:
        """Number of polygons."""
        return len(self.offsets) - 1


@dataclass(frozen=True)
class _Elements:
    """Elements before simplification: points, and for each kind of element its points and its separation."""

    points: Floats
    radius: Floats
    cells: Ints
    vertices: Ints
    lines: Ints
    offsets: Ints
    connectivity: Ints
    separations: tuple[Floats, Floats, Floats]


def voronoi_skeleton(
    mesh: Triangulation,
    *,
    method: str = VoronoiOptions.method,
    inside: ArrayLike | None = None,
    least_separation: float = VoronoiOptions.least_separation,
    least_angle: float = VoronoiOptions.least_angle,
    tick: Tick = silent,
) -> VoronoiSkeleton:
    """A Voronoi skeleton of an object.

    Parameters
    ----------
    mesh : Triangulation
        A Delaunay triangulation. Simplices outside of the object should be there: their circumcentres may lie inside.
    method : {"sk1", "sk2", "sk3", "sk4"}
        See `VoronoiOptions`.
    inside : (m,) array, optional
        Simplices of the object: those that are not 0. Without it all of them.
    least_separation, least_angle : float
        See `VoronoiOptions`.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        For options out of bounds, labels that do not fit, or an object without simplices.

    Examples
    --------
    >>> from tetraskel import triangulate
    >>> rectangle = triangulate([[0, 0], [1, 0], [2.5, 0], [4, 0], [4, 2], [3, 2], [1.5, 2], [0, 2]])
    >>> [len(voronoi_skeleton(rectangle, method=name).lines) for name in ("sk1", "sk2", "sk3", "sk4")]
    [0, 13, 5, 5]
    """
    VoronoiOptions(method=method, least_separation=least_separation, least_angle=least_angle)
    expect_mesh(mesh)
    expect_extent(mesh.points)
    labels = np.ones(len(mesh), bool) if inside is None else inside_by_labels(len(mesh), inside)
    if len(mesh) and not labels.any():
        raise InputError(
            f"expected an object with an inside, got none of {len(mesh)} cells inside; label some, or take all."
        )
    diagram = voronoi_diagram(mesh, labels, tick)
    diagram = diagram if method == "sk4" else without_flat_rim(diagram)
    tick(0.3)
    elements = METHODS[method](diagram, tick)
    elements = _merged(elements, SAME * diagram.size) if method != "sk4" else elements
    tick(0.9)
    kept = _simplified(elements, least_separation * diagram.size, least_angle)
    return _lifted(kept, mesh)


def _crossings_and_sides(diagram: VoronoiDiagram, tick: Tick) -> tuple[Crossings, Bools]:
    crossings = find_crossings(diagram, lambda share: tick(0.3 + 0.3 * share))
    return crossings, vertices_inside(diagram, crossings)


def _sk1(diagram: VoronoiDiagram, tick: Tick) -> _Elements:
    inside = _crossings_and_sides(diagram, tick)[1]
    return _of_cells(diagram, np.flatnonzero(inside[: len(diagram.simplices)]), np.empty(0, np.int64), None)


def _sk3(diagram: VoronoiDiagram, tick: Tick) -> _Elements:
    crossings, inside = _crossings_and_sides(diagram, tick)
    whole = edges_wholly_inside(diagram, crossings, inside)
    faces = _whole_faces(diagram, whole, crossings.faces)
    return _of_cells(diagram, np.flatnonzero(inside[: len(diagram.simplices)]), np.flatnonzero(whole), faces)


def _sk4(diagram: VoronoiDiagram, tick: Tick) -> _Elements:
    faces = _whole_faces(diagram, diagram.within, np.empty(0, np.int64))
    return _of_cells(diagram, np.flatnonzero(diagram.inside), np.flatnonzero(diagram.within), faces)


def _sk2(diagram: VoronoiDiagram, tick: Tick) -> _Elements:
    crossings, inside = _crossings_and_sides(diagram, tick)
    cells = np.flatnonzero(inside[: len(diagram.simplices)])
    if diagram.dim == 2:
        return _with_pieces(diagram, _of_cells(diagram, cells, np.empty(0, np.int64), None), crossings, inside)
    whole = edges_wholly_inside(diagram, crossings, inside)
    everywhere = voronoi_faces(diagram, np.arange(len(diagram.simplices)))
    is_whole = everywhere.closed & everywhere.all_of(whole[diagram.edge_of_half[everywhere.ahead]])
    is_whole &= ~found_in(everywhere.keys, crossings.faces)
    some = everywhere.any_of(inside[everywhere.cells]) | found_in(everywhere.keys, crossings.faces)
    tick(0.7)
    faces = ordered(diagram, everywhere, np.flatnonzero(is_whole))
    cut = ordered(diagram, everywhere, np.flatnonzero(some & ~is_whole))
    tick(0.8)
    return _with_polygons(diagram, _of_cells(diagram, cells, np.empty(0, np.int64), faces), crossings, inside, cut)


METHODS: dict[str, Callable[[VoronoiDiagram, Tick], _Elements]] = {"sk1": _sk1, "sk2": _sk2, "sk3": _sk3, "sk4": _sk4}


def _whole_faces(diagram: VoronoiDiagram, whole: Bools, crossed: Ints) -> VoronoiFaces | None:
    """Ordered Voronoi faces all of whose edges are `whole`, without those that are crossed; none in the plane."""
    if diagram.dim == 2:
        return None
    flags = whole[diagram.edge_of_half].reshape(-1, 4)
    faces = voronoi_faces(diagram, np.flatnonzero(flags.any(axis=1)))
    chosen = faces.closed & faces.all_of(flags.ravel()[faces.ahead])
    chosen &= ~found_in(faces.keys, crossed)
    return ordered(diagram, faces, np.flatnonzero(chosen))


def _of_cells(diagram: VoronoiDiagram, cells: Ints, edges: Ints, faces: VoronoiFaces | None) -> _Elements:
    """Whole Voronoi vertices, edges and faces."""
    number = np.full(len(diagram.simplices), -1, np.int64)
    number[cells] = np.arange(len(cells))
    keys = np.empty(0, np.int64) if faces is None else faces.keys
    ends = np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1)
    x = diagram.coordinates
    return _Elements(
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


def _with_pieces(diagram: VoronoiDiagram, whole: _Elements, crossings: Crossings, inside: Bools) -> _Elements:
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
    return _Elements(
        np.concatenate([whole.points, points]),
        np.concatenate([whole.radius, np.sqrt((away**2).sum(axis=1))]),
        np.concatenate([whole.cells, np.full(len(added), -1)]),
        whole.vertices,
        lines.reshape(-1, 2),
        whole.offsets,
        whole.connectivity,
        (whole.separations[0], _longest(diagram.coordinates, generators), whole.separations[2]),
    )


def _with_polygons(
    diagram: VoronoiDiagram, whole: _Elements, crossings: Crossings, inside: Bools, cut: VoronoiFaces
) -> _Elements:
    """The elements with the parts inside of the faces that the boundary cuts."""
    face, starts, corners = clipped_faces(diagram, crossings, inside, cut)
    generators = cut.generators[face]
    away = corners - diagram.coordinates[np.repeat(generators[:, 0], np.diff(starts))]
    n_whole = len(whole.points)
    return _Elements(
        np.concatenate([whole.points, corners]),
        np.concatenate([whole.radius, np.sqrt((away**2).sum(axis=1))]),
        np.concatenate([whole.cells, np.full(len(corners), -1)]),
        whole.vertices,
        whole.lines,
        np.concatenate([whole.offsets, starts[1:] + whole.offsets[-1]]),
        np.concatenate([whole.connectivity, n_whole + np.arange(len(corners))]),
        (*whole.separations[:2], np.concatenate([whole.separations[2], _longest(diagram.coordinates, generators)])),
    )


def _merged(given: _Elements, step: float) -> _Elements:
    """Points at one place as one, the first; lines and polygons that shrink to nothing are left out."""
    if len(given.points) == 0 or step == 0:
        return given
    grid = np.rint((given.points - given.points.min(axis=0)) / step).astype(np.int64).view(np.uint64)
    names = scramble(grid[:, 0])
    for column in grid.T[1:]:
        names = scramble(names + column)
    once, first, back = np.unique(names, return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = np.empty(len(once), np.int64)
    number[order] = np.arange(len(once))
    number, first = number[back.ravel()], first[order]
    lines = number[given.lines]
    kept = lines[:, 0] != lines[:, 1]
    offsets, corners, polygons = _without_repeats(given.offsets, number[given.connectivity])
    vertices, which = np.unique(number[given.vertices], return_index=True)
    of_vertices, of_lines, of_polygons = given.separations
    return _Elements(
        given.points[first],
        given.radius[first],
        given.cells[first],
        vertices,
        lines[kept],
        offsets,
        corners,
        (of_vertices[which], of_lines[kept], of_polygons[polygons]),
    )


def _without_repeats(offsets: Ints, corners: Ints) -> tuple[Ints, Ints, Ints]:
    """Polygons without equal corners in a row, and which of them keep three or more."""
    if len(corners) == 0:
        return offsets[:1], corners, np.empty(0, np.int64)
    counts = np.diff(offsets)
    before = np.arange(len(corners)) - 1
    before[offsets[:-1]] = offsets[1:] - 1
    kept = corners != corners[before]
    counts = np.add.reduceat(kept.astype(np.int64), offsets[:-1])
    real = counts >= 3
    kept &= np.repeat(real, np.diff(offsets))
    return np.concatenate([[0], np.cumsum(counts[real])]), corners[kept], np.flatnonzero(real)


def _simplified(given: _Elements, least_separation: float, least_angle: float) -> VoronoiSkeleton:
    """Elements that are far enough apart from the points, without lines and vertices that others contain."""
    counts = np.diff(given.offsets)
    polygon_of = np.repeat(np.arange(len(counts)), counts)
    widest = (
        given.radius[given.vertices],
        given.radius[given.lines].max(axis=1, initial=0.0),
        np.maximum.reduceat(given.radius[given.connectivity], given.offsets[:-1]) if len(counts) else np.empty(0),
    )
    angles = [_angles(*pair) for pair in zip(given.separations, widest, strict=True)]
    vertex_kept, line_kept, polygon_kept = (
        (separation >= least_separation) & (angle >= least_angle)
        for separation, angle in zip(given.separations, angles, strict=True)
    )
    corners = given.connectivity[polygon_kept[polygon_of]]
    offsets = np.concatenate([[0], np.cumsum(counts[polygon_kept])])
    line_kept &= ~_bounding(given.lines, offsets, corners)
    lines = given.lines[line_kept]
    covered = np.zeros(len(given.points), bool)
    covered[corners] = covered[lines] = True
    vertex_kept &= ~covered[given.vertices]
    vertices = given.vertices[vertex_kept]
    covered[vertices] = True
    number = np.cumsum(covered) - 1
    flags = (vertex_kept, line_kept, polygon_kept)
    return VoronoiSkeleton(
        given.points[covered],
        given.radius[covered],
        given.cells[covered],
        number[vertices],
        number[lines],
        offsets,
        number[corners],
        np.concatenate([values[flag] for values, flag in zip(given.separations, flags, strict=True)]),
        np.concatenate([values[flag] for values, flag in zip(angles, flags, strict=True)]),
    )


def _angles(separation: Floats, widest: Floats) -> Floats:
    """Degrees at which two points that far apart are seen from a place that far from both."""
    share = separation / np.maximum(2 * widest, 1e-300)
    return np.degrees(2 * np.arcsin(np.minimum(share, 1.0)))


def _bounding(lines: Ints, offsets: Ints, corners: Ints) -> Bools:
    """(s,) lines that are sides of polygons."""
    if len(lines) == 0 or len(corners) == 0:
        return np.zeros(len(lines), bool)
    after = np.arange(1, len(corners) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    sides = np.stack([corners, corners[after]], axis=1).astype(np.int64)
    used = np.zeros(int(max(corners.max(), lines.max())) + 1, bool)
    used[corners] = True
    both = used[lines].all(axis=1)
    result = np.zeros(len(lines), bool)
    result[both] = found_in(edge_keys_of(*lines[both].T), edge_keys_of(*sides.T))
    return result


def _lifted(skeleton: VoronoiSkeleton, mesh: Triangulation) -> VoronoiSkeleton:
    """The skeleton in the space of the mesh's points."""
    return replace(skeleton, points=lifted(skeleton.points, mesh))
