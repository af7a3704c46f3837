"""All skeletons of one object side by side: a table of measures and a picture for each method.

OUTFOLDER gets table.md, table.json, overview.png, and for each method a picture and the skeleton as .vtp. Skeletons are
judged by --surface, or without it by the boundary of the object's inside.
"""

from __future__ import annotations

import argparse
import json
from functools import partial

import numpy as np

from tetraskel.cli.arguments import add_json, add_options, add_points_only, values
from tetraskel.cli.outputs import InputFile, OutputFile, inputs_of
from tetraskel.errors import InputError
from tetraskel.options import CompareOptions, CurveOptions, DelaunayOptions

EXAMPLES = (
    (
        "Four skeletons of one scan, with a table and pictures:",
        "compare scan.ply compared --methods curve,tree,sk4,distance",
    ),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel compare` takes."""
    from tetraskel.cli.chain import add_inside

    parser.add_argument(
        "input", metavar="IN", type=InputFile, help="points: .vtp .vtu .vtk .vti .ply .obj .stl .csv .xyz .txt .npy"
    )
    parser.add_argument(
        "output", metavar="OUTFOLDER", type=OutputFile, help="folder for the table, pictures and skeletons"
    )
    parser.add_argument(
        "--surface", metavar="FILE", type=InputFile, help="closed surface, or in the plane closed lines, to judge by"
    )
    add_points_only(parser)
    add_json(parser)
    add_options(parser, CompareOptions)
    add_inside(parser)
    add_options(parser, DelaunayOptions)
    parser.set_defaults(inside="gates", denoise=CurveOptions.denoise)


def run(chosen: argparse.Namespace) -> None:
    """Draw, measure, and write all."""
    from tetraskel.cli.comparison_files import Judged, checked_folder, found, write_all
    from tetraskel.cli.files import read_points
    from tetraskel.comparison import chosen_methods, compare
    from tetraskel.vtkfilters.progress import ProgressLine

    options = values(chosen, CompareOptions)
    values(chosen, DelaunayOptions)
    names = chosen_methods(options["methods"])
    folder = checked_folder(chosen.output, names, inputs_of(chosen))
    source = read_points(chosen.input)
    surface = _surface(chosen.surface) if chosen.surface else None
    mesh, inside = _object(chosen, source)
    if surface is not None and mesh.dim == 2:
        surface = _outline(chosen.surface)
    with ProgressLine() as line:
        tick = partial(line.show, "Drawing and measuring")
        rows = compare(mesh, surface, inside=inside, **options, tick=tick)
    if all(row.failure for row in rows):
        raise InputError(f"no skeleton was drawn; {rows[0].method}: {rows[0].failure}")
    judged = Judged(chosen.input, chosen.surface, mesh, inside)
    write_all(folder, rows, judged)
    if chosen.json:
        print(json.dumps({"output": chosen.output, "input_points": source.GetNumberOfPoints(), **found(rows, judged)}))
        return
    drawn = sum(not row.failure for row in rows)
    print(
        f"{chosen.input}: {source.GetNumberOfPoints():,} points -> {chosen.output}: {drawn} of {len(rows)} skeletons "
        f"drawn, table.md, table.json, overview.png"
    )


def _object(chosen: argparse.Namespace, source):
    """The triangulation all methods share, and which of its simplices are inside."""
    from tetraskel.cli.chain import interior_cells, run_filters, steps_for
    from tetraskel.vtkfilters import DelaunayMesh
    from tetraskel.vtkfilters.convert import array_of, mesh_of

    triangulation = DelaunayMesh(**values(chosen, DelaunayOptions))
    steps = steps_for(chosen, source, [triangulation, *interior_cells(chosen, extract=False)])
    data = run_filters(source, steps) if steps else source
    mesh = mesh_of(data)
    inside = np.ones(len(mesh), bool) if chosen.inside == "all" else array_of(data.GetCellData(), "Inside") != 0
    return mesh, inside


def _surface(path: str):
    """Points and triangles of a surface file."""
    from tetraskel.cli.files import read
    from tetraskel.vtkfilters.convert import surface_of_data

    return surface_of_data(read(path))


def _outline(path: str):
    """Points and segments of a file of closed lines or polygons."""
    from tetraskel.cli.files import read
    from tetraskel.vtkfilters.convert import points_of, segments_of

    data = read(path)
    parts = [segments_of(data.GetLines(), closed=False), segments_of(data.GetPolys(), closed=True)]
    return points_of(data), np.concatenate(parts)
