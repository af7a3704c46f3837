"""A curve skeleton of points, and the object rebuilt from it.

The points lie on a torus; nothing else is known of it. Its skeleton is one closed line, with radii.
"""

import sys

import numpy as np
import pyvista

import tetraskel.pyvista_accessor  # noqa: F401  (an installed tetraskel needs no import)

around, across = np.random.default_rng(0).random((2, 4000)) * 2 * np.pi
out = 2 + 0.7 * np.cos(across)
torus = pyvista.PolyData(np.stack([out * np.cos(around), out * np.sin(around), 0.7 * np.sin(across)], axis=1))

skeleton = torus.tetraskel.skeleton()
surface = skeleton.tetraskel.surface()
assert skeleton.field_data["Loops"][0] == 1

plotter = pyvista.Plotter(shape=(1, 2), window_size=(1400, 600))
plotter.add_mesh(torus, color="lightsteelblue", point_size=3)
widest = skeleton["MaximumInscribedSphereRadius"].max()
plotter.add_mesh(skeleton, line_width=6, cmap="viridis", clim=(0, widest), scalar_bar_args={"title": "Radius"})
plotter.subplot(0, 1)
plotter.add_mesh(surface, color="wheat", smooth_shading=True)
plotter.link_views()
plotter.show(screenshot=sys.argv[1] if len(sys.argv) > 1 else None)
