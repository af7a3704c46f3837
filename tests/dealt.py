"""Clouds for many ranks and for blocks, and how their points are dealt."""

from __future__ import annotations

import numpy as np


def uniform(rng, n):
    """Points that fill a cube."""
    return rng.random((n, 3))


def clustered(rng, n):
    """Five clusters, far from each other."""
    return rng.random((5, 3))[rng.integers(0, 5, n)] + rng.normal(size=(n, 3)) * 0.02


def lattice(rng, n):
    """At most n points of a lattice, in any order: every cube is cospherical."""
    return rng.permutation(np.stack(np.meshgrid(*[np.arange(float(int(n ** (1 / 3) + 1e-9)))] * 3), -1).reshape(-1, 3))


def turned_lattice(rng, n):
    """The same turned: nearly cospherical, and flat cells."""
    return lattice(rng, n) @ np.linalg.qr(rng.normal(size=(3, 3)))[0]


def sphere(rng, n):
    """Points of a sphere, all nearly cospherical."""
    ways = rng.normal(size=(n, 3))
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


def cylinder(rng, n):
    """Points of a cylinder's side."""
    turn, height = 2 * np.pi * rng.random(n), 4 * rng.random(n)
    return np.stack([np.cos(turn), np.sin(turn), height], axis=1)


def torus(rng, n):
    """Like a scan: a curved surface, rounded to single precision."""
    u, v = 2 * np.pi * rng.random((2, n))
    wide = 2 + 0.7 * np.cos(u)
    points = np.stack([wide * np.cos(v), wide * np.sin(v), 0.7 * np.sin(u)], axis=1)
    return points.astype(np.float32).astype(float)


def box_shell(rng, n):
    """The surface of a box on a lattice: all gates have one of two widths."""
    side = round((n / 6) ** 0.5)
    grid = np.stack(np.meshgrid(*[np.arange(side + 1.0)] * 3), -1).reshape(-1, 3)
    return rng.permutation(grid[((grid == 0) | (grid == side)).any(axis=1)])


def noisy(rng, n):
    """A torus with scatter."""
    return torus(rng, n) + rng.normal(0, 0.03, (n, 3))


CLOUDS = (uniform, clustered, lattice, turned_lattice, sphere, cylinder, torus)


def dealt(points, size, by, rng):
    """Rank of each point: at random, or by its place along x."""
    if by == "random":
        return rng.integers(0, size, len(points))
    return np.argsort(np.argsort(points[:, 0], kind="stable")) * size // len(points)
