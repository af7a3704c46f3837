"""Voronoi skeletons the slow way: every Voronoi element against every simplex of the object, one by one."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from tetraskel import Triangulation, VoronoiSkeleton


def clipped(corners, normal, offset):
    """The part of a convex polygon (k, d) or segment where normal . x <= offset."""
    height = corners @ normal - offset
    kept = []
    for i in range(len(corners)):
        j = (i + 1) % len(corners)
        if height[i] <= 0:
            kept.append(corners[i])
        if (height[i] < 0 < height[j]) or (height[j] < 0 < height[i]):
            share = height[i] / (height[i] - height[j])
            kept.append(corners[i] + share * (corners[j] - corners[i]))
    return np.array(kept).reshape(-1, corners.shape[1])


def bisector(a, b, size):
    """A large square, in the plane a long segment, midway between two points."""
    middle, way = (a + b) / 2, b - a
    basis = np.linalg.svd(way[None])[2][1:]
    if len(basis) == 1:
        return np.array([middle - size * basis[0], middle + size * basis[0]])
    return np.array([middle + size * (s * basis[0] + t * basis[1]) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def measure_of(corners):
    """Area of a convex polygon in space, length of a segment in the plane (given once or there and back)."""
    if len(corners) < corners.shape[1]:
        return 0.0
    if corners.shape[1] == 2:
        return float(np.linalg.norm(np.ptp(corners, axis=0)))
    fans = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0])
    return float(np.linalg.norm(fans.sum(axis=0)) / 2)


def half_spaces(mesh: Triangulation, cell: int):
    """Normals and offsets whose common part is a simplex."""
    corners = mesh.points[mesh.simplices[cell]]
    for k in range(len(corners)):
        others = np.delete(corners, k, axis=0)
        normal = np.linalg.svd(others[1:] - others[0])[2][-1]
        if normal @ (corners[k] - others[0]) > 0:
            normal = -normal
        yield normal, normal @ others[0]


def measure_of_sk2(mesh: Triangulation, inside) -> float:
    """Length in the plane, area in space, of all Voronoi edges or faces within the object."""
    x, total = mesh.points, 0.0
    size = 10 * np.linalg.norm(np.ptp(x, axis=0))
    edges = {tuple(sorted(pair)) for cell in mesh.simplices for pair in combinations(cell.tolist(), 2)}
    for a, b in sorted(edges):
        face = bisector(x[a], x[b], size)
        for c in range(len(x)):
            if c not in (a, b) and len(face):
                face = clipped(face, 2 * (x[c] - x[a]), x[c] @ x[c] - x[a] @ x[a])
        for cell in np.flatnonzero(inside):
            part = face
            for normal, offset in half_spaces(mesh, cell):
                if len(part):
                    part = clipped(part, normal, offset)
            total += measure_of(part)
    return total


def polygon_areas(skeleton: VoronoiSkeleton):
    """Area of each polygon of a skeleton, by Newell's formula."""
    areas = []
    for k in range(skeleton.n_polygons):
        corners = skeleton.points[skeleton.connectivity[skeleton.offsets[k] : skeleton.offsets[k + 1]]]
        corners = corners - corners[0]
        areas.append(np.linalg.norm(np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)) / 2)
    return np.array(areas)


def line_lengths(skeleton: VoronoiSkeleton):
    """Length of each line of a skeleton."""
    ends = skeleton.points[skeleton.lines]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
