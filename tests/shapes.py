"""Exact shapes with known answers: random points on their surface, who lies inside, and their topology."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Shape:
    """A solid: `sample(n, rng)` puts n random points on its surface, `contains(points)` says who is inside.

    `components` counts its pieces, `loops` its independent handles, `cavities` the outside's pieces but one.
    """

    sample: Callable[[int, np.random.Generator], Floats]
    contains: Callable[[Floats], Bools]
    low: tuple[float, ...]
    high: tuple[float, ...]
    components: int = 1
    loops: int = 0
    cavities: int = 0

    @property
    def euler(self) -> int:
        return self.components - self.loops + self.cavities

    @property
    def outside_pieces(self) -> int:
        """Pieces of the outside; in the plane a loop has a hole within."""
        return 1 + (self.loops if len(self.low) == 2 else self.cavities)

    def probes(self, n: int, rng: np.random.Generator) -> Floats:
        """Random points of the bounding box."""
        return rng.uniform(self.low, self.high, (n, len(self.low)))


def rough(points: Floats, rng: np.random.Generator) -> Floats:
    """Off by 1e-4: Qhull takes minutes when thousands of points are exactly coplanar or cospherical."""
    return points + rng.normal(0, 1e-4, points.shape)


def on_sphere(n: int, rng: np.random.Generator) -> Floats:
    directions = rng.normal(size=(n, 3))
    return rough(directions / np.linalg.norm(directions, axis=1, keepdims=True), rng)


def shares(n: int, areas: Floats, rng: np.random.Generator) -> NDArray[np.int64]:
    """Which of several pieces of surface each of n points falls on."""
    return rng.choice(len(areas), n, p=np.asarray(areas) / np.sum(areas))


def ball() -> Shape:
    return Shape(on_sphere, lambda p: np.linalg.norm(p, axis=1) < 1, (-1, -1, -1), (1, 1, 1))


def shell(inner: float = 0.6) -> Shape:
    def sample(n: int, rng: np.random.Generator) -> Floats:
        return on_sphere(n, rng) * np.array([1.0, inner])[shares(n, [1, inner**2], rng)][:, None]

    def contains(p: Floats) -> Bools:
        radius = np.linalg.norm(p, axis=1)
        return (radius < 1) & (radius > inner)

    return Shape(sample, contains, (-1, -1, -1), (1, 1, 1), cavities=1)


def two_balls() -> Shape:
    centres, radii = np.array([[0.0, 0, 0], [2.0, 0.3, 0]]), np.array([1.0, 0.6])

    def sample(n: int, rng: np.random.Generator) -> Floats:
        which = shares(n, radii**2, rng)
        return centres[which] + radii[which, None] * on_sphere(n, rng)

    def contains(p: Floats) -> Bools:
        return (np.linalg.norm(p[:, None] - centres, axis=2) < radii).any(axis=1)

    return Shape(sample, contains, (-1, -1, -1), (2.6, 1, 1), components=2)


def torus(ring: float = 1.0, tube: float = 0.4) -> Shape:
    def sample(n: int, rng: np.random.Generator) -> Floats:
        kept = np.empty(0)
        while len(kept) < n:  # the outer half of the tube has more surface
            angle = rng.uniform(0, 2 * np.pi, 2 * n)
            kept = np.append(kept, angle[rng.uniform(0, ring + tube, 2 * n) < ring + tube * np.cos(angle)])
        v, u = kept[:n], rng.uniform(0, 2 * np.pi, n)
        radius = ring + tube * np.cos(v)
        return np.stack([radius * np.cos(u), radius * np.sin(u), tube * np.sin(v)], axis=1)

    def contains(p: Floats) -> Bools:
        return np.hypot(np.hypot(p[:, 0], p[:, 1]) - ring, p[:, 2]) < tube

    r = ring + tube
    return Shape(sample, contains, (-r, -r, -tube), (r, r, tube), loops=1)


def plate(width: float = 1.0, thickness: float = 0.15) -> Shape:
    """A thin box."""
    size = np.array([width, width, thickness])
    areas = np.repeat([size[1] * size[2], size[0] * size[2], size[0] * size[1]], 2)

    def sample(n: int, rng: np.random.Generator) -> Floats:
        side = shares(n, areas, rng)
        p = rng.uniform(0, size, (n, 3))
        p[np.arange(n), side // 2] = (side % 2) * size[side // 2]
        return rough(p, rng)

    return Shape(sample, lambda p: ((p > 0) & (p < size)).all(axis=1), (0, 0, 0), tuple(size))


def in_rings(p: Floats, rings: list[Floats]) -> Bools:
    """Even-odd rule over closed polygons."""
    inside = np.zeros(len(p), bool)
    for ring in rings:
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            crosses = (a[1] > p[:, 1]) != (b[1] > p[:, 1])
            if a[1] != b[1]:
                inside ^= crosses & (p[:, 0] < a[0] + (p[:, 1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
    return inside


def polygon(rings: list[list[list[float]]], components: int = 1, loops: int = 0) -> Shape:
    """A flat shape bounded by closed polygons, sampled on its outline."""
    arrays = [np.array(ring, dtype=float) for ring in rings]
    starts = np.concatenate(arrays)
    sides = np.concatenate([np.roll(ring, -1, axis=0) - ring for ring in arrays])

    def sample(n: int, rng: np.random.Generator) -> Floats:
        which = shares(n, np.linalg.norm(sides, axis=1), rng)
        return starts[which] + rng.random((n, 1)) * sides[which]

    low, high = starts.min(axis=0), starts.max(axis=0)
    return Shape(sample, lambda p: in_rings(p, arrays), tuple(low), tuple(high), components, loops)


def comb(teeth: int = 5) -> Shape:
    """A bar with teeth; the gaps between them are narrower than they are deep."""
    upper = [[x + dx, y] for x in range(teeth) for dx, y in ((0, 3.0), (0.6, 3.0), (0.6, 1.0), (1.0, 1.0))]
    return polygon([[[0, 0], *upper[:-2], [upper[-3][0], 0]]])


LETTER_A = [
    [[0, 0], [1.2, 4], [1.9, 4], [3.1, 0], [2.4, 0], [2.1, 1], [1, 1], [0.7, 0]],
    [[1.2, 1.6], [1.9, 1.6], [1.55, 2.9]],
]
LETTER_B = [
    [[4, 0], [5.6, 0], [6.2, 0.6], [6.2, 1.6], [5.8, 2.05], [6.2, 2.5], [6.2, 3.4], [5.6, 4], [4, 4]],
    [[4.6, 0.6], [5.4, 0.6], [5.6, 0.9], [5.6, 1.5], [5.4, 1.75], [4.6, 1.75]],
    [[4.6, 2.35], [5.4, 2.35], [5.6, 2.6], [5.6, 3.1], [5.4, 3.4], [4.6, 3.4]],
]


def letters() -> Shape:
    return polygon(LETTER_A + LETTER_B, components=2, loops=3)


def revolved(profile: list[list[float]]) -> Shape:
    """A closed (r, z) polygon, one side of it on the axis, turned around the z axis."""
    ring = np.array(profile, dtype=float)
    ahead = np.roll(ring, -1, axis=0)
    areas = (ring[:, 0] + ahead[:, 0]) * np.linalg.norm(ahead - ring, axis=1)

    def sample(n: int, rng: np.random.Generator) -> Floats:
        side = shares(n, areas, rng)
        r0, r1 = ring[side, 0], ahead[side, 0]
        # the share t of a cone with radius r0 + t (r1 - r0) has area proportional to the integral of the radius
        radius = np.sqrt(r0**2 + rng.random(n) * (r1**2 - r0**2))
        t = np.where(r0 == r1, rng.random(n), (radius - r0) / np.where(r0 == r1, 1, r1 - r0))
        z, turn = ring[side, 1] + t * (ahead - ring)[side, 1], rng.uniform(0, 2 * np.pi, n)
        return rough(np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1), rng)

    def contains(p: Floats) -> Bools:
        return in_rings(np.stack([np.hypot(p[:, 0], p[:, 1]), p[:, 2]], axis=1), [ring])

    r, low, high = ring[:, 0].max(), ring[:, 1].min(), ring[:, 1].max()
    return Shape(sample, contains, (-r, -r, low), (r, r, high))


def bottle() -> Shape:
    """A solid of the form of a bottle: a thin part beside a thick one."""
    return revolved([[0, 0], [1, 0], [1, 2], [0.3, 2.6], [0.3, 3.6], [0, 3.6]])


def vessel() -> Shape:
    """A bottle of glass, open at its neck: its hollow is outside."""
    return revolved([[0, 0], [1, 0], [1, 2], [0.65, 2.4], [0.65, 3], [0.25, 3], [0.25, 2.2], [0.6, 1.8], [0.6, 0.4],
                     [0, 0.4]])  # fmt: skip


SOLIDS = {
    "ball": ball, "torus": torus, "shell": shell, "two_balls": two_balls, "bottle": bottle, "vessel": vessel,
    "plate": plate,
}  # fmt: skip
FLATS = {"comb": comb, "letters": letters}
