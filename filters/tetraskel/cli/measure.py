"""Judge a skeleton against the true surface of its object.

Prints homotopy, inside, centredness, reconstruction and branches as a table, or as JSON.
"""

from __future__ import annotations

import argparse
import json
from functools import partial

from tetraskel.cli.outputs import InputFile
from tetraskel.errors import InputError

EXAMPLES = (
    ("Is the skeleton inside, centred, complete? As JSON for scripts:", "measure skeleton.vtp surface.ply --json"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel measure` takes."""
    parser.add_argument("skeleton", metavar="SKELETON", type=InputFile, help="a curve skeleton: .vtp .vtk")
    parser.add_argument(
        "surface", metavar="SURFACE", type=InputFile, help="the closed surface of the object: .obj .ply .stl .vtp .vtk"
    )
    parser.add_argument("--json", action="store_true", help="print a line of JSON instead of a table")


def run(chosen: argparse.Namespace) -> None:
    """Measure and print."""
    from tetraskel.cli.files import read
    from tetraskel.kernels.measures import measure
    from tetraskel.vtkfilters.curve_skeleton import skeleton_from
    from tetraskel.vtkfilters.progress import ProgressLine

    skeleton, surface = skeleton_from(read(chosen.skeleton)), _surface(chosen.surface)
    with ProgressLine() as line:
        numbers = measure(skeleton, surface, tick=partial(line.show, "Measuring"))
    if not numbers:
        raise InputError("nothing to measure.")
    if chosen.json:
        print(json.dumps(numbers))
        return
    width = max(map(len, numbers))
    for name, value in numbers.items():
        print(f"{name:<{width}}  {value:.6g}")


def _surface(path: str):
    """Points and triangles of a surface file."""
    from tetraskel.cli.files import read
    from tetraskel.vtkfilters.convert import surface_of_data

    points, triangles = surface_of_data(read(path))
    if len(triangles) == 0:
        raise InputError(
            f"expected the closed surface of the object in {str(path)!r}, got {len(points):,} points and no faces; "
            "give a mesh with triangles, such as one `tetraskel surface` makes."
        )
    return points, triangles
