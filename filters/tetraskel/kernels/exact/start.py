"""The first simplex: points that span their space, for certain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.predicates import determinant, exact_integers

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAMPLE = 1000  # points among which to look first


def first_simplex(points: Floats) -> Ints | None:
    """Indices of d+1 points in positive orientation; None where all lie in one plane (on one line, in 2D).

    Wide ones are looked for in floating point, among a few points first; whether they span is decided in whole numbers.
    """
    n, dim = points.shape
    if n <= dim:
        return None
    for step in (n // SAMPLE, 1):
        chosen = _widest(points[:: max(step, 1)]) * max(step, 1)
        if _sign(points[chosen]) != 0:
            return _oriented(points, chosen)
    found = _any(points)
    return None if found is None else _oriented(points, found)


def _widest(points: Floats) -> Ints:
    """The first point, the farthest from it, the farthest from their line, and from their plane: as far as rounding."""
    found = [0]
    apart = points - points[0]
    for _ in range(points.shape[1]):
        distances = np.abs(apart).max(axis=1)
        found.append(int(np.argmax(distances)))
        unit = apart[found[-1]] / (distances[found[-1]] or 1.0)
        unit = unit / (np.sqrt((unit**2).sum()) or 1.0)
        apart = apart - (apart * unit).sum(axis=1)[:, None] * unit
    return np.array(found)


def _sign(corners: Floats) -> int:
    whole = exact_integers(corners)
    volume = determinant([list(row) for row in whole[1:] - whole[0]])
    return int(volume > 0) - int(volume < 0)


def _oriented(points: Floats, chosen: Ints) -> Ints:
    return chosen if _sign(points[chosen]) > 0 else chosen[[1, 0, *range(2, len(chosen))]]


def _any(points: Floats) -> Ints | None:
    """The first point off the line of the first two, and in space the first off their plane."""
    whole = exact_integers(points)
    edges = (whole - whole[0]).T
    normals = _cross(edges[:, 1], edges)
    off_line = np.flatnonzero((normals != 0).any(axis=0))
    if len(off_line) == 0 or len(points[0]) == 2:
        return np.array([0, 1, off_line[0]]) if len(off_line) else None
    normal = normals[:, off_line[0]]
    off_plane = np.flatnonzero(sum(normal[axis] * edges[axis] for axis in range(3)) != 0)
    return np.array([0, 1, off_line[0], off_plane[0]]) if len(off_plane) else None


def _cross(a: NDArray[np.object_], b: NDArray[np.object_]) -> NDArray[np.object_]:
    if len(a) == 2:
        return np.array([a[0] * b[1] - a[1] * b[0]], dtype=object)
    pairs = ((1, 2), (2, 0), (0, 1))
    return np.array([a[i] * b[j] - a[j] * b[i] for i, j in pairs], dtype=object)
