"""Time of the curve skeleton against SciPy's Delaunay on surface samples: python benchmarks/curve_speed.py [N ...].

The own part is everything after the triangulation. Ratios come from one run on one machine; the exponent is the
slope of log time over log points.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.spatial import Delaunay

from tetraskel.kernels.curve import curve_model, draw_curve
from tetraskel.kernels.triangulate import triangulate


def torus(n: int) -> np.ndarray:
    """Random points of a bumpy torus: no two simplices of it share a centre."""
    rng = np.random.default_rng(0)
    u, v = rng.uniform(0, 2 * np.pi, (2, n))
    small = 0.6 + 0.1 * np.sin(3 * u) + 0.05 * np.cos(2 * v)
    ring = 2 + small * np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], axis=1)


def main(sizes: list[int]) -> None:
    curve_model(triangulate(torus(2000)))  # compile
    own = []
    print("| points | Qhull, s | own part, s | ratio | another detail, s |\n|---|---|---|---|---|")
    for n in sizes:
        points = torus(n)
        start = time.perf_counter()
        Delaunay(points)
        qhull = time.perf_counter() - start
        mesh = triangulate(points)
        start = time.perf_counter()
        model = curve_model(mesh)
        draw_curve(model)
        own.append(time.perf_counter() - start)
        start = time.perf_counter()
        draw_curve(model, detail=0.8)
        again = time.perf_counter() - start
        print(f"| {n} | {qhull:.2f} | {own[-1]:.2f} | {own[-1] / qhull:.2f} | {again:.2f} |", flush=True)
    if len(sizes) > 1:
        print(f"\nexponent of the own part: {np.polyfit(np.log(sizes), np.log(own), 1)[0]:.2f}")


if __name__ == "__main__":
    main([int(n) for n in sys.argv[1:]] or [10_000, 100_000, 1_000_000])
