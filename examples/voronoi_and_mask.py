"""Inside and outside of points in the plane, and two other skeletons of the same object.

The points lie on the outline of a clover leaf. Left its Delaunay triangles, coloured by whether they are inside; in
the middle the Voronoi skeleton; right the ridge of the distance in the mask that the inside makes.
"""

import sys

import numpy as np
import pyvista

import tetraskel.pyvista_accessor  # noqa: F401  (an installed tetraskel needs no import)

angle = np.linspace(0, 2 * np.pi, 240, endpoint=False)
away = 1 + 0.4 * np.cos(3 * angle)
outline = pyvista.PolyData(np.stack([away * np.cos(angle), away * np.sin(angle), 0 * angle], axis=1))

triangles = outline.tetraskel.interior()
voronoi = outline.tetraskel.voronoi(least_angle=80)
mask = outline.tetraskel.raster(resolution=48, method="distance")
inside = triangles.extract_cells(triangles["Inside"] == 1)
assert abs(inside.area / (1.08 * np.pi) - 1) < 0.01  # the area of the clover

plotter = pyvista.Plotter(shape=(1, 3), window_size=(1800, 500))
plotter.add_mesh(triangles, show_edges=True, cmap=["white", "wheat"], show_scalar_bar=False)
for column, (skeleton, title) in enumerate([(voronoi, "Radius"), (mask, "Radius in the mask")], 1):
    plotter.subplot(0, column)
    plotter.add_mesh(outline, color="grey", point_size=3)
    plotter.add_mesh(skeleton, line_width=4, point_size=8, cmap="viridis", scalar_bar_args={"title": title})
plotter.link_views()
plotter.view_xy()
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
