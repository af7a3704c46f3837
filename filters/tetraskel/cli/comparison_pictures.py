"""Pictures of a comparison: every skeleton in its object, alone and side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.cli.colours import RADIUS, colour_range
from tetraskel.cli.files import replace_file, silent_log
from tetraskel.comparison import Row

SIZE = (1200, 900)
TILE = (440, 400)
COLUMNS = 5
SHELL, LINE = "#5b6b7a", "#30404f"
FEW = 2000  # lines or points so few that each is to be seen


def draw_each(folder: Path, rows: Sequence[Row], skeletons: Mapping[str, vtkPolyData], boundary: vtkPolyData) -> None:
    """A picture for each skeleton that there is."""
    import pyvista

    for row in rows:
        if row.method in skeletons:
            with silent_log():
                plotter = pyvista.Plotter(off_screen=True, window_size=SIZE)
                _scene(plotter, row, skeletons[row.method], boundary, _widest(rows))
                _save(plotter, folder / f"{row.method}.png")


def draw_overview(path: Path, rows: Sequence[Row], skeletons: Mapping[str, vtkPolyData], boundary: vtkPolyData) -> None:
    """All methods in a grid under one view; a method that failed is a tile that says so."""
    import pyvista

    columns = min(COLUMNS, len(rows))
    lines = -(-len(rows) // columns)
    size = (columns * TILE[0], lines * TILE[1])
    with silent_log():
        plotter = pyvista.Plotter(off_screen=True, shape=(lines, columns), window_size=size, border=False)
        plotter.set_background("white")
        for number, row in enumerate(rows):
            plotter.subplot(*divmod(number, columns))
            if row.method in skeletons:
                _scene(plotter, row, skeletons[row.method], boundary, _widest(rows))
            else:
                plotter.add_text(f"{row.method}: failed,\nsee the table", font_size=14, color="black")
        _save(plotter, path)


def _scene(plotter, row: Row, skeleton: vtkPolyData, boundary: vtkPolyData, widest: float) -> None:
    """A skeleton coloured by radius, 0 to the widest of all, in the object's boundary, with its name."""
    import pyvista

    plotter.set_background("white")
    flat = boundary.GetNumberOfPolys() == 0
    shell = {"color": LINE, "line_width": 2} if flat else {"color": SHELL, "opacity": 0.12}
    plotter.add_mesh(pyvista.wrap(boundary), **shell)
    data = pyvista.wrap(skeleton)
    few = data.n_points < FEW
    style = {"scalars": RADIUS, "cmap": "viridis", "show_scalar_bar": False, "clim": colour_range(RADIUS, [widest])}
    if row.kind == "points":
        places = pyvista.PolyData(data.points)
        places[RADIUS] = data[RADIUS]
        plotter.add_mesh(places, point_size=8 if few else 3, render_points_as_spheres=few, **style)
    elif data.n_points:
        plotter.add_mesh(data, line_width=5 if few else 1, point_size=6 if few else 2, **style)
    title = f"{row.method} ({len(row.drawn):,} points)"
    plotter.add_text(title, font_size=12, color="black", position="upper_edge")
    if flat:
        plotter.view_xy()
    else:
        plotter.view_vector((1, -2, 1.4), viewup=(0, 0, 1))
    plotter.camera.zoom(1.25)


def _widest(rows: Sequence[Row]) -> float:
    """Where the colours end, the same in every picture: the least of the methods' largest radii.

    Some circumcentres of sk4 lie outside of the object, with radii that would make all else look alike.
    """
    return min((float(row.drawn.radius.max(initial=0.0)) for row in rows if row.drawn is not None), default=0.0)


def _save(plotter, path: Path) -> None:
    replace_file(path, lambda part: plotter.screenshot(str(part)))
    plotter.close()
