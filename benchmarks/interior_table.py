"""Inside by gates against closed meshes: overlap and topology, beside a global alpha threshold at its best alpha.

Usage: python benchmarks/interior_table.py FOLDER [MESH.obj ...]
The method sees points only: the meshes' vertices, or random points of their surface, with noise in per cent of the
diagonal. Overlap is volume of intersection over union, from random points of the bounding box.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import numpy as np
import pyvista as pv
from scipy.spatial import Delaunay

from tetraskel import InsideWarning, Triangulation, interior
from tetraskel.kernels.winding import winding_numbers

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from checks import count_pieces, euler_characteristic

PROBES = 40_000
CASES = [("vertices", 0, 0.0), *((f"{n} points", n, 0.0) for n in (3_000, 10_000, 40_000)),
         *((f"40000 points, noise {noise} %", 40_000, noise) for noise in (0.25, 0.5, 1.0))]  # fmt: skip


def samples(points: np.ndarray, faces: np.ndarray, n: int, rng: np.random.Generator) -> np.ndarray:
    a, b, c = points[faces].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    face = rng.choice(len(faces), n, p=area / area.sum())
    weights = rng.dirichlet(np.ones(3), n)
    return np.einsum("kv,kva->ka", weights, points[faces[face]])


def circumradii(points: np.ndarray, simplices: np.ndarray) -> np.ndarray:
    sides = points[simplices[:, 1:]] - points[simplices[:, :1]]
    squares = (sides**2).sum(axis=2)
    volume = np.linalg.det(sides)
    normals = np.stack([np.cross(sides[:, (i + 1) % 3], sides[:, (i + 2) % 3]) for i in range(3)], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.linalg.norm(np.einsum("ki,kia->ka", squares, normals), axis=1) / np.abs(2 * volume)


def overlap(guess: np.ndarray, truth: np.ndarray) -> float:
    return float((guess & truth).sum() / (guess | truth).sum())


def main(folder: Path, names: list[str]) -> None:
    warnings.simplefilter("ignore", InsideWarning)
    print("| mesh | points | overlap | pieces | loops | true loops | best alpha |\n|---|---|---|---|---|---|---|")
    for name in names:
        mesh = pv.read(folder / name).triangulate().clean()
        corners, faces = np.asarray(mesh.points, float), mesh.regular_faces
        low, high = corners.min(axis=0), corners.max(axis=0)
        rng = np.random.default_rng(1)
        probes = rng.uniform(low, high, (PROBES, 3))
        truth = winding_numbers(probes, corners, faces) > 0.5
        loops = 1 - (len(corners) - len(faces) // 2) // 2
        for label, n, noise in CASES:
            points = samples(corners, faces, n, rng) if n else corners
            points = points + rng.normal(0, noise / 100 * np.linalg.norm(high - low), points.shape)
            report(f"| {name} | {label}", points, probes, truth, loops)


def report(label: str, points: np.ndarray, probes: np.ndarray, truth: np.ndarray, loops: int) -> None:
    found = Delaunay(points)
    inside = interior(Triangulation(points, found.simplices, found.neighbors))
    where = found.find_simplex(probes)
    radii, placed = circumradii(points, found.simplices), where >= 0
    scale = np.linalg.norm(np.ptp(points, axis=0))
    best = max(overlap(placed & (radii[where] < alpha), truth) for alpha in scale * np.geomspace(0.002, 0.5, 40))
    pieces = count_pieces(found.neighbors, inside)
    cavities = count_pieces(found.neighbors, ~inside, outside_too=True) - 1
    n_loops = pieces + cavities - euler_characteristic(found.simplices[inside]) if inside.any() else 0
    print(f"{label} | {overlap(placed & inside[where], truth):.4f} | {pieces} | {n_loops} | {loops} | {best:.3f} |",
          flush=True)  # fmt: skip


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:] or sorted(path.name for path in Path(sys.argv[1]).glob("*.obj")))
