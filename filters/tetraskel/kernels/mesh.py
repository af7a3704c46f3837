"""The triangulation every stage works on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.plane import Plane, plane_of_mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Triangulation:
    """Simplices over points, with their neighbours.

    Attributes
    ----------
    points : (n, e) float
        Coordinates in the input's length unit; e = 2 or 3.
    simplices : (m, d+1) int
        Point ids of each triangle (d = 2) or tetrahedron (d = 3). Triangles may live in 3D (e = 3) when all
        points lie in one plane.
    neighbors : (m, d+1) int
        Simplex across the facet opposite each vertex, -1 outside the mesh.
    original_ids : (n,) int
        Input id of each point (of the first of several equal ones).
    point_map : (n_input,) int
        For every input point the id of the point that stands for it.
    engine : str
        What made the triangulation.
    noise : float
        Standard deviation of the input across its surface, which was taken out; 0 when the points are the input's.
    """

    points: Floats
    simplices: Ints
    neighbors: Ints
    original_ids: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    point_map: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    engine: str = "given"
    noise: float = 0.0

    @property
    def dim(self) -> int:
        """Dimension d of the simplices."""
        return int(self.simplices.shape[1]) - 1

    @property
    def n_merged(self) -> int:
        """How many input points another one stands for."""
        return max(len(self.point_map) - len(self.points), 0)

    @cached_property
    def plane(self) -> Plane | None:
        """The plane of triangles in space; None where the mesh fills its space."""
        if self.dim == self.points.shape[1] or len(self) == 0:
            return None
        return plane_of_mesh(self.points[np.unique(self.simplices)])

    @cached_property
    def coordinates(self) -> Floats:
        """(n, d) coordinates in which the mesh is full-dimensional: the points, or their plane coordinates."""
        return self.points[:, : self.dim] if self.plane is None else self.plane.project(self.points)

    def __len__(self) -> int:
        return len(self.simplices)


def submesh(mesh: Triangulation, kept: Bools) -> Triangulation:
    """The simplices where (m,) `kept` holds, in order; points and their ids stay as they are.

    Neighbours are renumbered; a facet to a simplex that is gone becomes part of the boundary.
    """
    new_id = np.append(np.cumsum(kept, dtype=np.int32) - 1, np.int32(-1))
    new_id[:-1][~kept] = -1
    return replace(mesh, simplices=mesh.simplices[kept], neighbors=new_id[mesh.neighbors[kept]])


def expect_mesh(mesh: object) -> None:
    """Raise `InputError` for anything but a `Triangulation`."""
    if not isinstance(mesh, Triangulation):
        raise InputError(
            f"expected a Triangulation, got {type(mesh).__name__}; make one with triangulate or triangulation_of."
        )
