"""Judge the curve skeleton on the meshes of a folder: python benchmarks/curve_table.py FOLDER.

Prints one Markdown row per mesh (OBJ), sampling and detail. The method sees points only; the mesh scores it.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

from tetraskel.kernels.curve import curve_model, draw_curve
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.measures import measure
from tetraskel.kernels.surface_rays import surface_of, surface_samples
from tetraskel.kernels.triangulate import triangulate

SAMPLINGS = (0, 20_000, 100_000)  # 0: the vertices of the mesh
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


def main(folder: str) -> None:
    print("| shape | points | detail |", " | ".join(COLUMNS), "| reconstruction, % | largest, % | short | refused |")
    print("|---" * (len(COLUMNS) + 7) + "|")
    for path in sorted(Path(folder).glob("*.obj")):
        vertices, triangles = read_obj(path)
        for n in SAMPLINGS:
            model = curve_model(triangulate(surface_samples(surface_of(vertices, triangles), n) if n else vertices))
            for detail in DETAILS:
                skeleton = draw_curve(model, detail=detail)
                print(row(path.stem, n or len(vertices), detail, skeleton, (vertices, triangles)), flush=True)


def row(name: str, n: int, detail: float, skeleton: Skeleton, surface: tuple[np.ndarray, np.ndarray]) -> str:
    numbers = measure(skeleton, surface)
    cells = [f"{numbers[column]:.4g}" for column in COLUMNS]
    cells += [f"{numbers['reconstruction_mean']:.2f}", f"{numbers['reconstruction_max']:.2f}"]
    cells += [f"{numbers['short_branches']:.3f}", str(skeleton.loops_refused)]
    return " | ".join(["", name, str(n), f"{detail:g}", *cells, ""]).strip(" ")


if __name__ == "__main__":
    main(*sys.argv[1:])
