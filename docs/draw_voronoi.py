"""Draw the pictures of the Voronoi and raster skeletons: `python docs/draw_voronoi.py`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista

from tetraskel import (
    interior,
    morphological_reversal,
    raster_skeleton,
    rasterise,
    tree_skeleton,
    triangulate,
    voronoi_skeleton,
)

HERE = Path(__file__).resolve().parent
SAMPLES = HERE.parent / "sample_data"
INK, PAPER, RED = "#30404f", "white", "#c0392b"
TITLES = {"sk1": "Sk1", "sk2": "Sk2", "sk3": "Sk3", "sk4": "Sk4"}


def flat(points):
    """Points of the plane in space."""
    return np.column_stack([points, np.zeros(len(points))])


def lines_of(points, edges):
    """Edges as polygonal data."""
    cells = np.column_stack([np.full(len(edges), 2), edges]).ravel() if len(edges) else None
    return pyvista.PolyData(points, lines=cells)


def draw_flat(plotter, mesh, points, edges, title):
    """A mesh in thin lines, its points, and a skeleton in red."""
    cells = np.column_stack([np.full(len(mesh), 3), mesh.simplices]).ravel()
    plotter.add_mesh(pyvista.PolyData(flat(mesh.points), cells), style="wireframe", color="#b8c4cf", line_width=1.5)
    plotter.add_points(flat(mesh.points), color=INK, point_size=11, render_points_as_spheres=True)
    if len(edges):
        plotter.add_mesh(lines_of(flat(points), edges), color=RED, line_width=4)
    plotter.add_points(flat(points), color=RED, point_size=9, render_points_as_spheres=True)
    plotter.add_text(title, font_size=14, color="black", position="upper_edge")
    plotter.view_xy()
    plotter.camera.zoom(1.3)


def rectangle_figure():
    """Figures 7, 8, 9 and 12 of the paper: the rectangle of eight points."""
    mesh = triangulate(np.loadtxt(SAMPLES / "rectangle8.csv", delimiter=",", skiprows=1)[:, :2])
    plotter = pyvista.Plotter(off_screen=True, shape=(2, 2), window_size=(1400, 860), border=False)
    plotter.set_background(PAPER)
    for place, method in zip(((0, 0), (0, 1), (1, 0)), ("sk1", "sk2", "sk3"), strict=True):
        plotter.subplot(*place)
        skeleton = voronoi_skeleton(mesh, method=method)
        draw_flat(plotter, mesh, skeleton.points, skeleton.lines, TITLES[method])
    plotter.subplot(1, 1)
    tree = tree_skeleton(mesh)
    edges = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in branches(tree)])
    draw_flat(plotter, mesh, tree.points, edges, "the tree's skeleton")
    plotter.screenshot(HERE / "pictures" / "voronoi_rectangle.png")


def branches(tree):
    """Points of each polyline of a tree's skeleton."""
    bounds = zip(tree.branch_offsets[:-1], tree.branch_offsets[1:], strict=True)
    return [tree.branch_nodes[a:b] for a, b in bounds]


def draw_sheets(plotter, points, skeleton, title, outlined):
    """A skeleton in space among its points; slivers are seen by their outlines."""
    plotter.add_points(points, color=INK, point_size=2)
    rings = np.split(skeleton.connectivity, skeleton.offsets[1:-1])
    faces = np.concatenate([[len(ring), *ring] for ring in rings]) if skeleton.n_polygons else None
    sheets = pyvista.PolyData(skeleton.points, faces=faces)
    sheets["Radius"] = skeleton.radius
    plotter.add_mesh(sheets, scalars="Radius", cmap="viridis", show_scalar_bar=False, point_size=3)
    if outlined:
        plotter.add_mesh(
            sheets.extract_all_edges(), scalars="Radius", cmap="viridis", show_scalar_bar=False, line_width=3
        )
    plotter.add_text(title, font_size=14, color="black", position="upper_edge")
    plotter.view_vector((1, -2, 1.4), viewup=(0, 0, 1))
    plotter.camera.zoom(1.4)


def torus_figure():
    """Skeletons of a torus in space, whole and simplified by the angle."""
    points = np.asarray(pyvista.read(SAMPLES / "torus.vtp").points)
    mesh = triangulate(points)
    inside = interior(mesh)
    plotter = pyvista.Plotter(off_screen=True, shape=(2, 2), window_size=(1400, 900), border=False)
    plotter.set_background(PAPER)
    shown = [("sk1", 0.0), ("sk2", 0.0), ("sk3", 0.0), ("sk2", 60.0)]
    for k, (method, angle) in enumerate(shown):
        plotter.subplot(k // 2, k % 2)
        skeleton = voronoi_skeleton(mesh, inside=inside, method=method, least_angle=angle)
        title = TITLES[method] + (f", angle at least {angle:g} degrees" if angle else "")
        draw_sheets(plotter, points, skeleton, title, angle > 0)
    plotter.screenshot(HERE / "pictures" / "voronoi_torus.png")


def draw_mask(plotter, marks, title):
    """An image of cells: 0 nothing, 1 the mask, 2 its skeleton."""
    image = pyvista.ImageData(dimensions=(*(size + 1 for size in marks.shape), 1))
    image.cell_data["marks"] = marks.ravel(order="F")
    cells = image.threshold(0.5, scalars="marks")
    plotter.add_mesh(cells, scalars="marks", cmap=["#dfe6ec", RED], clim=(1, 2), show_scalar_bar=False, lighting=False)
    plotter.add_text(title, font_size=11, color="black", position="upper_edge")
    plotter.view_xy()
    plotter.camera.zoom(1.25)


def raster_figure():
    """Morphological, distance and thinned skeleton of a shape, and the shape given back by the first."""
    angles = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    reach = 1 + 0.35 * np.cos(5 * angles)
    mesh = triangulate(np.stack([reach * np.cos(angles), 0.8 * reach * np.sin(angles)], axis=1))
    middle = mesh.points[mesh.simplices].mean(axis=1) / [1, 0.8]
    inside = np.hypot(*middle.T) < 1 + 0.35 * np.cos(5 * np.arctan2(middle[:, 1], middle[:, 0]))
    mask = rasterise(mesh, inside=inside, resolution=120).values
    plotter = pyvista.Plotter(off_screen=True, shape=(2, 2), window_size=(1300, 1100), border=False)
    plotter.set_background(PAPER)
    for place, method in enumerate(("morphological", "thinning", "distance")):
        plotter.subplot(place // 2, place % 2)
        skeleton = raster_skeleton(mask, method=method)
        marks = mask.astype(np.uint8)
        marks[tuple(skeleton.indices.T)] = 2
        draw_mask(plotter, marks, method)
        if method == "morphological":
            back = morphological_reversal(skeleton)
    if not np.array_equal(back, mask):
        raise SystemExit("the mask did not come back")
    plotter.subplot(1, 1)
    draw_mask(plotter, back.astype(np.uint8), "given back by the morphological one, cell for cell")
    plotter.screenshot(HERE / "pictures" / "raster.png")


if __name__ == "__main__":
    rectangle_figure()
    torus_figure()
    raster_figure()
