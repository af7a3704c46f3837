"""Tubes with exact axes: random unoriented points on their surface, and what the skeleton must be."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.curve_skeleton import JUNCTION, Skeleton

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tube:
    """A union of balls along polylines, one radius per polyline.

    `axes` are the polylines (k, d), finely sampled; points are drawn on the boundary of the union.
    """

    axes: list[Floats]
    radii: list[float]
    loops: int = 0
    ends: int = 2
    junctions: int = 0

    def sample(self, n: int, seed: int = 0, noise: float = 0.0) -> Floats:
        """n random points of the surface, each moved by a normal error of `noise` diagonals."""
        rng = np.random.default_rng(seed)
        pieces: list[Floats] = []
        tubes = list(zip(self.axes, self.radii, strict=True))
        while sum(map(len, pieces)) < n:
            candidates = np.concatenate([around(axis, r, n, rng) for axis, r in tubes])
            depth = np.min([distance_to(axis, candidates) - r for axis, r in tubes], axis=0)
            pieces.append(candidates[depth > -1e-9])
        points = rng.permutation(np.concatenate(pieces))[:n]
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        return points + rng.normal(size=points.shape) * (noise * diagonal)

    def axis_distance(self, places: Floats) -> Floats:
        """Distance from places to the axis, in its radius."""
        return np.min([distance_to(axis, places) / r for axis, r in zip(self.axes, self.radii, strict=True)], 0)

    def local_radius(self, places: Floats) -> Floats:
        """Radius of the nearest axis."""
        away = np.array([distance_to(axis, places) for axis in self.axes])
        return np.asarray(self.radii)[away.argmin(axis=0)]


def radius_error(skeleton: Skeleton, tube: Tube) -> float:
    """Mean error of the radius over the local one, away from junctions."""
    junctions = skeleton.points[skeleton.node_type == JUNCTION]
    away = np.array([np.linalg.norm(junctions - p, axis=1).min(initial=np.inf) for p in skeleton.points])
    alone = away > 1.5 * skeleton.radius
    error = np.abs(skeleton.radius / tube.local_radius(skeleton.points) - 1)
    return float(error[alone].mean())


def around(axis: Floats, radius: float, n: int, rng: np.random.Generator) -> Floats:
    """Random points on the boundary of the balls along one polyline, in number by its area."""
    a, b = axis[:-1], axis[1:]
    long = np.linalg.norm(b - a, axis=1)
    closed = np.allclose(axis[0], axis[-1])
    count = max(int(n * (long.sum() + (0 if closed else 2 * radius)) / (long.sum() + 2 * radius)), 1)
    area = np.concatenate([long, [] if closed else [radius, radius]])  # halves of a sphere have the area of 2r of tube
    edge = rng.choice(len(area), count, p=area / area.sum())
    ways = rng.normal(size=(count, axis.shape[1]))
    centres = np.empty((count, axis.shape[1]))
    on_side = edge < len(long)
    side = edge[on_side]
    direction = ((b - a) / long[:, None])[side]
    centres[on_side] = a[side] + rng.random((len(side), 1)) * (b - a)[side]
    ways[on_side] -= (ways[on_side] * direction).sum(axis=1, keepdims=True) * direction
    for number, (end, out) in enumerate([(a[0], a[0] - b[0]), (b[-1], b[-1] - a[-1])]):
        mine = edge == len(long) + number
        centres[mine] = end
        ways[mine] *= np.sign(ways[mine] @ out)[:, None]
    return centres + radius * ways / np.linalg.norm(ways, axis=1, keepdims=True)


def distance_to(axis: Floats, places: Floats) -> Floats:
    """Distance from places to a polyline."""
    best = np.full(len(places), np.inf)
    for a, b in pairwise(axis):
        share = np.clip((places - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        best = np.minimum(best, np.linalg.norm(places - a - share[:, None] * (b - a), axis=1))
    return best


def line(*corners: tuple[float, ...]) -> Floats:
    return np.array(corners, dtype=float)


def circle(radius: float, centre: tuple[float, ...] = (0, 0, 0), n: int = 96) -> Floats:
    angle = np.linspace(0, 2 * np.pi, n + 1)
    angle[-1] = 0
    flat = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    return (radius * flat + np.array([*centre, 0][:3]))[:, : len(centre)]


def capsule() -> Tube:
    return Tube([line((0, 0, 0), (4, 0, 0))], [0.5])


def bent_tube() -> Tube:
    angle = np.linspace(0, np.pi / 2, 40)
    return Tube([3 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)], [0.5])


def y_tube() -> Tube:
    arms = [(0, -3, 0), (2.6, 1.5, 0), (-2.6, 1.5, 0)]
    return Tube([line((0, 0, 0), arm) for arm in arms], [0.5] * 3, ends=3, junctions=1)


def torus() -> Tube:
    return Tube([circle(2.0)], [0.6], loops=1, ends=0)


def double_torus() -> Tube:
    bridge = line((-0.5, 0, 0), (0.5, 0, 0))
    return Tube([circle(2.0, (-2.5, 0, 0)), circle(2.0, (2.5, 0, 0)), bridge], [0.5] * 3, 2, 0, 2)


def helix() -> Tube:
    turn = np.linspace(0, 4 * np.pi, 120)
    return Tube([np.stack([2 * np.cos(turn), 2 * np.sin(turn), 0.35 * turn], axis=1)], [0.45])


def branching_tree() -> Tube:
    trunk = line((0, 0, 0), (0, 0, 8))
    twigs = [line((0, 0, 2), (3, 0, 3.5)), line((0, 0, 4), (-3, 0, 5.5)), line((0, 0, 6), (0, 2.5, 7))]
    return Tube([trunk, *twigs], [0.5, 0.35, 0.35, 0.3], ends=5, junctions=3)


def flat_ring() -> Tube:
    return Tube([circle(2.0, (0, 0))], [0.5], loops=1, ends=0)


TUBES = {
    "capsule": capsule,
    "bent tube": bent_tube,
    "y": y_tube,
    "torus": torus,
    "double torus": double_torus,
    "helix": helix,
    "tree": branching_tree,
    "annulus": flat_ring,
}


def cylinder(n: int, seed: int = 0, radius: float = 0.5, length: float = 4.0) -> Floats:
    """Random points of a cylinder with flat ends along the first axis."""
    rng = np.random.default_rng(seed)
    cap = rng.random(n) < radius / (length + radius)
    angle = rng.uniform(0, 2 * np.pi, n)
    out = np.where(cap, radius * np.sqrt(rng.random(n)), radius)
    along = np.where(cap, rng.integers(0, 2, n) * length, rng.uniform(0, length, n))
    return np.stack([along, out * np.cos(angle), out * np.sin(angle)], axis=1)
