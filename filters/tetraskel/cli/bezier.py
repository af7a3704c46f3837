"""A skeleton with radii to smooth curves: cubic Bezier pieces, inside its own balls.

OUT holds lines sampled from the curves, with the arrays of a curve skeleton and Curvature and Torsion.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.arguments import add_drawings, add_input, add_json, add_options, values
from tetraskel.cli.outputs import OutputFile
from tetraskel.options import BezierOptions

EXAMPLES = (
    ("Smooth centre lines, and the exact curves beside them:", "bezier skeleton.vtp smooth.vtp --pieces curves.vtu"),
    ("Curves that stay nearer to the skeleton:", "bezier skeleton.vtp smooth.vtp --tolerance 0.02"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel bezier` takes."""
    add_input(parser, "a skeleton with radii: .vtp .vtk .swc")
    parser.add_argument(
        "output", metavar="OUT", type=OutputFile, help="sampled lines: .vtp .vtk .swc .graphml .ply .csv"
    )
    parser.add_argument(
        "--pieces", metavar="FILE", type=OutputFile, help="also write the exact curves as Bezier cells, .vtu"
    )
    add_json(parser)
    add_drawings(parser)
    add_options(parser, BezierOptions)


def run(chosen: argparse.Namespace) -> None:
    """Fit and write."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    from tetraskel.cli.chain import prepared, run_filters, tell, written
    from tetraskel.cli.files import check_output, replace_to, write_vtk
    from tetraskel.cli.swc import read_skeleton
    from tetraskel.vtkfilters import BezierSkeleton

    step = BezierSkeleton(**values(chosen, BezierOptions))
    if chosen.pieces:
        check_output(chosen.pieces, (".vtu",))
    write = prepared(chosen)
    source = read_skeleton(chosen.input, chosen.radius_array)
    result = run_filters(source, [step])
    written(chosen, source, result, write)
    if chosen.pieces:
        write_pieces = replace_to(
            chosen.pieces, lambda data, path: write_vtk(vtkXMLUnstructuredGridWriter(), data, path)
        )
        write_pieces(step.GetOutputDataObject(1))
    n_pieces = result.GetFieldData().GetArray("Pieces").GetValue(0)
    text = (
        f"{chosen.input}: {source.GetNumberOfPoints():,} points -> {chosen.output}: {int(n_pieces):,} cubic pieces in "
        f"{result.GetNumberOfLines():,} branches, {result.GetNumberOfPoints():,} points"
    )
    tell(chosen, source, result, text)
