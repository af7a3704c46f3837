"""A skeleton with radii back to the surface of its object.

In space a watertight surface; in the plane the closed outline of the region, with the region as triangles. With
--against the error in percent of the original's diagonal is printed.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.arguments import add_drawings, add_input, add_json, add_options, values
from tetraskel.cli.outputs import InputFile, OutputFile
from tetraskel.errors import InputError
from tetraskel.options import SurfaceOptions

EXAMPLES = (
    ("The object again, as a mesh to print:", "surface skeleton.vtp object.stl"),
    ("How far is it from the points it came from?", "surface skeleton.vtp object.ply --against scan.ply"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel surface` takes."""
    add_input(parser, "a skeleton with radii: .vtp .vtk .swc")
    parser.add_argument("output", metavar="OUT", type=OutputFile, help="the surface: .vtp .vtk .ply .obj .stl")
    add_json(parser)
    add_drawings(parser)
    parser.add_argument(
        "--sheets", metavar="FILE", type=InputFile, help="medial sheets to be covered too, .vtp .vtk; for plates"
    )
    parser.add_argument(
        "--against", metavar="FILE", type=InputFile, help="the original points or surface, to print the error"
    )
    add_options(parser, SurfaceOptions)


def run(chosen: argparse.Namespace) -> None:
    """Rebuild, write, and say how near it comes."""
    from tetraskel.cli.chain import prepared, run_filters, tell, written
    from tetraskel.cli.files import read
    from tetraskel.cli.swc import read_skeleton
    from tetraskel.vtkfilters import SkeletonSurface

    step = SkeletonSurface(**values(chosen, SurfaceOptions))
    write = prepared(chosen, _writers())
    source = read_skeleton(chosen.input, chosen.radius_array)
    if chosen.sheets:
        source = _with_sheets(source, read(chosen.sheets))
    if chosen.against:
        step.SetInputDataObject(1, read(chosen.against))
    result = run_filters(source, [step])
    written(chosen, source, result, write)
    tell(chosen, source, result, _summary(chosen, source, result))


def _with_sheets(skeleton, sheets):
    """One data set of both, with the arrays that both have."""
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData

    if isinstance(sheets, vtkPolyData) and not sheets.GetNumberOfPoints():
        return skeleton  # of an object without sheets
    if not isinstance(sheets, vtkPolyData) or not sheets.GetNumberOfPolys():
        raise InputError(
            f"expected medial sheets, faces with radii, for --sheets, got {sheets.GetClassName()} without."
        )
    both = vtkAppendPolyData()
    both.AddInputData(skeleton)
    both.AddInputData(sheets)
    both.Update()
    result = both.GetOutput()
    result.GetFieldData().PassData(skeleton.GetFieldData())
    return result


def _writers() -> dict:
    from vtkmodules.vtkIOGeometry import vtkOBJWriter, vtkSTLWriter
    from vtkmodules.vtkIOPLY import vtkPLYWriter

    from tetraskel.cli.files import WRITERS, write_vtk

    others = {".ply": vtkPLYWriter, ".obj": vtkOBJWriter, ".stl": vtkSTLWriter}
    return {
        **{suffix: WRITERS[suffix] for suffix in (".vtp", ".vtk")},
        **{suffix: lambda data, path, kind=kind: write_vtk(kind(), data, path) for suffix, kind in others.items()},
    }


def _summary(chosen: argparse.Namespace, source, result) -> str:
    facts = result.GetFieldData()
    lines = f"{result.GetNumberOfLines():,} outlines, " if result.GetNumberOfLines() else ""
    text = (
        f"{chosen.input}: {source.GetNumberOfPoints():,} balls -> {chosen.output}: {lines}"
        f"{result.GetNumberOfPolys():,} triangles, cells of {facts.GetArray('Spacing').GetValue(0):g}"
    )
    words = {"Error": "from the original", "BackError": "to the original"}
    for name, way in words.items():
        if facts.GetArray(f"{name}Mean") is not None:
            mean, largest = (facts.GetArray(f"{name}{kind}").GetValue(0) for kind in ("Mean", "Max"))
            text += f"; distance {way} {mean:.3g} % of its diagonal, at most {largest:.3g} %"
    return text
