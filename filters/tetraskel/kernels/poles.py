"""How far each point of a surface is from the medial axis, as far as its poles tell.

The Voronoi cell of a sample is long and thin and stands on the surface. Its poles are its farthest vertex and the
farthest one on the other side of the point (Amenta, Bern, Surface reconstruction by Voronoi filtering, 1999): they lie
near the medial axis, inside and outside.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.centres import circumcentre_offsets
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.points import unit_box
from tetraskel.kernels.voronoi_diagram import outward_normals

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

PIECE = 1 << 16  # simplices


def pole_distances(mesh: Triangulation, tick: Tick = silent) -> Floats:
    """(n,) distance of each point to the nearer of its two poles, in the unit of the coordinates.

    The farther pole of a point of the convex hull is at infinity. 0 where no vertex lies on the other side.
    """
    points, unit = unit_box(mesh.coordinates)
    n = len(points)
    far, cell = np.zeros(n), np.full(n, -1)
    for first, corners, _, radius in _balls(points, mesh.simplices):
        tick(0.5 * first / len(mesh))
        for ids in corners.T:
            np.maximum.at(far, ids, radius)
    for first, corners, _, radius in _balls(points, mesh.simplices):
        tick(0.5 + 0.25 * first / len(mesh))
        for ids in corners.T:
            rows = np.flatnonzero(radius == far[ids])
            np.maximum.at(cell, ids[rows], first + rows)
    outward = _outward(points, mesh)
    on_hull = (outward != 0).any(axis=1)
    way = np.where(on_hull[:, None], outward, _centres(points, mesh.simplices[cell]) - points)
    near = np.zeros(n)
    for first, corners, centres, radius in _balls(points, mesh.simplices):
        tick(0.75 + 0.25 * first / len(mesh))
        for ids in corners.T:
            behind = np.flatnonzero(((centres - points[ids]) * way[ids]).sum(axis=1) < 0)
            np.maximum.at(near, ids[behind], radius[behind])
    return np.ldexp(near, unit)


def _balls(points: Floats, simplices: Ints) -> Iterator[tuple[int, Ints, Floats, Floats]]:
    """Some simplices at a time: the first of them, their points, circumcentres and radii; 0 for flat ones."""
    for first in range(0, len(simplices), PIECE):
        corners = simplices[first : first + PIECE]
        centres = _centres(points, corners)
        away = centres - points[corners[:, 0]]
        yield first, corners, centres, np.sqrt((away**2).sum(axis=1))


def _centres(points: Floats, simplices: Ints) -> Floats:
    corners = points[simplices]
    offsets = circumcentre_offsets(corners[:, 1:] - corners[:, :1])
    offsets[~np.isfinite(offsets).all(axis=1)] = 0
    return np.asarray(corners[:, 0] + offsets)


def _outward(points: Floats, mesh: Triangulation) -> Floats:
    """(n, d) sums of the normals of the hull's facets at each point; 0 away from it."""
    cells, opposite = np.nonzero(mesh.neighbors < 0)
    normals = outward_normals(points, mesh.simplices, cells, opposite)
    total = np.zeros(points.shape)
    for corner in range(mesh.dim + 1):
        at = np.flatnonzero(opposite != corner)
        np.add.at(total, mesh.simplices[cells[at], corner], normals[at])
    return total
