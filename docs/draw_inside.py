"""Draws a cut through two objects given as random points, inside and outside coloured.

Usage: python docs/draw_inside.py docs/pictures/inside_cut.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from shapes import Shape, torus, vessel

from tetraskel import interior, triangulate


def cut(shape: Shape, n: int) -> tuple[pv.PolyData, np.ndarray]:
    mesh = triangulate(shape.sample(n, np.random.default_rng(0)))
    cells = np.c_[np.full(len(mesh), 4), mesh.simplices].ravel()
    grid = pv.UnstructuredGrid(cells, np.full(len(mesh), pv.CellType.TETRA), mesh.points)
    grid.cell_data["inside"] = interior(mesh).astype(np.uint8)
    return grid.slice(normal="y", origin=(0, 1e-3, 0)), mesh.points


def main(out: str) -> None:
    plotter = pv.Plotter(off_screen=True, shape=(1, 2), window_size=(1100, 520), border=False)
    for column, (shape, n) in enumerate([(torus(), 10_000), (vessel(), 10_000)]):
        plotter.subplot(0, column)
        section, points = cut(shape, n)
        behind = points[points[:, 1] > 0] + [0, 5, 0]  # drawn first, behind the cut
        plotter.add_points(behind, color="#44546a", point_size=2)
        plotter.add_mesh(section, scalars="inside", cmap=["#dfe3e8", "#e07b39"], show_scalar_bar=False,
                         lighting=False)  # fmt: skip
        plotter.add_points(points[np.abs(points[:, 1]) < 0.03] - [0, 5, 0], color="#20303f", point_size=4)
        plotter.view_xz()
        plotter.camera.parallel_projection = True
        plotter.camera.parallel_scale = 1.75
    plotter.screenshot(out)


if __name__ == "__main__":
    main(sys.argv[1])
