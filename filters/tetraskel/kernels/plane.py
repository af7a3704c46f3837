"""Points that lie in one plane of space: recognise it and give them two coordinates.

The 2D method runs in these coordinates; ids are unchanged, so results lift back by themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError

Floats = NDArray[np.float64]

# A cloud thinner than this many roundings of its coordinates is flat: two for storing a rotated coordinate, the rest
# for the matrix products that made it.
ROUNDINGS = 16


@dataclass(frozen=True)
class Plane:
    """A plane of space with two coordinates.

    Attributes
    ----------
    origin : (3,) float
        The place with coordinates (0, 0).
    directions : (2, 3) float
        Orthonormal.
    """

    origin: Floats
    directions: Floats

    def project(self, points: Floats) -> Floats:
        """(n, 2) coordinates of (n, 3) points; exact in planes normal to an axis."""
        return np.stack([dot(points - self.origin, direction) for direction in self.directions], axis=1)

    def lift(self, coordinates: Floats) -> Floats:
        """(n, 3) points with these (n, 2) coordinates."""
        return self.origin + coordinates[:, :1] * self.directions[0] + coordinates[:, 1:] * self.directions[1]


def roundings_by_axis(points: NDArray[np.generic], dtype: np.dtype | None = None) -> Floats:
    """(e,) size of what rounding may have done to each coordinate, in its unit."""
    kind = np.dtype(dtype or points.dtype)
    eps = np.finfo(kind).eps if kind.kind == "f" else np.finfo(np.float64).eps
    return ROUNDINGS * eps * np.abs(points.astype(np.float64)).max(axis=0, initial=0.0)


def rounding(points: NDArray[np.generic], dtype: np.dtype | None = None) -> float:
    """Size of what rounding may have done to any coordinate, in its unit."""
    return float(roundings_by_axis(points, dtype).max(initial=0.0))


def plane_of(points: Floats, tolerance: Floats) -> Plane | None:
    """The plane that holds (n, 3) points, or None if they differ from every plane by more than rounding.

    Planes normal to an axis keep the other two coordinates exactly, in order. Otherwise the axis nearest to the normal
    is dropped and the other two are projected into the plane and made orthonormal, in order. The plane is a function
    of the points, not of their order.

    Parameters
    ----------
    points : (n, 3) array
    tolerance : (3,) float
        What rounding may have done to each coordinate.
    """
    span = np.ptp(points, axis=0)
    if (span <= tolerance).any():
        axis = int(np.argmin(np.where(span <= tolerance, span, np.inf)))
        origin = np.zeros(3)
        origin[axis] = points[:, axis].min()
        return Plane(origin, np.delete(np.eye(3), axis, axis=0))
    if not _is_flat(points, tolerance):
        return None
    ranked = points[np.lexsort(points.T[::-1])]
    normal = _widest_normal(ranked)
    first, second = np.delete(np.eye(3), np.argmax(np.abs(normal)), axis=0)
    u = _unit(first - normal * dot(first, normal))
    v = second - normal * dot(second, normal)
    return Plane(ranked[0], np.stack([u, _unit(v - u * dot(v, u))]))


def _is_flat(points: Floats, tolerance: Floats) -> bool:
    normal = _widest_normal(points)
    distance = dot(points - points[0], normal)
    return bool(np.ptp(distance) <= dot(np.abs(normal), tolerance))


def _widest_normal(points: Floats) -> Floats:
    """Unit normal of the plane through the first point, the farthest from it and the farthest from their line.

    Points on one line have many; any is given.
    """
    moved = _unit_size(points - points[0])
    far = _unit(moved[np.argmax(dot(moved, moved))])
    across = np.cross(moved, far)
    normal = across[np.argmax(dot(across, across))]
    return _unit(normal) if normal.any() else _unit(np.cross(far, np.eye(3)[np.argmin(np.abs(far))]))


def _unit_size(moved: Floats) -> Floats:
    """Divided by a power of two near the largest coordinate, so that products stay finite in every unit."""
    return np.ldexp(moved, -int(np.frexp(np.abs(moved).max(initial=0.0))[1]))


def on_one_line(coordinates: Floats, tolerance: float) -> bool:
    """Whether all (n, 2) points lie on one line, up to `tolerance`."""
    moved = coordinates - coordinates[0]
    far = moved[np.argmax((_unit_size(moved) ** 2).sum(axis=1))]
    far = far / np.hypot(*far)
    return bool(np.ptp(moved[:, 0] * far[1] - moved[:, 1] * far[0]) <= tolerance)


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products of 3-vectors, added in a fixed order: equal to the last bit with every BLAS."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])


def _unit(vector: Floats) -> Floats:
    return vector / np.sqrt(dot(vector, vector))


def plane_of_mesh(points: Floats) -> Plane:
    """The plane of a mesh of triangles in space, its (n, 3) points stored in double or in single precision.

    Raises
    ------
    InputError
        When the points do not lie in one plane.
    """
    for kind in (np.float64, np.float32):
        plane = plane_of(points, roundings_by_axis(points, np.dtype(kind)))
        if plane is not None:
            return plane
    raise InputError(
        "expected triangles in one plane, got triangles that bend in space; "
        "triangulate the points into tetrahedra first (DelaunayMesh)."
    )
