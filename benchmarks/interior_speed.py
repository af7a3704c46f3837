"""Time of the gate classification as a share of SciPy's Delaunay time, both taken in this process.

Usage: python benchmarks/interior_speed.py [POINTS ...]     (default 100000)
"""

from __future__ import annotations

import sys
import time
import warnings

import numpy as np
from scipy.spatial import Delaunay

from tetraskel import InsideWarning, Triangulation, interior


def clouds(n: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    directions = rng.normal(size=(n, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return {"sphere-like": directions * rng.normal(1, 0.01, (n, 1)), "volume-like": rng.random((n, 3))}


def main(sizes: list[int]) -> None:
    warnings.simplefilter("ignore", InsideWarning)
    print("| cloud | points | tetrahedra | Delaunay, s | gates, s | share |\n|---|---|---|---|---|---|")
    for n in sizes:
        for name, points in clouds(n, np.random.default_rng(0)).items():
            start = time.perf_counter()
            found = Delaunay(points)
            between = time.perf_counter()
            interior(Triangulation(points, found.simplices, found.neighbors))
            delaunay, gates = between - start, time.perf_counter() - between
            print(f"| {name} | {n} | {len(found.simplices)} | {delaunay:.2f} | {gates:.2f} | {gates / delaunay:.0%} |")


if __name__ == "__main__":
    main([int(given) for given in sys.argv[1:]] or [100_000])
