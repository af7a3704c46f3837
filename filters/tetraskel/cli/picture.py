"""A result inside its points: as a picture, off screen, or in a window."""

from __future__ import annotations

from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData

from tetraskel.cli.colours import DEPTH, RADIUS, colour_range, legend
from tetraskel.cli.files import replace_file, silent_log

SIZE = (1200, 900)
FEW = 500  # points so few that each is to be seen
TUBES = 5000  # points up to which lines are drawn round


def draw(source: vtkPointSet, result: vtkPolyData, path: str) -> None:
    """Draw `result` coloured by radius or depth among the points of `source` and save it as PNG."""
    import pyvista

    with silent_log():
        plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
        fill(plotter, source, result)
        replace_file(Path(path), lambda part: plotter.screenshot(str(part)))
        plotter.close()


def show(source: vtkPointSet, result: vtkPolyData, title: str) -> None:
    """The same in a window, until it is closed."""
    import pyvista

    with silent_log():
        plotter = pyvista.Plotter(window_size=SIZE, title=title)
        fill(plotter, source, result)
        plotter.add_axes()
        plotter.show()


def fill(plotter, source: vtkPointSet, result: vtkPolyData) -> None:
    """Put both into a plotter and look at them."""
    plotter.set_background("white")
    if source.GetNumberOfPoints():
        _add_points(plotter, source)
    if result.GetNumberOfPoints():
        _add_result(plotter, result)
    if _is_flat(source if source.GetNumberOfPoints() else result):
        plotter.view_xy()
    else:
        plotter.view_vector((1, -2, 0.8), viewup=(0, 0, 1))
    plotter.camera.zoom(1.2)


def _add_points(plotter, source: vtkPointSet) -> None:
    import pyvista

    size = 12 if source.GetNumberOfPoints() < FEW else 3
    cloud = pyvista.PolyData(pyvista.wrap(source).points)
    plotter.add_mesh(cloud, color="#5b6b7a", point_size=size, render_points_as_spheres=True)


def _add_result(plotter, result: vtkPolyData) -> None:
    import pyvista

    name = next((name for name in (RADIUS, DEPTH) if result.GetPointData().HasArray(name)), None)
    if result.GetNumberOfPolys() and not result.GetNumberOfLines():
        style = {"color": "#e8c39e", "scalars": None, "opacity": 0.5}
    elif name:
        limits = colour_range(name, pyvista.wrap(result).point_data[name])
        bar = {"color": "black", "vertical": True, "height": 0.5, **legend(name, limits)}
        style = {"scalars": name, "cmap": "viridis", "clim": limits, "scalar_bar_args": bar}
    else:
        style = {"color": "#c04020", "scalars": None}
    width = 6 if result.GetNumberOfPoints() < FEW else 2
    tubes = result.GetNumberOfPoints() < TUBES and result.GetNumberOfLines() > 0
    looks = {
        "line_width": width,
        "render_lines_as_tubes": tubes,
        "point_size": 6,
        "render_points_as_spheres": not tubes,
    }
    plotter.add_mesh(pyvista.wrap(result), **looks, **style)


def _is_flat(data: vtkPointSet) -> bool:
    low, high = data.GetBounds()[4:]
    return low == high
