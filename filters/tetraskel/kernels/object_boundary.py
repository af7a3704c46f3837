"""The boundary skeletons are judged against: a surface or outline that is given, or the boundary of the inside."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.measures import count_components
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.outline import even_odd
from tetraskel.kernels.surface_rays import (
    Surface,
    first_hits,
    inside_surface,
    nearest_on_surface,
    surface_of,
    surface_samples,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Boundary:
    """A closed surface, or closed lines of a plane.

    Attributes
    ----------
    vertices : (n, d) float
        In the coordinates of the mesh.
    facets : (f, d) int
        Triangles in space, segments in the plane.
    """

    vertices: Floats
    facets: Ints

    @cached_property
    def surface(self) -> Surface:
        """The triangles; a segment ab as one across the plane, with a corner in b and a side upright on a.

        The plane cuts it in the segment, and none of its points is nearer to a place of the plane than the segment.
        """
        if self.facets.shape[1] == 3:
            return surface_of(self.vertices, self.facets)
        a, b = self.vertices[self.facets.T]
        half = 0.5 * np.sqrt(((b - a) ** 2).sum(axis=1))
        corners = np.stack([np.column_stack([a, -half]), np.column_stack([a, half]), _in_space(b)], axis=1)
        return surface_of(corners.reshape(-1, 3), np.arange(3 * len(a)).reshape(-1, 3))

    @cached_property
    def diagonal(self) -> float:
        """Length of the diagonal of the box around it."""
        used = self.vertices[np.unique(self.facets)]
        return float(np.sqrt((np.ptp(used, axis=0) ** 2).sum()))

    def contains(self, places: Floats) -> Bools:
        """(k,) places inside."""
        if self.facets.shape[1] == 2:
            return even_odd(places, self.vertices, self.facets)
        return inside_surface(self.surface, places)

    def centredness(self, places: Floats) -> Floats:
        """(k,) 2a/(a+b) of places inside: a the distance to the boundary, b the distance to it the other way."""
        places = _in_space(places)
        away = places - nearest_on_surface(self.surface, places)
        near = np.sqrt((away**2).sum(axis=1))
        ways = away / np.maximum(near, 1e-300)[:, None]
        far, _ = first_hits(self.surface, places, ways, 1e-9 * near)
        return np.where(np.isfinite(far), 2 * near / (near + np.minimum(far, 1e300)), 0.0)

    def samples(self, n: int) -> Floats:
        """(n, d) places spread over it by area, or by length."""
        if self.facets.shape[1] == 3:
            return surface_samples(self.surface, n)
        a, b = self.vertices[self.facets.T]
        until = np.cumsum(np.sqrt(((b - a) ** 2).sum(axis=1)))
        at = (np.arange(n) + 0.5) / n * until[-1]
        chosen = np.searchsorted(until, at)
        share = ((until[chosen] - at) / np.diff(until, prepend=0.0)[chosen])[:, None]
        return share * a[chosen] + (1 - share) * b[chosen]


def _in_space(points: Floats) -> Floats:
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def boundary_of(mesh: Triangulation, inside: Bools) -> Boundary:
    """The facets between inside and outside, in the order of the simplices.

    Neighbours in other parts of a mesh have numbers from m on; `inside` then is theirs, too.
    """
    cells = np.flatnonzero(inside[: len(mesh)])
    beyond = mesh.neighbors[cells]
    row, column = np.nonzero((beyond < 0) | ~inside[beyond])
    others = np.array([[k for k in range(mesh.dim + 1) if k != skipped] for skipped in range(mesh.dim + 1)])
    return Boundary(mesh.coordinates, mesh.simplices[cells[row][:, None], others[column]])


def given_boundary(mesh: Triangulation, surface: tuple[ArrayLike, ArrayLike]) -> Boundary:
    """A closed surface (vertices, triangles), or for a mesh of triangles an outline (vertices, segments).

    Raises
    ------
    InputError
        When it has no facets, others than the mesh asks for, or does not lie in the space of the mesh.
    """
    vertices, facets = np.asarray(surface[0], dtype=float), np.asarray(surface[1])
    expected = "triangles (t, 3)" if mesh.dim == 3 else "segments of a closed outline (s, 2)"
    if facets.ndim != 2 or facets.shape[1] != mesh.dim or len(facets) == 0:
        raise InputError(f"expected a surface to judge by as {expected}, got {facets.shape}.")
    if vertices.ndim != 2 or vertices.shape[1] != mesh.points.shape[1] or not np.isfinite(vertices).all():
        wide = mesh.points.shape[1]
        raise InputError(
            f"expected finite points with {wide} coordinates for the surface to judge by, got {vertices.shape}."
        )
    if not 0 <= facets.min() <= facets.max() < len(vertices):
        raise InputError(
            f"expected point ids from 0 to {len(vertices) - 1} in the surface to judge by, got "
            f"{facets.min()} to {facets.max()}."
        )
    return Boundary(vertices if mesh.plane is None else mesh.plane.project(vertices), facets)


def object_numbers(mesh: Triangulation, inside: Bools) -> dict[str, int]:
    """`components` and the `euler` characteristic of the union of the simplices inside."""
    cells = np.sort(mesh.simplices[inside].astype(np.int64), axis=1)
    width = mesh.dim + 1
    pairs = np.concatenate([cells[:, [i, j]] for i in range(width) for j in range(i + 1, width)])
    edges = np.unique(pairs, axis=0)
    ids, ends = np.unique(edges, return_inverse=True)
    sides = np.concatenate([np.delete(cells, k, axis=1) for k in range(width)])
    n_faces = len(cells) if mesh.dim == 2 else len(np.unique(sides, axis=0)) - len(cells)
    return {
        "components": count_components(ends.reshape(-1, 2), len(ids)),
        "euler": len(ids) - len(edges) + n_faces,
    }
