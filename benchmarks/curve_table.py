"""Judge the curve skeleton on the meshes of a folder: python benchmarks/curve_table.py FOLDER.

Prints one Markdown row per mesh (OBJ), sampling and detail. The method sees points only; the mesh scores it. Samples
are the vertices, points spread evenly over the surface, and independent random ones with several seeds.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from tetraskel.kernels.curve import curve_model, draw_curve
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.measures import measure
from tetraskel.kernels.surface_rays import surface_of, surface_samples
from tetraskel.kernels.triangulate import triangulate

EVEN = (20_000, 100_000)
INDEPENDENT, SEEDS = 20_000, (0, 1, 2, 3)
DETAILS = (0.5, 1.0)
COLUMNS = ("components", "loops", "ends", "junctions", "inside", "centredness")


def read_obj(path: Path) -> tuple[np.ndarray, np.ndarray]:
    vertices, triangles = [], []
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append([float(x) for x in rest[:3]])
        elif word == "f":
            corners = [int(corner.split("/")[0]) - 1 for corner in rest]
            triangles += [[corners[0], b, c] for b, c in pairwise(corners[1:])]
    return np.array(vertices), np.array(triangles)


def samplings(vertices: np.ndarray, triangles: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """How the points were taken, and the points."""
    yield f"{len(vertices)} vertices", vertices
    for n in EVEN:
        yield f"{n} even", surface_samples(surface_of(vertices, triangles), n)
    for seed in SEEDS:
        yield f"{INDEPENDENT} random, seed {seed}", independent_samples(vertices, triangles, INDEPENDENT, seed)


def independent_samples(vertices: np.ndarray, triangles: np.ndarray, n: int, seed: int) -> np.ndarray:
    """(n, 3) points of the surface, each drawn for itself, uniform by area."""
    rng, corners = np.random.default_rng(seed), vertices[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[rng.choice(len(triangles), n, p=area / area.sum())]
    a, b = rng.random((2, n, 1))
    a, b = np.where(a + b > 1, 1 - a, a), np.where(a + b > 1, 1 - b, b)
    return np.asarray(chosen[:, 0] + a * (chosen[:, 1] - chosen[:, 0]) + b * (chosen[:, 2] - chosen[:, 0]))


def main(folder: str) -> None:
    print("| shape | points | detail |", " | ".join(COLUMNS), "| reconstruction, % | largest, % | short | refused |")
    print("|---" * (len(COLUMNS) + 7) + "|")
    for path in sorted(Path(folder).glob("*.obj")):
        surface = read_obj(path)
        for taken, points in samplings(*surface):
            model = curve_model(triangulate(points))
            for detail in DETAILS:
                print(row(path.stem, taken, detail, draw_curve(model, detail=detail), surface), flush=True)


def row(name: str, taken: str, detail: float, skeleton: Skeleton, surface: tuple[np.ndarray, np.ndarray]) -> str:
    numbers = measure(skeleton, surface)
    cells = [f"{numbers[column]:.4g}" for column in COLUMNS]
    cells += [f"{numbers['reconstruction_mean']:.2f}", f"{numbers['reconstruction_max']:.2f}"]
    cells += [f"{numbers['short_branches']:.3f}", str(skeleton.loops_refused)]
    return " | ".join(["", name, taken, f"{detail:g}", *cells, ""]).strip(" ")


if __name__ == "__main__":
    main(*sys.argv[1:])
