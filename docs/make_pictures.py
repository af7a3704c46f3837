"""Draw the pictures of the documentation: `python docs/make_pictures.py`."""

from __future__ import annotations

import itertools
import sys
from pathlib import Path

import numpy as np
import pyvista

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from tetraskel.vtkfilters import CurveSkeleton, DelaunayMesh, FlatTetraRemoval, SkeletonOutput, TreeBuilder
from tubes import TUBES, cylinder

HERE = Path(__file__).resolve().parent
SAMPLES = HERE.parent / "sample_data"
INK, PAPER = "#30404f", "white"
RADIUS = "MaximumInscribedSphereRadius"


def table(name):
    """A sample of coordinates as points."""
    return pyvista.PolyData(np.loadtxt(SAMPLES / name, delimiter=",", skiprows=1))


def run(source, *filters):
    """The output of filters chained behind a source."""
    filters[0].SetInputDataObject(0, source)
    for before, after in itertools.pairwise(filters):
        after.SetInputConnection(0, before.GetOutputPort())
    return pyvista.wrap(filters[-1].run())


def draw(plotter, cloud, skeleton, radius):
    """Points as balls, the mesh as thin lines, the tree as tubes coloured by depth."""
    edges = run(cloud, DelaunayMesh()).extract_all_edges()
    plotter.add_mesh(edges, color="#b8c4cf", line_width=1.5)
    plotter.add_mesh(cloud.glyph(geom=pyvista.Sphere(radius=radius), scale=False, orient=False), color=INK)
    tubes = skeleton.tube(radius=radius * 0.5)
    plotter.add_mesh(tubes, scalars="Depth", cmap="viridis", show_scalar_bar=False)
    plotter.add_mesh(skeleton.glyph(geom=pyvista.Sphere(radius=radius), scale=False, orient=False), cmap="viridis",
                     scalars="Depth", show_scalar_bar=False)  # fmt: skip


def paper_figure():
    """The binary tree of a polygon's triangulation and the ternary tree of a cloud in space, side by side."""
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1400, 620), border=False)
    plotter.set_background(PAPER)
    flat = table("polygon.csv")
    draw(plotter, flat, run(flat, DelaunayMesh(), TreeBuilder()), 0.012 * flat.length)
    plotter.view_xy()
    plotter.camera.zoom(1.35)
    plotter.subplot(0, 1)
    cloud = table("cloud20.csv")
    draw(plotter, cloud, run(cloud, DelaunayMesh(), TreeBuilder(), SkeletonOutput()), 0.010 * cloud.length)
    plotter.view_vector((1, -2, 0.8), viewup=(0, 0, 1))
    plotter.camera.zoom(1.35)
    plotter.screenshot(HERE / "pictures" / "trees.png")


def box_figure():
    """The box of 8 displaced corners: branches on its sides, and the tree without flat tetrahedra."""
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1400, 560), border=False)
    plotter.set_background(PAPER)
    box = pyvista.read(SAMPLES / "box8.vtp")
    for column, steps in enumerate(([], [FlatTetraRemoval()])):
        plotter.subplot(0, column)
        tree = run(box, DelaunayMesh(joggle=1e-6), TreeBuilder(), *steps)
        draw(plotter, box, tree, 0.012 * box.length)
        plotter.view_vector((1, -2, 0.8), viewup=(0, 0, 1))
        plotter.camera.zoom(1.2)
    plotter.screenshot(HERE / "pictures" / "box.png")


def plate_figure():
    """The sheet of a plate among its random points, and with the sheets that run into its edges."""
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(900, 330), border=False)
    plotter.set_background(PAPER)
    cloud = pyvista.PolyData(box_surface((4.0, 3.0, 0.5), 9000))
    for column, angle in enumerate((120, 60)):
        plotter.subplot(0, column)
        curve = CurveSkeleton(sheets=True, sheet_angle=angle)
        run(cloud, curve)
        sheets = pyvista.wrap(curve.GetOutputDataObject(2))
        plotter.add_mesh(cloud, color=INK, point_size=1.5, opacity=0.4)
        plotter.add_mesh(sheets, scalars=RADIUS, cmap="viridis", clim=(0, 0.26), show_scalar_bar=False)
        plotter.view_vector((1, -2, 1.2), viewup=(0, 0, 1))
        plotter.camera.zoom(1.3)
    plotter.screenshot(HERE / "pictures" / "sheets.png")


def detail_figure():
    """The skeleton of the limbs at three details."""
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 3), window_size=(1260, 330), border=False)
    plotter.set_background(PAPER)
    cloud = pyvista.read(SAMPLES / "limbs.vtp")
    for column, detail in enumerate((0, 0.5, 1)):
        plotter.subplot(0, column)
        skeleton = run(cloud, CurveSkeleton(detail=detail))
        plotter.add_mesh(cloud, color=INK, point_size=1.5, opacity=0.4)
        tubes, widest = skeleton.tube(radius=0.03), skeleton[RADIUS].max()
        plotter.add_mesh(tubes, scalars=RADIUS, cmap="viridis", clim=(0, widest), show_scalar_bar=False)
        plotter.view_vector((1, -2, 1), viewup=(0, 0, 1))
        plotter.camera.zoom(1.4)
    plotter.screenshot(HERE / "pictures" / "detail.png")
    plotter.close()


def box_surface(sides, n):
    """Random points of a box, uniform by area."""
    rng = np.random.default_rng(0)
    sides = np.asarray(sides)
    areas = sides.prod() / sides
    points, axis = rng.random((n, 3)) * sides, rng.choice(3, n, p=areas / areas.sum())
    points[np.arange(n), axis] = rng.integers(0, 2, n) * sides[axis]
    return points + rng.normal(0, 1e-4, (n, 3))  # Qhull is slow on points exactly in one plane


GALLERY_POINTS = {"annulus": 2500, "helix": 12000, "tree": 12000, "double torus": 10000}


def gallery():
    """One picture per shape: its points, the skeleton as a tube coloured by radius, ends and junctions as balls."""
    shapes = {name: make().sample(GALLERY_POINTS.get(name, 8000), seed=2) for name, make in TUBES.items()}
    shapes["cylinder"] = cylinder(8000, seed=2)
    shapes["plate"] = box_surface((4.0, 3.0, 0.5), 9000)
    for name, points in shapes.items():
        gallery_figure(name, np.c_[points, np.zeros((len(points), 3 - points.shape[1]))])
    for sample in ("y_tube", "torus", "bent_tube", "tree_of_tubes"):
        gallery_figure(f"sample {sample}", np.asarray(pyvista.read(SAMPLES / f"{sample}.vtp").points))


def gallery_figure(name, points):
    """Points, skeleton and sheets of one shape as pictures/gallery-NAME.png."""
    cloud, curve = pyvista.PolyData(points), CurveSkeleton(sheets=name == "plate")
    skeleton = run(cloud, curve)
    plotter = pyvista.Plotter(off_screen=True, window_size=(420, 320))
    plotter.set_background(PAPER)
    plotter.add_mesh(cloud, color=INK, point_size=1.5, opacity=0.25)
    thick = 0.008 * cloud.length
    shades = {"scalars": RADIUS, "cmap": "viridis", "clim": (0, 1.2 * skeleton[RADIUS].max()), "show_scalar_bar": False}
    plotter.add_mesh(skeleton.tube(radius=thick), **shades)
    for kind, colour in ((0, "#d1495b"), (2, "#edae49")):  # ends, junctions
        places = skeleton.points[skeleton["NodeType"] == kind]
        for place in places:
            plotter.add_mesh(pyvista.Sphere(radius=2 * thick, center=place), color=colour)
    sheets = pyvista.wrap(curve.GetOutputDataObject(2))
    if sheets.n_points:
        plotter.add_mesh(sheets, color="#9fc5bb", opacity=0.6)
    look(plotter, points)
    plotter.screenshot(HERE / "pictures" / f"gallery-{name.replace(' ', '_')}.png")
    plotter.close()


def look(plotter, points):
    """Along the thinnest side of the points, a little from above where they have no thin side."""
    size = np.ptp(points, axis=0)
    if size[2] < 0.3 * size[:2].min():
        plotter.view_vector((0.15, -0.7, 1), viewup=(0, 1, 0))
    elif size[2] <= size[:2].max():
        plotter.view_vector((0.1, -0.5, 1), viewup=(0, 1, 0))
    else:
        plotter.view_vector((0.6, -2, 0.3), viewup=(0, 0, 1))
    plotter.camera.zoom(1.15)


if __name__ == "__main__":
    paper_figure()
    box_figure()
    plate_figure()
    detail_figure()
    gallery()
