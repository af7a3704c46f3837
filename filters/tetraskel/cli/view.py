"""Look at a skeleton, a tree, a surface or points: in a window, in a browser, or as a picture.

Without --html and --png a window opens: drag to turn, wheel to zoom, q to close. The page that --html writes is one
file that turns in any browser, without a server or a connection.
"""

from __future__ import annotations

import argparse
import os
import sys

from tetraskel.cli.arguments import add_drawings
from tetraskel.cli.outputs import InputFile
from tetraskel.errors import InputError

EXAMPLES = (
    ("Look at a skeleton among the points it was made from:", "view skeleton.vtp --points scan.ply"),
    ("A page to turn it in a browser, for colleagues who have nothing installed:",
     "view skeleton.vtp --points scan.ply --html skeleton.html"),
)  # fmt: skip


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel view` takes."""
    parser.add_argument(
        "input", metavar="FILE", type=InputFile, help="what to look at: .vtp .vtu .vtk .swc .ply .obj .stl .csv ..."
    )
    parser.add_argument("--points", metavar="FILE", type=InputFile, help="points of the object, drawn around it")
    add_drawings(parser, how="")


def run(chosen: argparse.Namespace) -> None:
    """Show it, or write what shows it."""
    from pathlib import Path

    from tetraskel.cli.drawings import check_drawings, draw_all
    from tetraskel.cli.files import read
    from tetraskel.cli.picture import show

    check_drawings(chosen)
    result = _polygonal(chosen.input)
    source = read(chosen.points) if chosen.points else _empty()
    if chosen.png or chosen.html:
        draw_all(chosen, source, result)
        made = ", ".join(filter(None, (chosen.png, chosen.html)))
        print(f"{chosen.input}: {result.GetNumberOfPoints():,} points, {result.GetNumberOfLines():,} lines -> {made}")
        return
    _check_display()
    show(source, result, Path(chosen.input).name)


def _polygonal(path: str):
    """A file's points, lines and faces; a solid mesh by its surface."""
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

    from tetraskel.cli.files import read
    from tetraskel.cli.swc import read_skeleton
    from tetraskel.options import SurfaceOptions

    if path.lower().endswith(".swc"):
        return read_skeleton(path, SurfaceOptions.radius_array)
    data = read(path)
    if isinstance(data, vtkPolyData):
        return data
    surface = vtkGeometryFilter()
    surface.SetInputData(data)
    surface.Update()
    return surface.GetOutput()


def _empty():
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    return vtkPolyData()


def _check_display() -> None:
    import pyvista

    wanted = sys.platform.startswith("linux") and not pyvista.OFF_SCREEN
    if wanted and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("expected a display for the window, got none; use --html FILE or --png FILE.")
