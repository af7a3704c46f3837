"""Small sets of points that triangulations fail on: many on one sphere, plane or line, almost or exactly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rng = np.random.Generator


def lattice(rng: Rng, dim: int) -> Floats:
    return rng.integers(0, 4, (11, dim)).astype(float)


def decimal_lattice(rng: Rng, dim: int) -> Floats:
    return rng.integers(0, 4, (11, dim)) * 0.1 + 0.7


def centred_lattice(rng: Rng, dim: int) -> Floats:
    """Corners and centres of cubes."""
    return rng.integers(0, 3, (10, dim)) + 0.5 * rng.integers(0, 2, (10, 1))


def one_sphere(rng: Rng, dim: int) -> Floats:
    """Whole points of one sphere, and its centre now and then."""
    axes = np.meshgrid(*[np.arange(-5, 6)] * dim)
    whole = np.stack(axes, -1).reshape(-1, dim)
    on = whole[(whole**2).sum(axis=1) == (25 if dim == 2 else 26)]
    chosen = rng.permutation(on)[:10]
    return np.concatenate([chosen, np.zeros((rng.integers(0, 2), dim))]).astype(float)


def plane_and_apex(rng: Rng, dim: int) -> Floats:
    """All but one in a plane (on a line) that is tilted or not."""
    flat = rng.integers(0, 4, (11, dim)).astype(float)
    flat[:, -1] = flat[:, 0] * rng.integers(0, 3) + (flat[:, 1] if dim == 3 else 0)
    return np.concatenate([flat, rng.integers(4, 7, (1, dim)) * [*[1] * (dim - 1), 3]])


def line_and_others(rng: Rng, dim: int) -> Floats:
    """All but two on one line."""
    line = rng.integers(-6, 7, (9, 1)) * rng.integers(1, 4, (1, dim))
    return np.concatenate([line, rng.integers(-3, 4, (2, dim)) * 5 + np.arange(dim) * 7]).astype(float)


def needles(rng: Rng, dim: int) -> Floats:
    return rng.random((10, dim)) * [1e-7, *[1.0] * (dim - 1)]


def slab(rng: Rng, dim: int) -> Floats:
    points = rng.integers(0, 4, (10, dim)).astype(float)
    points[:, -1] = 1e-9 * rng.integers(0, 3, 10)
    return points


def far_away(rng: Rng, dim: int) -> Floats:
    return 1e6 + rng.integers(0, 3, (10, dim)) * 0.1


def tiny(rng: Rng, dim: int) -> Floats:
    return rng.integers(0, 4, (10, dim)) * 1e-60


def huge(rng: Rng, dim: int) -> Floats:
    return rng.integers(0, 4, (10, dim)) * 1e60


def mixed_sizes(rng: Rng, dim: int) -> Floats:
    return rng.integers(-2, 3, (10, dim)) * 10.0 ** rng.integers(-60, 1, (10, 1))


def turned_lattice(rng: Rng, dim: int) -> Floats:
    return rng.integers(-2, 3, (11, dim)) @ np.linalg.qr(rng.normal(size=(dim, dim)))[0]


def generic(rng: Rng, dim: int) -> Floats:
    return rng.random((10, dim))


def almost_lattice(rng: Rng, dim: int) -> Floats:
    """A lattice with coordinates off by a unit of the last place."""
    points = rng.integers(1, 4, (11, dim)) * 0.1
    return points + rng.integers(-1, 2, points.shape) * np.spacing(points)


FAMILIES: dict[str, Callable[[Rng, int], Floats]] = {
    family.__name__: family
    for family in (
        lattice, decimal_lattice, centred_lattice, one_sphere, plane_and_apex, line_and_others, needles, slab, far_away,
        tiny, huge, mixed_sizes, turned_lattice, generic, almost_lattice,
    )
}  # fmt: skip
