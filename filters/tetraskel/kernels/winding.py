"""How often a surface winds around a point: the generalised winding number, exact near by, summed up far away.

Solid angle of a triangle: Van Oosterom and Strackee 1983. Winding number of a surface with faults: Jacobson, Kavan and
Sorkine-Hornung 2013. Far triangles as one dipole: Barill, Dickson, Schmidt, Levin and Jacobson 2018.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.points import morton_order

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FANOUT = 4  # triangles, or groups, in a group
FAR = 2.0  # radii of a group away, its dipole is off by a few per cent of the group's own small solid angle
CHUNK = 1 << 9  # points at a time: each meets some hundred groups


@dataclass(frozen=True)
class _Level:
    """Groups of triangles: middles (3, k), squared distances (k,) from which they are far, area vectors (3, k)."""

    middle: Floats
    far: Floats
    area: Floats


def winding_numbers(queries: Floats, points: Floats, triangles: Ints, tick: Tick = silent) -> Floats:
    """(q,) winding numbers of a triangle surface around points: 1 inside a closed one, 0 outside, between near holes.

    Parameters
    ----------
    queries : (q, 3) float
    points : (n, 3) float
    triangles : (t, 3) int
        Counter-clockwise as seen from outside.
    """
    found = np.zeros(len(queries))
    if len(triangles) == 0:
        return found
    order = morton_order(points[triangles].mean(axis=1))
    corners = points[triangles[order]]
    levels = _levels(corners)

    by_corner = np.ascontiguousarray(corners.transpose(1, 2, 0))
    nearby = morton_order(queries)  # points that meet the same groups are computed together

    def work(piece: slice) -> None:
        some = nearby[piece]
        found[some] = _sum_over_groups(np.ascontiguousarray(queries[some].T), by_corner, levels)

    for_chunks(work, len(queries), tick, CHUNK)
    return found / (4 * np.pi)


def _levels(corners: Floats) -> list[_Level]:
    """Single triangles first, then groups of eight, of sixty-four and so on up to one, along the Morton curve."""
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle, weight = corners.mean(axis=1), np.sqrt((area**2).sum(axis=1))
    radius = np.sqrt(((corners - middle[:, None]) ** 2).sum(axis=2)).max(axis=1)
    levels = [_level(middle, radius, area)]
    while len(middle) > 1:
        first = np.arange(0, len(middle), FANOUT)
        group = np.arange(len(middle)) // FANOUT
        safe = weight + weight.max() * 1e-12 + 1e-300  # groups of triangles without area have a middle too
        total = np.add.reduceat(safe, first)
        above = np.add.reduceat(middle * safe[:, None], first) / total[:, None]
        reach = np.sqrt(((middle - above[group]) ** 2).sum(axis=1)) + radius
        middle, radius = above, np.maximum.reduceat(reach, first)
        area, weight = np.add.reduceat(area, first), np.add.reduceat(weight, first)
        levels.append(_level(middle, radius, area))
    return levels


def _level(middle: Floats, radius: Floats, area: Floats) -> _Level:
    return _Level(np.ascontiguousarray(middle.T), (FAR * radius) ** 2, np.ascontiguousarray(area.T))


def _sum_over_groups(queries: Floats, corners: Floats, levels: list[_Level]) -> Floats:
    """Solid angles (q,) summed for (3, q) queries, from the largest group of the (3, 3, t) corners down.

    Strategy: a list of (query, group) pairs; far pairs are added as dipoles, the others replaced by the group's
    members, until single triangles are left, which are computed exactly. Axis by axis, as NumPy likes it.
    """
    n = queries.shape[1]
    total = np.zeros(n)
    query, group = np.arange(n), np.zeros(n, np.intp)
    for depth in range(len(levels) - 1, -1, -1):
        level = levels[depth]
        x, y, z = (axis[group] - of_query[query] for axis, of_query in zip(level.middle, queries, strict=True))
        squares = x * x + y * y + z * z
        is_far = squares > level.far[group]
        u, v, w = (axis[group] for axis in level.area)
        dipole = np.zeros(len(query))
        np.divide(x * u + y * v + z * w, squares * np.sqrt(squares), out=dipole, where=is_far)
        total += np.bincount(query, dipole, n)
        near = np.flatnonzero(~is_far)
        query, group = query[near], group[near]
        if depth:
            members = (group[:, None] * FANOUT + np.arange(FANOUT)).ravel()
            there = members < levels[depth - 1].middle.shape[1]
            query, group = np.repeat(query, FANOUT)[there], members[there]
    sides = np.stack([np.stack([axis[group] for axis in of_corner]) for of_corner in corners])
    return total + np.bincount(query, solid_angles(sides - queries[:, query]), n)


def solid_angles(corners: Floats) -> Floats:
    """(k,) signed solid angles of triangles (corner, axis, k) seen from the origin, positive when seen from behind."""
    a, b, c = corners
    la, lb, lc = (np.sqrt(_dot(side, side)) for side in corners)
    normal = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
    spread = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
    return np.asarray(2 * np.arctan2(_dot(a, normal), spread))


def _dot(a: Floats, b: Floats | list[Floats]) -> Floats:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
