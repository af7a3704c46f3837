"""Points to skeleton, end to end, with seconds and memory after each stage: python benchmarks/large.py [POINTS] [tree]

Random points of a torus whose tube is now thick, now thin (5,000,000 without an argument); `tree` stops after
triangulation and tree. Not of an exact torus: all points of a cross-section are as far from its middle, and of such
points there are twice as many tetrahedra.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

from run import cloud

from tetraskel import build_tree, curve_model, draw_curve, remove_flat, triangulate


def peak() -> float:
    """Largest resident memory so far, in GB."""
    return int(Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0]) / 2**20


def told(name: str, stage: Callable):
    start = time.perf_counter()
    result = stage()
    print(f"{name}: {time.perf_counter() - start:.1f} s, peak {peak():.2f} GB, {len(result):,} parts", flush=True)
    return result


def main(n: int, tree_only: bool) -> None:
    triangulate(cloud("surface", 100))  # compiled before it is timed
    points = told("points", lambda: cloud("surface", n))
    mesh = told("triangulation", lambda: triangulate(points))
    if tree_only:
        tree = told("tree", lambda: build_tree(mesh))
        told("without flat ones", lambda: remove_flat(tree))
        return
    start = time.perf_counter()
    model = curve_model(mesh)
    print(f"inside, nodes, loops, branches: {time.perf_counter() - start:.1f} s, peak {peak():.2f} GB", flush=True)
    skeleton = told("skeleton", lambda: draw_curve(model))
    print(f"{skeleton.components} pieces, {skeleton.loops} loops")


if __name__ == "__main__":
    numbers = [word for word in sys.argv[1:] if word != "tree"]
    main(int(numbers[0]) if numbers else 5_000_000, "tree" in sys.argv)
