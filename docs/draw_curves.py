"""Draws curve skeletons inside the meshes whose surfaces the points are taken from.

Usage: python docs/draw_curves.py FOLDER docs/pictures, with homer.obj, spot.obj and rocker-arm.obj in FOLDER.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pyvista as pv

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "benchmarks"))
from curve_table import read_obj

import tetraskel.pyvista_accessor  # noqa: F401  (gives meshes .tetraskel, where tetraskel is not installed)
from tetraskel.kernels.surface_rays import surface_of, surface_samples

RADIUS = "MaximumInscribedSphereRadius"
N_POINTS = 20_000
MANY, FEW = 500_000, 5000  # before and after thinning
VIEWS = {  # from where, how near, and how many pixels
    "homer": ((0.45, 0.15, 1), 1.5, (560, 760)),
    "spot": ((-1, 0.35, -0.55), 1.5, (700, 600)),
    "rocker-arm": ((1, 0.35, 0.3), 1.85, (800, 470)),
}


def picture(mesh: Path, out: Path) -> None:
    """The skeleton of random points of a mesh, as tubes in its surface, thick where the object is."""
    points, triangles = read_obj(mesh)
    surface = pv.PolyData.from_regular_faces(points, triangles)
    source = pv.PolyData(surface_samples(surface_of(points, triangles), N_POINTS))
    skeleton = source.tetraskel.skeleton()
    thin = 0.006 * surface.length
    way, near, size = VIEWS[mesh.stem]
    plotter = pv.Plotter(off_screen=True, window_size=size)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(surface, color="#9fb3c8", opacity=0.22, smooth_shading=True, specular=0.3)
    plotter.add_mesh(skeleton.tube(radius=thin), scalars=RADIUS, cmap="viridis", show_scalar_bar=False)
    marked = skeleton.extract_points(np.isin(skeleton["NodeType"], (0, 2)), include_cells=False)
    balls = marked.glyph(geom=pv.Sphere(radius=1.7 * thin), scale=False, orient=False)
    plotter.add_mesh(balls, color="#30404f")
    plotter.view_vector(way, viewup=(0, 1, 0))
    plotter.camera.zoom(near)
    plotter.screenshot(out)
    plotter.close()


def thinned_picture(mesh: Path, out: Path) -> None:
    """What is left of very many points, coloured by their spacing, and the skeleton of it."""
    points, triangles = read_obj(mesh)
    surface = pv.PolyData.from_regular_faces(points, triangles)
    source = pv.PolyData(surface_samples(surface_of(points, triangles), MANY))
    kept = source.tetraskel.thin(most_points=FEW)
    skeleton = kept.tetraskel.skeleton()
    way, near, (width, height) = VIEWS[mesh.stem]
    plotter = pv.Plotter(off_screen=True, window_size=(8 * width // 7, 4 * height // 7), shape=(1, 2), border=False)
    plotter.set_background("white")
    dots = kept.glyph(geom=pv.Sphere(radius=0.0022 * surface.length), scale=False, orient=False)
    plotter.add_mesh(dots, scalars="Spacing", cmap="viridis_r", show_scalar_bar=False)
    plotter.subplot(0, 1)
    plotter.add_mesh(surface, color="#9fb3c8", opacity=0.22, smooth_shading=True, specular=0.3)
    tubes = skeleton.tube(radius=0.006 * surface.length)
    plotter.add_mesh(tubes, scalars=RADIUS, cmap="viridis", show_scalar_bar=False)
    plotter.enable_anti_aliasing("ssaa")
    for column in range(2):
        plotter.subplot(0, column)
        plotter.view_vector(way, viewup=(0, 1, 0))
        plotter.camera.zoom(0.93 * near)
    plotter.screenshot(out)
    plotter.close()


def main(folder: str, out: str) -> None:
    """One picture for each mesh, and that of thinning."""
    for name in VIEWS:
        picture(Path(folder) / f"{name}.obj", Path(out) / f"curve-{name}.png")
    thinned_picture(Path(folder) / "spot.obj", Path(out) / "thinned.png")


if __name__ == "__main__":
    main(*sys.argv[1:])
