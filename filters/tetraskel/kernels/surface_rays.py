"""Distances and rays to a triangulated surface, in plain NumPy: scoring needs no VTK and no tree that could miss."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.points import morton_order

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

GROUP = 32  # triangles looked at together
SURFACE_PAIRS = 1 << 22  # entries of a distance matrix at a time
EDGE_ON = 1e-150  # of the box of a triangle: what rounding leaves of its area as seen along a ray
SLACK = 1e-9  # of a triangle's size: rays through an edge meet both triangles rather than none


@dataclass(frozen=True)
class Groups:
    """Triangles close to one another, with a ball around them.

    Attributes
    ----------
    members : (g, GROUP) int
        Triangles; -1 where the last group has no more.
    centres : (g, 3) float
        A point of the surface in the middle of each group: the centre of one of its triangles.
    reaches : (g,) float
        No point of the group is farther from its centre.
    """

    members: Ints
    centres: Floats
    reaches: Floats

    def pairs(self, near: Bools) -> tuple[Ints, Ints]:
        """Rows, ascending, and triangles of the groups marked in (k, g)."""
        row, group = np.nonzero(near)
        triangles = self.members[group]  # (p, GROUP)
        real = triangles >= 0
        return np.repeat(row, real.sum(axis=1)), triangles[real]


@dataclass(frozen=True)
class Surface:
    """Triangles with their bounding balls.

    Attributes
    ----------
    corners : (t, 3, 3) float
    centres : (t, 3) float
    reaches : (t,) float
        Farthest corner from the centre.
    """

    corners: Floats
    centres: Floats
    reaches: Floats

    @cached_property
    def normals(self) -> Floats:
        """(t, 3) of unit length; 0 where a triangle has no area."""
        a, b, c = self.corners.transpose(1, 0, 2)
        sides = np.cross(b - a, c - a)
        long = np.sqrt((sides**2).sum(axis=1, keepdims=True))
        return sides / np.where(long > 0, long, 1.0)

    @cached_property
    def groups(self) -> Groups:
        """Groups along a Morton curve."""
        order = morton_order(self.centres)
        n_groups = -(-len(order) // GROUP)
        members = np.full((n_groups, GROUP), -1, np.int64)
        members.flat[: len(order)] = order
        counts = (members >= 0).sum(axis=1)
        centres = self.centres[members[np.arange(n_groups), counts // 2]]
        away = np.sqrt(((self.centres[members] - centres[:, None]) ** 2).sum(axis=2)) + self.reaches[members]
        return Groups(members, centres, np.where(members >= 0, away, 0.0).max(axis=1))


def surface_of(vertices: Floats, triangles: Ints) -> Surface:
    """Triangles ready for questions."""
    corners = np.asarray(vertices, dtype=float)[np.asarray(triangles)]
    centres = corners.mean(axis=1)
    reaches = np.sqrt(((corners - centres[:, None]) ** 2).sum(axis=2)).max(axis=1)
    return Surface(corners, centres, reaches)


def nearest_on_surface(surface: Surface, places: Floats) -> Floats:
    """(k, 3) nearest point of the surface to each place.

    Strategy: a triangle can hold the nearest point only if its bounding ball begins nearer than the nearest centre of
    a triangle, which is a point of the surface; the exact answer is computed for those pairs alone. Groups of
    triangles, in balls of their own, are sorted out the same way first.
    """
    nearest, groups = np.empty((len(places), 3)), surface.groups
    for rows in _chunks(len(places), len(surface.centres)):
        away = np.sqrt(_squares(places[rows], groups.centres))
        bound = away.min(axis=1, keepdims=True)
        place, triangle = groups.pairs(away - groups.reaches <= bound + SLACK * (bound + groups.reaches))
        least, most = _bounds(surface, places[rows][place], triangle)
        bound = np.minimum.reduceat(most, np.flatnonzero(np.diff(place, prepend=-1)))[place]
        near = least <= bound + SLACK * (bound + surface.reaches[triangle])
        place, triangle = place[near], triangle[near]
        found = nearest_in_triangles(places[rows][place], surface.corners[triangle])
        order = np.lexsort([triangle, ((found - places[rows][place]) ** 2).sum(axis=1), place])
        nearest[rows] = found[order[np.flatnonzero(np.diff(place[order], prepend=-1))]]
    return nearest


def _bounds(surface: Surface, places: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """(k,) bounds of the distance from each place to its triangle: to a disc of its plane around it, to its centre."""
    away, reach = places - surface.centres[triangles], surface.reaches[triangles]
    square, height = (away**2).sum(axis=1), (away * surface.normals[triangles]).sum(axis=1)
    beside = np.sqrt(np.maximum(square - height**2, 0))
    return np.hypot(height, np.maximum(beside - reach, 0)), np.sqrt(square)


def first_hits(surface: Surface, starts: Floats, directions: Floats, beyond: Floats) -> tuple[Floats, Ints]:
    """Distance along each ray to the first triangle farther than `beyond` (k,), inf for none; and the number of hits.

    `directions` have unit length.
    """
    first, count, groups = np.full(len(starts), np.inf), np.zeros(len(starts), np.int64), surface.groups
    for rows in _chunks(len(starts), len(surface.centres)):
        origin, way = starts[rows], directions[rows]
        along = way @ groups.centres.T - (origin * way).sum(axis=1)[:, None]
        square = _squares(origin, groups.centres) - along**2
        ray, triangle = groups.pairs((square <= (groups.reaches * (1 + 1e-6)) ** 2) & (along >= -groups.reaches))
        to_centre, reach = surface.centres[triangle] - origin[ray], surface.reaches[triangle]
        along = (to_centre * way[ray]).sum(axis=1)
        met = ((to_centre**2).sum(axis=1) - along**2 <= (reach * (1 + 1e-6)) ** 2) & (along >= -reach)
        ray, triangle = ray[met], triangle[met]
        distance = _hit_distances(origin[ray], way[ray], surface.corners[triangle])
        hit = distance > beyond[rows][ray]
        np.minimum.at(first[rows], ray[hit], distance[hit])
        count[rows] = np.bincount(ray[hit], minlength=len(origin))
    return first, count


def inside_surface(surface: Surface, places: Floats) -> Bools:
    """(k,) places inside a closed surface: an odd number of crossings on at least two of three rays."""
    generator = np.random.default_rng(7)  # directions that meet no edge of a regular mesh
    votes = np.zeros(len(places), np.int64)
    for ray in range(3):
        way = generator.normal(size=3)
        unsure = np.flatnonzero(votes == 1) if ray == 2 else np.arange(len(places))  # two that agree need no third
        ways = np.tile(way / np.sqrt((way**2).sum()), (len(unsure), 1))
        votes[unsure] += first_hits(surface, places[unsure], ways, np.zeros(len(unsure)))[1] % 2
    return votes >= 2


def surface_samples(surface: Surface, n: int) -> Floats:
    """(n, 3) points spread over the surface by area, always the same ones."""
    generator = np.random.default_rng(11)
    a, b, c = surface.corners.transpose(1, 0, 2)
    area = np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1))
    chosen = np.searchsorted(np.cumsum(area) / area.sum(), (np.arange(n) + 0.5) / n)
    s, t = np.sqrt(generator.random(n))[:, None], generator.random(n)[:, None]
    return (1 - s) * a[chosen] + s * (1 - t) * b[chosen] + s * t * c[chosen]


def _chunks(n: int, width: int) -> list[slice]:
    step = max(SURFACE_PAIRS // max(width, 1), 1)
    return [slice(start, min(start + step, n)) for start in range(0, n, step)]


def _squares(places: Floats, centres: Floats) -> Floats:
    middle = centres.mean(axis=0)  # small numbers: the squares are subtracted
    a, b = places - middle, centres - middle
    square = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1)[None] - 2 * a @ b.T
    return np.maximum(square, 0)


def _hit_distances(origin: Floats, way: Floats, corners: Floats) -> Floats:
    """Distance to each triangle along each ray, -inf where it is missed (Moeller and Trumbore 1997)."""
    first, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(way, v)
    volume = (u * across).sum(axis=1)
    reach = np.abs(u).max(axis=1) * np.abs(v).max(axis=1)
    solid = np.abs(volume) > EDGE_ON * reach  # else seen edge on
    scale = np.where(solid, volume, 1.0)
    away = origin - first
    turned = np.cross(away, u)
    with np.errstate(over="ignore", invalid="ignore"):  # triangles smaller than a square that is not 0 are missed
        s = (away * across).sum(axis=1) / scale
        t = (way * turned).sum(axis=1) / scale
        met = solid & (s >= -SLACK) & (t >= -SLACK) & (s + t <= 1 + SLACK)
        return np.where(met, (v * turned).sum(axis=1) / scale, -np.inf)


def nearest_in_triangles(places: Floats, corners: Floats) -> Floats:
    """(k, 3) nearest point of each place's triangle: the foot of the perpendicular, or the best of its three edges."""
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    square = (normal**2).sum(axis=1)
    solid = square > 0
    height = ((places - a) * normal).sum(axis=1) / np.where(solid, square, 1.0)
    foot = places - height[:, None] * normal
    inside = solid.copy()
    candidates = []
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(q - p, foot - p) * normal).sum(axis=1) >= 0
        edge = q - p
        long = (edge**2).sum(axis=1)
        share = ((places - p) * edge).sum(axis=1) / np.where(long > 0, long, 1.0)
        candidates.append(p + np.clip(share, 0, 1)[:, None] * edge)
    choices = np.stack(candidates)
    best = ((choices - places) ** 2).sum(axis=2).argmin(axis=0)
    return np.where(inside[:, None], foot, choices[best, np.arange(len(places))])
