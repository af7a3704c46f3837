"""Clouds that break programs, and hypothesis strategies that draw them.

A cloud is a family (where the points lie), spoilers (what happened to them since) and a layout (how the array holds
them). The same numbers always give the same cloud, so what fails can be made again from its repr.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from adversarial import FAMILIES as SMALL
from shapes import FLATS, SOLIDS

Floats = NDArray[np.float64]
Rng = np.random.Generator


def uniform(rng: Rng, n: int, dim: int) -> Floats:
    return rng.random((n, dim))


def clusters(rng: Rng, n: int, dim: int) -> Floats:
    return rng.random((3, dim))[rng.integers(0, 3, n)] + 1e-6 * rng.normal(size=(n, dim))


def grid(rng: Rng, n: int, dim: int) -> Floats:
    side = max(round(n ** (1 / dim)), 2)
    return np.stack(np.meshgrid(*[np.arange(side)] * dim), -1).reshape(-1, dim) * float(rng.choice([1.0, 0.1, 1 / 3]))


def hollow_box(rng: Rng, n: int, dim: int) -> Floats:
    """A lattice on the sides of a box: the surface that every program is given first."""
    side = max(round((n / (2 * dim)) ** (1 / (dim - 1))), 3)
    whole = np.stack(np.meshgrid(*[np.arange(side)] * dim), -1).reshape(-1, dim)
    return whole[((whole == 0) | (whole == side - 1)).any(axis=1)].astype(float)


def sphere(rng: Rng, n: int, dim: int) -> Floats:
    ways = rng.normal(size=(min(n, 150), dim))
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


def line_of_points(rng: Rng, n: int, dim: int) -> Floats:
    return rng.random((n, 1)) * rng.normal(size=dim) + rng.normal(size=dim)


def sheet(rng: Rng, n: int, dim: int) -> Floats:
    """In a plane (on a line) that is tilted, with one point beside it or none."""
    flat = rng.random((n, dim))
    flat[:, -1] = flat[:, :-1] @ rng.normal(size=dim - 1)
    flat[0, -1] += rng.choice([0, 1e-15, 1e-9, 1.0])
    return flat


def two_sheets(rng: Rng, n: int, dim: int) -> Floats:
    points = rng.random((n, dim))
    points[:, -1] = rng.integers(0, 2, n) * rng.choice([1e-9, 1e-3, 0.2])
    return points


def polyline(rng: Rng, n: int, dim: int) -> Floats:
    corners = rng.random((4, dim))
    k, t = rng.integers(0, 3, n), rng.random((n, 1))
    return (1 - t) * corners[k] + t * corners[k + 1]


def solid(rng: Rng, n: int, dim: int) -> Floats:
    """Random points of the surface of an object with an inside."""
    made = SOLIDS if dim == 3 else FLATS
    return made[rng.choice(sorted(made))]().sample(max(4 * n, 60), rng)


def prism(rng: Rng, n: int, dim: int) -> Floats:
    """Rings of few points, one above the other: many on one circle, four in each side."""
    around = int(rng.integers(3, 9))
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if dim == 2:
        return np.concatenate([ring, 0.5 * ring])
    heights = np.arange(max(n // around, 2)) * 0.4
    return np.concatenate([np.column_stack([ring, np.full(around, z)]) for z in heights])


def small(rng: Rng, n: int, dim: int) -> Floats:
    return SMALL[rng.choice(sorted(SMALL))](rng, dim)


def few(rng: Rng, n: int, dim: int) -> Floats:
    return rng.integers(0, 3, (int(rng.integers(0, 6)), dim)).astype(float)


FAMILIES: dict[str, Callable[[Rng, int, int], Floats]] = {
    made.__name__: made
    for made in (
        uniform, clusters, grid, hollow_box, sphere, line_of_points, sheet, two_sheets, polyline, solid, prism, small,
        few,
    )
}  # fmt: skip


def duplicates(points: Floats, rng: Rng) -> Floats:
    return np.concatenate([points, points[rng.integers(0, len(points), len(points) // 2 + 1)]])


def ulp_duplicates(points: Floats, rng: Rng) -> Floats:
    again = points[rng.integers(0, len(points), len(points) // 2 + 1)]
    return np.concatenate([points, again + rng.integers(-1, 2, again.shape) * np.spacing(again)])


def outlier(points: Floats, rng: Rng) -> Floats:
    return np.concatenate([points, points[:1] + rng.choice([1e2, 1e6, 1e12, 1e30])])


def tiny(points: Floats, rng: Rng) -> Floats:
    return points * rng.choice([1e-9, 1e-30, 1e-90, 1e-160, 1e-300])


def huge(points: Floats, rng: Rng) -> Floats:
    return points * rng.choice([1e6, 1e20, 1e60, 1e95])


def far_away(points: Floats, rng: Rng) -> Floats:
    return points + rng.choice([1e3, 1e7, 1e12])


def squeezed(points: Floats, rng: Rng) -> Floats:
    scale = np.ones(points.shape[1])
    scale[rng.integers(points.shape[1])] = rng.choice([1e-3, 1e-8, 1e-14])
    return points * scale


def mixed_scales(points: Floats, rng: Rng) -> Floats:
    return np.concatenate([points, points * rng.choice([1e-6, 1e-12])])


def noisy(points: Floats, rng: Rng) -> Floats:
    return points + rng.normal(size=points.shape) * rng.choice([1e-16, 1e-9, 1e-3]) * (np.ptp(points, axis=0).max() + 1)


def turned(points: Floats, rng: Rng) -> Floats:
    dim = points.shape[1]
    return points @ np.linalg.qr(rng.normal(size=(dim, dim)))[0]


def tilted_plane(points: Floats, rng: Rng) -> Floats:
    """Of the plane into a tilted plane of space."""
    if points.shape[1] == 3:
        return points
    return points @ np.linalg.qr(rng.normal(size=(3, 3)))[0][:2] + rng.normal(size=3)


def few_left(points: Floats, rng: Rng) -> Floats:
    return points[: int(rng.integers(1, 8))]


def not_finite(points: Floats, rng: Rng) -> Floats:
    points = points.copy()
    points[rng.integers(len(points)), rng.integers(points.shape[1])] = rng.choice([np.nan, np.inf, -np.inf, 1e200])
    return points


SPOILERS: dict[str, Callable[[Floats, Rng], Floats]] = {
    made.__name__: made
    for made in (
        duplicates, ulp_duplicates, outlier, tiny, huge, far_away, squeezed, mixed_scales, noisy, turned, tilted_plane,
        few_left, not_finite,
    )
}  # fmt: skip


def strided(points: Floats) -> Floats:
    return np.repeat(points, 2, axis=0)[::2]


def as_type(kind: str) -> Callable[[Floats], NDArray]:
    def convert(points: Floats) -> NDArray:
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            whole = np.dtype(kind).kind in "iub"
            return (np.nan_to_num(points) * 10 % 100 if whole else points).astype(kind)

    return convert


def read_only(points: Floats) -> Floats:
    points = points.copy()
    points.setflags(write=False)
    return points


LAYOUTS: dict[str, Callable[[Floats], NDArray]] = {
    "as it is": lambda points: points,
    "fortran": np.asfortranarray,
    "strided": strided,
    "reversed": lambda points: points[::-1],
    "read only": read_only,
    **{kind: as_type(kind) for kind in ("float32", ">f8", ">f4", "float16", "int8", "uint16", ">i4", "int64", "bool")},
}


@dataclass(frozen=True)
class Nasty:
    """What a cloud is made from; its repr makes it again."""

    family: str
    dim: int
    n: int
    seed: int
    spoilers: tuple[str, ...] = ()
    layout: str = "as it is"

    @np.errstate(all="ignore")  # what is spoilt twice may be infinite
    def array(self) -> NDArray:
        rng = np.random.default_rng(self.seed)
        points = FAMILIES[self.family](rng, self.n, self.dim)
        for name in self.spoilers:
            points = SPOILERS[name](points, rng) if len(points) else points
        return LAYOUTS[self.layout](points)


def of_random(rng: Rng, largest: int = 60) -> Nasty:
    """A cloud drawn without hypothesis, for long runs that collect failures."""
    spoilers = tuple(str(name) for name in rng.choice(sorted(SPOILERS), int(rng.integers(0, 3))))
    layout = str(rng.choice(sorted(LAYOUTS))) if rng.random() < 0.4 else "as it is"
    family, dim = str(rng.choice(sorted(FAMILIES))), int(rng.integers(2, 4))
    return Nasty(family, dim, int(rng.integers(5, largest)), int(rng.integers(1 << 30)), spoilers, layout)


def clouds(largest: int = 60) -> st.SearchStrategy[Nasty]:
    return st.builds(
        Nasty,
        family=st.sampled_from(sorted(FAMILIES)),
        dim=st.sampled_from([2, 3]),
        n=st.integers(5, largest),
        seed=st.integers(0, 1 << 30),
        spoilers=st.lists(st.sampled_from(sorted(SPOILERS)), max_size=2).map(tuple),
        layout=st.sampled_from(["as it is", *sorted(LAYOUTS)]),
    )
