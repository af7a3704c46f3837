"""A picture of a result inside its points, off screen."""

from __future__ import annotations

from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData

from tetraskel.cli.files import replace_file, silent_log

SIZE = (1200, 900)
FEW = 500  # points so few that each is to be seen


def draw(source: vtkPointSet, result: vtkPolyData, path: str) -> None:
    """Draw `result` coloured by depth or radius among the points of `source` and save it as PNG."""
    import pyvista

    with silent_log():
        plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
        plotter.set_background("white")
        if source.GetNumberOfPoints():
            size = 12 if source.GetNumberOfPoints() < FEW else 3
            cloud = pyvista.PolyData(pyvista.wrap(source).points)
            plotter.add_mesh(cloud, color="#5b6b7a", point_size=size, render_points_as_spheres=True)
        if result.GetNumberOfPoints():
            name = "Depth" if result.GetPointData().HasArray("Depth") else "MaximumInscribedSphereRadius"
            title, form = ("Depth\n", "%.0f") if name == "Depth" else ("Radius\n", "%.2g")
            bar = {"color": "black", "fmt": form, "n_labels": 3, "vertical": True, "height": 0.5, "title": title}
            width = 6 if result.GetNumberOfPoints() < FEW else 2
            if result.GetPointData().HasArray(name):
                style = {"scalars": name, "cmap": "viridis", "scalar_bar_args": bar}
            else:
                style = {"color": "#e8c39e", "scalars": None, "opacity": 0.5}
            plotter.add_mesh(pyvista.wrap(result), line_width=width, **style)
        if _is_flat(source):
            plotter.view_xy()
        else:
            plotter.view_vector((1, -2, 0.8), viewup=(0, 0, 1))
        plotter.camera.zoom(1.2)
        replace_file(Path(path), lambda part: plotter.screenshot(str(part)))
        plotter.close()


def _is_flat(source: vtkPointSet) -> bool:
    low, high = source.GetBounds()[4:]
    return low == high
