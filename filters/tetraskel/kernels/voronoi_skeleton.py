"""The four Voronoi skeletons of an object that is a union of Delaunay simplices.

Sk1: the Voronoi vertices inside. Sk2: all points of Voronoi edges (and faces, in space) inside. Sk3: the Voronoi
elements wholly inside. Sk4: the duals of the Delaunay elements strictly inside. Sk1 lies in Sk3, and Sk3 in Sk2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.curve import lifted
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.interior import inside_by_labels
from tetraskel.kernels.mesh import Triangulation, expect_mesh
from tetraskel.kernels.voronoi_crossings import Crossings, find_crossings
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram, voronoi_diagram, without_flat_rim
from tetraskel.kernels.voronoi_elements import Elements, of_cells, whole_faces, with_pieces, with_polygons
from tetraskel.kernels.voronoi_faces import EDGES, ordered_faces
from tetraskel.kernels.voronoi_sides import edges_wholly_inside, vertices_inside
from tetraskel.kernels.voronoi_simplification import VoronoiSkeleton, merged, simplified
from tetraskel.options import VoronoiOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# Voronoi vertices closer than this share of the bounding-box diagonal are one: cospherical points have one centre.
SAME = 1e-9


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
    elements = merged(elements, SAME * diagram.size) if method != "sk4" else elements
    tick(0.9)
    kept = simplified(diagram, elements, least_separation * diagram.size, least_angle)
    return _lifted(kept, mesh)


def _crossings_and_sides(diagram: VoronoiDiagram, tick: Tick) -> tuple[Crossings, Bools]:
    crossings = find_crossings(diagram, part(tick, 0.3, 0.6))
    return crossings, vertices_inside(diagram, crossings)


def _sk1(diagram: VoronoiDiagram, tick: Tick) -> Elements:
    inside = _crossings_and_sides(diagram, tick)[1]
    return of_cells(diagram, np.flatnonzero(inside[: len(diagram.simplices)]), np.empty(0, np.int64), None)


def _sk3(diagram: VoronoiDiagram, tick: Tick) -> Elements:
    crossings, inside = _crossings_and_sides(diagram, tick)
    whole = edges_wholly_inside(diagram, crossings, inside)
    faces = None
    if diagram.dim == 3:
        faces = whole_faces(diagram, diagram.on_halves(whole), crossings.faces, part(tick, 0.6, 0.8))
    return of_cells(diagram, np.flatnonzero(inside[: len(diagram.simplices)]), np.flatnonzero(whole), faces)


def _sk4(diagram: VoronoiDiagram, tick: Tick) -> Elements:
    labels = np.append(diagram.inside, False)
    whole, faces = labels[diagram.neighbors] & diagram.inside[:, None], None
    if diagram.dim == 3:
        faces = whole_faces(diagram, whole, np.empty(0, np.int64), part(tick, 0.3, 0.8))
    return of_cells(diagram, np.flatnonzero(diagram.inside), np.flatnonzero(diagram.within), faces)


def _sk2(diagram: VoronoiDiagram, tick: Tick) -> Elements:
    crossings, inside = _crossings_and_sides(diagram, tick)
    of_simplices = inside[: len(diagram.simplices)]
    vertices = of_cells(diagram, np.flatnonzero(of_simplices), np.empty(0, np.int64), None)
    edges = edges_wholly_inside(diagram, crossings, inside)
    if diagram.dim == 2:
        return with_pieces(diagram, vertices, crossings, inside, edges)
    wanted = np.repeat(of_simplices[:, None], len(EDGES), axis=1)
    faces = ordered_faces(diagram, wanted, crossings.faces, part(tick, 0.6, 0.7))
    return with_polygons(diagram, vertices, crossings, inside, edges, faces, part(tick, 0.7, 0.8))


METHODS: dict[str, Callable[[VoronoiDiagram, Tick], Elements]] = {"sk1": _sk1, "sk2": _sk2, "sk3": _sk3, "sk4": _sk4}


def _lifted(skeleton: VoronoiSkeleton, mesh: Triangulation) -> VoronoiSkeleton:
    """The skeleton in the space of the mesh's points."""
    return replace(skeleton, points=lifted(skeleton.points, mesh))
