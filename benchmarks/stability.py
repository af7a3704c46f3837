"""How far the skeleton moves when the same object comes in another way: python benchmarks/stability.py

Prints a Markdown table for docs/curve.md: Hausdorff distances to the skeleton of the first cloud, in percent of the
diagonal, with the number of ends where it is not the true one.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from tetraskel import curve_skeleton
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.measures import samples_along

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from tubes import TUBES, Tube

N = 5000
OBJECTS = ("capsule", "bent tube", "y", "torus", "double torus", "helix", "tree")
TURN = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]


def ways(tube: Tube) -> dict[str, Skeleton]:
    """The skeleton of the object in each other way, back in its first place."""
    cloud = tube.sample(N, 0)
    turned = curve_skeleton(cloud @ TURN)
    moved = curve_skeleton(1e-3 * cloud + 4.0)
    return {
        "permuted": curve_skeleton(cloud[np.random.default_rng(2).permutation(N)]),
        "turned": replace(turned, points=turned.points @ TURN.T),
        "scaled, moved": replace(moved, points=(moved.points - 4.0) * 1e3),
        "sampled again": curve_skeleton(tube.sample(N, 5)),
        "half of the points": curve_skeleton(cloud[::2]),
        "noise 0.2 %": curve_skeleton(tube.sample(N, 0, 0.002)),
        "noise 0.5 %": curve_skeleton(tube.sample(N, 0, 0.005)),
    }


def cell(found: Skeleton, first: Skeleton, tube: Tube, diagonal: float) -> str:
    a, b = (samples_along(one, 3000)[0] for one in (found, first))
    farthest = max(cKDTree(a).query(b)[0].max(), cKDTree(b).query(a)[0].max())
    ends = int((found.node_degree == 1).sum())
    wrong = (found.components, found.loops, ends) != (1, tube.loops, tube.ends)
    return f"{100 * farthest / diagonal:.2g}" + (f" ({found.loops} loops, {ends} ends)" if wrong else "")


def main() -> None:
    for number, name in enumerate(OBJECTS):
        tube = TUBES[name]()
        first = curve_skeleton(tube.sample(N, 0))
        diagonal = float(np.linalg.norm(np.ptp(tube.sample(N, 0), axis=0)))
        found = ways(tube)
        if number == 0:
            print("| object |", " | ".join(found), "|\n" + "|---" * (len(found) + 1) + "|")
        print("|", " | ".join([name, *(cell(one, first, tube, diagonal) for one in found.values())]), "|", flush=True)


if __name__ == "__main__":
    main()
