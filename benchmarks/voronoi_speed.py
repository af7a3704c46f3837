"""Voronoi skeletons beside SciPy's Delaunay, in one run: `python benchmarks/voronoi_speed.py [N [CLOUD ...]]`."""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.spatial import Delaunay

from tetraskel import interior, triangulate, voronoi_skeleton

METHODS = ("sk1", "sk2", "sk3", "sk4")


def seconds(work, repeats=3):
    """Processor time of all threads and time that passed, each the best of some runs."""
    best = np.full(2, np.inf)
    for _ in range(repeats):
        start = np.array([time.process_time(), time.perf_counter()])
        work()
        best = np.minimum(best, np.array([time.process_time(), time.perf_counter()]) - start)
    return best


def clouds(n):
    """Points that fill a square and a cube, and points on a curve and on a surface."""
    rng = np.random.default_rng(0)
    yield "square", rng.random((n, 2)), False
    around = rng.random(n) * 2 * np.pi
    reach = 1 + 0.3 * np.cos(5 * around)
    yield "flower", np.stack([reach * np.cos(around), reach * np.sin(around)], axis=1), True
    yield "cube", rng.random((n, 3)), False
    u, v = rng.random((2, n)) * 2 * np.pi
    ring = 1 + 0.4 * np.cos(v)
    torus = np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], axis=1)
    yield "torus", torus + rng.normal(0, 1e-4, torus.shape), True


def main(n=100_000, *wanted):
    """Print the ratios, of all clouds or of those named."""
    print("shares of Delaunay: of its processor time, and of the time that passes")
    print(f"{'':8} {'Delaunay':>10} " + " ".join(f"{name:>11}" for name in METHODS))
    for name, points, hollow in clouds(n):
        if wanted and name not in wanted:
            continue
        mesh = triangulate(points)
        inside = interior(mesh) if hollow else np.ones(len(mesh), bool)
        alone = seconds(lambda points=points: Delaunay(points))
        ratios = []
        for method in METHODS:
            work = lambda mesh=mesh, inside=inside, method=method: voronoi_skeleton(mesh, inside=inside, method=method)  # noqa: E731
            ratios.append(seconds(work, 2) / alone)
        told = [f"{ratio[0]:5.2f} {ratio[1]:5.2f}" for ratio in ratios]
        print(f"{name:8} {alone[0]:10.2f} " + " ".join(told), flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])
