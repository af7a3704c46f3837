"""Draws the way back: smooth curves through a skeleton and the surface around them, and a region of the plane.

Usage: python docs/draw_surface.py [FOLDER], by default docs/pictures.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyvista as pv

from tetraskel.vtkfilters import BezierSkeleton, CurveSkeleton, SkeletonSurface

HERE = Path(__file__).resolve().parent
SAMPLES = HERE.parent / "sample_data"
INK, PAPER, SKIN = "#30404f", "white", "#e8c39e"
BRANCHES = {"scalars": "BranchId", "cmap": "tab20", "show_scalar_bar": False}


def run(source, *filters):
    """The output of filters chained behind a source."""
    filters[0].SetInputDataObject(0, source)
    for before, after in pairwise(filters):
        after.SetInputConnection(0, before.GetOutputPort(0))
    return pv.wrap(filters[-1].run())


def sheet(columns):
    """An empty picture of so many columns."""
    plotter = pv.Plotter(off_screen=True, shape=(1, columns), window_size=(1400, 560), border=False)
    plotter.set_background(PAPER)
    return plotter


def curves_figure(folder):
    """Points, the curves fitted to their skeleton with control polygons, and the surface around the curves."""
    cloud = pv.read(SAMPLES / "tree_of_tubes.vtp")
    fitted = BezierSkeleton()
    lines = run(cloud, CurveSkeleton(), fitted)
    pieces = pv.wrap(fitted.GetOutputDataObject(1))
    surface = run(lines, SkeletonSurface(cells_per_radius=10))
    colours = {**BRANCHES, "n_colors": lines.n_lines, "clim": (-0.5, lines.n_lines - 0.5)}
    plotter = sheet(3)
    plotter.add_mesh(cloud, color=INK, point_size=2)
    plotter.subplot(0, 1)
    plotter.add_mesh(lines.tube(radius=0.03), **colours)
    control = pieces.points.reshape(-1, 4, 3)[:, [0, 2, 3, 1]]
    rows = np.column_stack([np.full(len(control), 4), np.arange(4 * len(control)).reshape(-1, 4)])
    polygons = pv.PolyData(control.reshape(-1, 3), lines=rows.ravel())
    plotter.add_mesh(polygons, color=INK, line_width=1)
    plotter.add_mesh(polygons.glyph(geom=pv.Sphere(radius=0.05), scale=False, orient=False), color=INK)
    plotter.subplot(0, 2)
    actor = plotter.add_mesh(surface, **colours)
    actor.prop.interpolation = "Phong"  # with the surface's own normals
    for column in range(3):
        plotter.subplot(0, column)
        plotter.view_vector((0.6, -1, 0.15), viewup=(0, 0, 1))
        plotter.camera.zoom(1.3)
    plotter.screenshot(folder / "bezier_surface.png")
    plotter.close()


def outline_points():
    """Points on the outline of a hand: a palm and five fingers, all of them discs along lines."""
    ends = np.array([[-2.1, 1.3], [-1.2, 2.7], [0.1, 3.2], [1.3, 2.6], [2.3, 0.5]])
    skeleton = pv.PolyData(
        np.column_stack([np.concatenate([[[0, 0], [0, -1.3]], ends]), np.zeros(7)]),
        lines=np.concatenate([[2, 0, k] for k in range(1, 7)]),
    )
    skeleton["MaximumInscribedSphereRadius"] = np.array([0.9, 0.6, 0.2, 0.22, 0.22, 0.22, 0.25])
    return pv.PolyData(run(skeleton, SkeletonSurface(dimension="plane", cells_per_radius=30)).points)


def region_figure(folder):
    """Points of an outline, their skeleton with its discs, and the region it gives back."""
    cloud = outline_points()
    skeleton = run(cloud, CurveSkeleton(detail=1.0))
    region = run(skeleton, SkeletonSurface())
    plotter = sheet(3)
    plotter.add_mesh(cloud, color=INK, point_size=3)
    plotter.subplot(0, 1)
    ring = pv.Disc(inner=0.98, outer=1, c_res=60)
    discs = skeleton.glyph(geom=ring, scale="MaximumInscribedSphereRadius", orient=False)
    plotter.add_mesh(discs, color="#b8c4cf")
    plotter.add_mesh(skeleton, color="#c04020", line_width=4)
    plotter.subplot(0, 2)
    plotter.add_mesh(pv.PolyData(region.points, faces=region.faces), color=SKIN, lighting=False)
    plotter.add_mesh(pv.PolyData(region.points, lines=region.lines), color=INK, line_width=3)
    for column in range(3):
        plotter.subplot(0, column)
        plotter.view_xy()
        plotter.camera.zoom(1.2)
    plotter.screenshot(folder / "region.png")
    plotter.close()


def main(folder):
    """Draw both."""
    curves_figure(Path(folder))
    region_figure(Path(folder))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else HERE / "pictures")
