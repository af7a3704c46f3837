"""The tree beside SciPy's Delaunay, in one run: `python benchmarks/tree_speed.py [POINTS ...]`.

Prints for each cloud size the seconds of SciPy's triangulation and of `build_tree` with everything around it
(orientation, order of the sons, root, ranks, sizes), their ratio, and the tetrahedra per second; medians of several
runs. Peak memory is the process's own: the triangulation alone, and with the tree.
"""

from __future__ import annotations

import resource
import sys
import time

import numpy as np
from scipy.spatial import Delaunay

from tetraskel import Triangulation, build_tree

REPEATS = 5


def seconds(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def peak_megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def row(n):
    points = np.random.default_rng(0).random((n, 3))
    qhull, found = seconds(lambda: Delaunay(points))
    before = peak_megabytes()
    mesh = Triangulation(points, found.simplices, found.neighbors)
    tree = float(np.median([seconds(lambda: build_tree(mesh))[0] for _ in range(REPEATS)]))
    after = peak_megabytes()
    return (
        f"| {n:,} | {len(mesh):,} | {qhull:.2f} | {tree:.3f} | {100 * tree / qhull:.1f} % "
        f"| {len(mesh) / tree / 1e6:.1f} | {before:,.0f} | {after:,.0f} |"
    )


def main(sizes):
    print("| points | tetrahedra | SciPy Delaunay, s | build_tree, s | ratio | tetrahedra, M/s | peak MB | with tree |")
    print("|---|---|---|---|---|---|---|---|")
    for n in sizes:
        print(row(n), flush=True)


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]] or [10**5, 10**6])
