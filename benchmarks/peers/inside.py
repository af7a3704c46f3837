"""Which part of space is inside: our gates from the points alone, beside vtkDelaunay3D with alpha."""

from __future__ import annotations

import warnings
from collections.abc import Iterator

import numpy as np
import pyvista
from scipy.spatial import cKDTree

from tetraskel import InsideWarning, interior, triangulate
from tetraskel.kernels.winding import winding_numbers

PROBES = 20_000
LARGEST = 16_000
ALPHAS = (2.0, 4.0, 8.0)  # mean distances to the nearest point


def inside_rows(thing, sizes: list[int], *, head: bool) -> Iterator[str]:
    """A table row for each size."""
    if head:
        alphas = [f"alpha {alpha:g}" for alpha in ALPHAS]
        yield "| object | points | tetraskel gates | " + " | ".join(alphas) + " |\n" + "|---" * (3 + len(ALPHAS)) + "|"
    for size in [size for size in sizes if size <= LARGEST]:
        points, triangles = thing.resampled(size)
        probes = np.random.default_rng(0).uniform(points.min(axis=0), points.max(axis=0), (PROBES, 3))
        truth = winding_numbers(probes, points, triangles) > 0.5
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InsideWarning)
            mesh = triangulate(points)
            inner = interior(mesh)
        cells = np.column_stack([np.full(inner.sum(), 4), mesh.simplices[inner]]).ravel()
        found = [pyvista.UnstructuredGrid(cells, np.full(inner.sum(), 10, np.uint8), mesh.points)]
        spacing = float(cKDTree(points).query(points, 2)[0][:, 1].mean())
        cloud = pyvista.PolyData(points)
        for alpha in ALPHAS:
            found.append(solids(cloud.delaunay_3d(alpha=alpha * spacing)))
        numbers = [f"{overlap(grid, probes, truth):.3f}" for grid in found]
        yield f"| {thing.name} | {size} | " + " | ".join(numbers) + " |"


def overlap(grid, probes: np.ndarray, truth: np.ndarray) -> float:
    """Intersection over union of a grid's cells and the truth, at the probes."""
    held = np.asarray(grid.find_containing_cell(probes)) >= 0 if grid.n_cells else np.zeros(len(probes), bool)
    return float((held & truth).sum() / max((held | truth).sum(), 1))


def solids(grid):
    """The tetrahedra of a grid, without the triangles and lines that alpha leaves beside them."""
    return grid.extract_cells(grid.celltypes == pyvista.CellType.TETRA)
