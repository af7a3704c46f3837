"""One row per branch, with the columns that users of vessel software know."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

COLUMNS = ("CellId", "Radius", "Length", "Curvature", "Torsion", "Tortuosity", "StartPointPosition", "EndPointPosition")


def branch_table(points: Floats, radius: Floats, offsets: Ints, connectivity: Ints) -> list[tuple[object, ...]]:
    """Rows of `COLUMNS` for polylines over `points` (p, 3).

    Radius is the mean over the length, Tortuosity length over distance between the ends, less 1 (infinite for a closed
    branch). Curvature and Torsion are means over the length: the sum of the angles between successive edges, and
    between successive osculating planes, divided by the length (discrete curve theory, Sauer 1970). Lengths in the
    unit of the points, positions as "x y z".
    """
    rows = []
    for number, (start, stop) in enumerate(itertools.pairwise(offsets)):
        ids = connectivity[start:stop]
        path = points[ids]
        edges = np.diff(path, axis=0)
        steps = np.sqrt((edges**2).sum(axis=1))
        length, chord = float(steps.sum()), float(np.sqrt(((path[-1] - path[0]) ** 2).sum()))
        thickness = float(((radius[ids][1:] + radius[ids][:-1]) / 2 * steps).sum() / length) if length else float("nan")
        turning, twisting = total_angles(edges)
        per_length = 1 / length if length else 0.0
        tortuosity = length / chord - 1 if chord else float("inf")
        ends = [" ".join(f"{x:.9g}" for x in end) for end in (path[0], path[-1])]
        rows.append((number, thickness, length, turning * per_length, twisting * per_length, tortuosity, *ends))
    return rows


def total_angles(edges: Floats) -> tuple[float, float]:
    """Sums of the angles between successive (k, 3) edges, and between the planes of successive pairs, in radians."""
    edges = edges[(edges**2).sum(axis=1) > 0]
    normals = np.cross(edges[:-1], edges[1:])
    turning = float(_angles(edges).sum())
    return turning, float(_angles(normals[(normals**2).sum(axis=1) > 0]).sum())


def _angles(vectors: Floats) -> Floats:
    """Angles between successive vectors; by the tangent, which is exact for small ones."""
    across = np.sqrt((np.cross(vectors[:-1], vectors[1:]) ** 2).sum(axis=1))
    return np.arctan2(across, (vectors[:-1] * vectors[1:]).sum(axis=1))
