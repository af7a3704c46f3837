"""Distances and rays to a triangulated surface, in plain NumPy: scoring needs no VTK and no tree that could miss."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

SURFACE_PAIRS = 1 << 22  # entries of a distance matrix at a time
EDGE_ON = 1e-150  # of the box of a triangle: what rounding leaves of its area as seen along a ray
SLACK = 1e-9  # of a triangle's size: rays through an edge meet both triangles rather than none


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


def surface_of(vertices: Floats, triangles: Ints) -> Surface:
    """Triangles ready for questions."""
    corners = np.asarray(vertices, dtype=float)[np.asarray(triangles)]
    centres = corners.mean(axis=1)
    reaches = np.sqrt(((corners - centres[:, None]) ** 2).sum(axis=2)).max(axis=1)
    return Surface(corners, centres, reaches)


def nearest_on_surface(surface: Surface, places: Floats) -> Floats:
    """(k, 3) nearest point of the surface to each place.

    Strategy: a triangle can hold the nearest point only if its bounding ball begins nearer than the nearest ball
    ends; the exact answer is computed for those pairs alone.
    """
    nearest = np.empty((len(places), 3))
    for rows in _chunks(len(places), len(surface.centres)):
        away = _distances(places[rows], surface.centres)
        bound = (away + surface.reaches).min(axis=1, keepdims=True)
        place, triangle = np.nonzero(away - surface.reaches <= bound * (1 + SLACK))
        found = nearest_in_triangles(places[rows][place], surface.corners[triangle])
        order = np.lexsort([((found - places[rows][place]) ** 2).sum(axis=1), place])
        nearest[rows] = found[order[np.flatnonzero(np.diff(place[order], prepend=-1))]]
    return nearest


def first_hits(surface: Surface, starts: Floats, directions: Floats, beyond: Floats) -> tuple[Floats, Ints]:
    """Distance along each ray to the first triangle farther than `beyond` (k,), inf for none; and the number of hits.

    `directions` have unit length.
    """
    first, count = np.full(len(starts), np.inf), np.zeros(len(starts), np.int64)
    for rows in _chunks(len(starts), len(surface.centres)):
        origin, way = starts[rows], directions[rows]
        along = way @ surface.centres.T - (origin * way).sum(axis=1)[:, None]
        square = _distances(origin, surface.centres) ** 2 - along**2
        ray, triangle = np.nonzero((square <= (surface.reaches * (1 + 1e-6)) ** 2) & (along >= -surface.reaches))
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


def _distances(places: Floats, centres: Floats) -> Floats:
    middle = centres.mean(axis=0)  # small numbers: the squares are subtracted
    a, b = places - middle, centres - middle
    square = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1)[None] - 2 * a @ b.T
    return np.sqrt(np.maximum(square, 0))


def _hit_distances(origin: Floats, way: Floats, corners: Floats) -> Floats:
    """Distance to each triangle along each ray, -inf where it is missed (Moeller and Trumbore 1997)."""
    first, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(way, v)
    volume = (u * across).sum(axis=1)
    reach = np.abs(u).max(axis=1) * np.abs(v).max(axis=1)
    solid = np.abs(volume) > EDGE_ON * reach  # else seen edge on
    scale = np.where(solid, volume, 1.0)
    away = origin - first
    s = (away * across).sum(axis=1) / scale
    turned = np.cross(away, u)
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
