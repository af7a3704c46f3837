"""Vectors of three numbers as tuples, for the other compiled loops. Imported only where numba is."""

from __future__ import annotations

from tetraskel.kernels.compilation import inlined


@inlined
def place_of(points, a):
    """One of (n, 3) points."""
    return points[a, 0], points[a, 1], points[a, 2]


@inlined
def between(points, a, b):
    """From one of (n, 3) points to another."""
    return points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]


@inlined
def minus(u, v):
    """The difference."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


@inlined
def dot(u, v):
    """The scalar product, added from the first term on."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@inlined
def cross(u, v):
    """The vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
