"""A picture of a result inside its points, off screen."""

from __future__ import annotations

from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData

from tetraskel.cli.files import replace_file

SIZE = (1200, 900)


def draw(source: vtkPointSet, result: vtkPolyData, path: str) -> None:
    """Draw `result` coloured by depth among the points of `source` and save it as PNG."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
    plotter.set_background("white")
    if source.GetNumberOfPoints():
        cloud = pyvista.PolyData(pyvista.wrap(source).points)
        plotter.add_mesh(cloud, color="#9aa5b1", point_size=3, opacity=0.6)
    if result.GetNumberOfPoints():
        lines = pyvista.wrap(result)
        plotter.add_mesh(lines, scalars="Depth", cmap="viridis", line_width=3, scalar_bar_args={"color": "black"})
    if _is_flat(source):
        plotter.view_xy()
    else:
        plotter.view_vector((1, -2, 0.8), viewup=(0, 0, 1))
    replace_file(Path(path), lambda part: plotter.screenshot(str(part)))
    plotter.close()


def _is_flat(source: vtkPointSet) -> bool:
    low, high = source.GetBounds()[4:]
    return low == high
