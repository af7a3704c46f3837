"""What the commands share: read, run filters one after another, write, draw, say what was done."""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Sequence

from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData, vtkUnstructuredGrid

from tetraskel.cli.files import check_folder, read, writer_for
from tetraskel.cli.picture import draw
from tetraskel.cli.progress import ProgressLine
from tetraskel.vtkfilters import SkeletonFilter


def add_files(parser: argparse.ArgumentParser) -> None:
    """IN, OUT and what goes with them."""
    parser.add_argument("input", metavar="IN", help="points: .vtp .vtu .vtk .vti .ply .obj .stl .csv .xyz .txt .npy")
    parser.add_argument("output", metavar="OUT", help="result: .vtp .vtk, or .csv with one row per node")
    parser.add_argument("--png", metavar="FILE", default=argparse.SUPPRESS, help="also draw the result, off screen")
    parser.add_argument(
        "--points-only", action="store_true", help="triangulate the points even if the file holds tetrahedra"
    )


def run_chain(chosen: argparse.Namespace, filters: Sequence[SkeletonFilter]) -> None:
    """Read, run, write, draw; the first filter is left out when the input is a volume mesh already."""
    png = getattr(chosen, "png", None)
    write = writer_for(chosen.output)
    if png:
        check_folder(png)
    source = read(chosen.input)
    steps = list(filters[1:] if is_volume_mesh(source) and not chosen.points_only else filters)
    result = run_filters(source, steps)
    write(result)
    if png:
        draw(source, result, png)
    print(summary(chosen, source, result))


def is_volume_mesh(data: vtkPointSet) -> bool:
    """Whether the file brought cells that fill space, to be walked as they are."""
    return isinstance(data, vtkUnstructuredGrid) and any(
        data.GetCell(k).GetCellDimension() == 3 for k in range(min(data.GetNumberOfCells(), 1))
    )


def run_filters(source: vtkPointSet, steps: Sequence[SkeletonFilter]) -> vtkPolyData:
    """Chain the filters behind the source and run them; errors are raised, not printed by VTK."""
    vtkOutputWindow.SetInstance(vtkStringOutputWindow())
    with ProgressLine() as line:
        for step in steps:
            line.watch(step)
        steps[0].SetInputDataObject(0, source)
        for before, after in itertools.pairwise(steps):
            after.SetInputConnection(0, before.GetOutputPort())
        return steps[-1].run()


def summary(chosen: argparse.Namespace, source: vtkPointSet, result: vtkPolyData) -> str:
    """One line about what came in and went out."""
    merged = result.GetFieldData().GetArray("DuplicatesMerged")
    doubles = f" ({merged.GetValue(0):,} merged)" if merged is not None and merged.GetValue(0) else ""
    return (
        f"{chosen.input}: {source.GetNumberOfPoints():,} points{doubles} -> "
        f"{chosen.output}: {result.GetNumberOfPoints():,} nodes, {result.GetNumberOfLines():,} lines"
    )
