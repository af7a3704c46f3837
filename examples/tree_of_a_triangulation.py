"""The ternary tree of a cloud's Delaunay triangulation, and the skeleton it gives.

Every node is a tetrahedron, drawn at its barycentre and coloured by its depth in the tree.
"""

import sys

import numpy as np
import pyvista

import tetraskel.pyvista_accessor  # noqa: F401  (an installed tetraskel needs no import)

cloud = pyvista.PolyData(np.random.default_rng(0).random((60, 3)))
mesh = cloud.tetraskel.delaunay()
tree = mesh.tetraskel.tree()
branches = tree.tetraskel.remove_flat(threshold=0.05).tetraskel.branches()
assert tree.n_points == mesh.n_cells

plotter = pyvista.Plotter(shape=(1, 2), window_size=(1400, 600))
for column, (lines, title) in enumerate([(tree, "Depth"), (branches, "Depth of what is kept")]):
    plotter.subplot(0, column)
    plotter.add_mesh(mesh.extract_surface(algorithm="dataset_surface"), style="wireframe", color="lightgrey")
    plotter.add_mesh(lines, line_width=4, cmap="viridis", scalar_bar_args={"title": title, "fmt": "%.0f"})
plotter.link_views()
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
