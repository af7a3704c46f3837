"""Points that lie in one plane of space: recognise it and give them two coordinates.

The 2D method runs in these coordinates; ids are unchanged, so results lift back by themselves.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError

Floats = NDArray[np.float64]

# A cloud thinner than this many roundings of its largest coordinate is flat: two for storing a rotated
# coordinate, the rest for the matrix products that made it.
ROUNDINGS = 16


def rounding(points: NDArray[np.floating], dtype: np.dtype | None = None) -> float:
    """Size of what rounding may have done to the coordinates, in their unit."""
    kind = np.dtype(dtype or points.dtype)
    eps = np.finfo(kind).eps if kind.kind == "f" else np.finfo(np.float64).eps
    return float(ROUNDINGS * eps * np.abs(points).max(initial=0.0))


def plane_frame(points: Floats, tolerance: float) -> Floats | None:
    """Two orthonormal directions (2, 3) of the plane that holds (n, 3) points, or None if none does.

    Planes normal to an axis keep the other two coordinates exactly, in order. Otherwise the axis nearest to
    the normal is dropped and the other two are projected into the plane and made orthonormal, in order.
    """
    constant = np.flatnonzero(np.ptp(points, axis=0) <= tolerance)
    if len(constant):
        return np.delete(np.eye(3), constant[0], axis=0)
    moved, tolerance = _unit_size(points - points[np.argmin(points[:, 0])], tolerance)
    normal = _widest_normal(moved)
    if normal is None or np.ptp(dot(moved, normal)) > tolerance:
        return None
    first, second = np.delete(np.eye(3), np.argmax(np.abs(normal)), axis=0)
    u = _unit(first - normal * dot(first, normal))
    v = second - normal * dot(second, normal)
    return np.stack([u, _unit(v - u * dot(v, u))])


def on_one_line(points: Floats, tolerance: float) -> bool:
    """Whether all (n, 2) or (n, 3) points lie on one line."""
    space = np.zeros((len(points), 3))
    moved, tolerance = _unit_size(points - points[np.argmin(points[:, 0])], tolerance)
    space[:, : points.shape[1]] = moved
    far = space[np.argmax(dot(space, space))]
    across = np.cross(space, _unit(far)) if far.any() else space
    return bool(np.sqrt(dot(across, across).max()) <= tolerance)


def _unit_size(moved: Floats, tolerance: float) -> tuple[Floats, float]:
    """Both divided by a power of two near the largest coordinate, so that products stay finite in every unit."""
    exponent = int(np.frexp(np.abs(moved).max(initial=0.0))[1])
    return np.ldexp(moved, -exponent), float(np.ldexp(tolerance, -exponent))


def _widest_normal(moved: Floats) -> Floats | None:
    """Unit normal of the plane through the origin, the farthest point and the point farthest from their line."""
    far = moved[np.argmax(dot(moved, moved))]
    across = np.cross(moved, far)
    normal = np.cross(moved[np.argmax(dot(across, across))], far)
    return _unit(normal) if normal.any() else None


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products of 3-vectors, added in a fixed order: equal to the last bit with every BLAS."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])


def _unit(vector: Floats) -> Floats:
    return vector / np.sqrt(dot(vector, vector))


def plane_coordinates(points: Floats, tolerance: float | None = None) -> Floats:
    """(n, 2) coordinates of coplanar (n, 3) points in their plane.

    Raises
    ------
    InputError
        When the points do not lie in one plane.
    """
    # meshes reach us in single precision as a rule, so that is what flatness is judged by
    allowed = rounding(points, np.dtype(np.float32)) if tolerance is None else tolerance
    frame = plane_frame(points, allowed) if len(points) else np.eye(3)[:2]
    if frame is None:
        raise InputError(
            "expected triangles in one plane, got triangles that bend in space; "
            "triangulate the points into tetrahedra first (DelaunayMesh)."
        )
    return np.stack([dot(points, direction) for direction in frame], axis=1)
