"""What the commands share: read, run filters one after another, write, draw, say what was done."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from itertools import pairwise

from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkPointSet, vtkPolyData

from tetraskel.cli.arguments import (
    add_drawings,
    add_input,
    add_json,
    add_options,
    add_points_only,
    names_of,
    refuse,
    values,
)
from tetraskel.cli.drawings import check_drawings, draw_all
from tetraskel.cli.files import read, read_points, writer_for
from tetraskel.cli.outputs import InputFile, OutputFile
from tetraskel.errors import InputError
from tetraskel.options import DelaunayOptions, InteriorCellsOptions, InteriorOptions
from tetraskel.vtkfilters import InteriorCells, SkeletonFilter
from tetraskel.vtkfilters.convert import holds_simplices, single_facts
from tetraskel.vtkfilters.progress import ProgressLine


def add_files(parser: argparse.ArgumentParser) -> None:
    """IN, OUT and what goes with them."""
    add_input(parser, "points: .vtp .vtu .vtk .vti .ply .obj .stl .csv .xyz .txt .npy, or - for a table from a pipe")
    parser.add_argument(
        "output", metavar="OUT", type=OutputFile, help="result: .vtp .vtk .swc .graphml .ply .csv (a row per node)"
    )
    add_drawings(parser)
    add_json(parser)
    add_points_only(parser)


def add_inside(parser: argparse.ArgumentParser) -> None:
    """How inside is told from outside; everything is inside unless asked otherwise."""
    add_options(parser, InteriorOptions)
    parser.set_defaults(inside="all")
    group = parser.add_argument_group("For --inside surface, outline and array")
    group.add_argument(
        "--boundary", metavar="FILE", type=InputFile, help="the closed surface, or the closed lines of the outline"
    )
    group.add_argument(
        "--label-array", metavar="NAME", default=InteriorCellsOptions.label_array, help="cell array, not 0 inside"
    )


def inside_options(chosen: argparse.Namespace) -> dict:
    """The values of the options of inside and outside, checked."""
    if chosen.inside not in ("surface", "outline"):
        refuse(chosen, ["boundary"], "--inside surface or outline", "--inside {inside}")
    if chosen.inside != "array":
        refuse(chosen, ["label_array"], "--inside array", "--inside {inside}")
    return values(chosen, InteriorOptions)


def interior_cells(chosen: argparse.Namespace, *, extract: bool) -> list[SkeletonFilter]:
    """The filter that marks the inside, or keeps it alone; none where everything is inside.

    Most skeletons need the whole mesh: circumcentres of outer simplices may lie inside.
    """
    options = inside_options(chosen)
    if chosen.inside == "all":
        return []
    step = InteriorCells(**options, label_array=chosen.label_array, extract=extract)
    if chosen.inside in ("surface", "outline"):
        if not chosen.boundary:
            raise InputError(f"expected --boundary FILE with --inside {chosen.inside}, got none.")
        boundary = read(chosen.boundary)
        if not isinstance(boundary, vtkPolyData):
            raise InputError(f"expected a surface or lines in {chosen.boundary!r}, got {type(boundary).__name__}.")
        step.SetInputDataObject(1, boundary)
    return [step]


def run_chain(chosen: argparse.Namespace, filters: Sequence[SkeletonFilter]) -> None:
    """Read, run, write, draw; the first filter is left out when the input is a mesh already."""
    write = prepared(chosen)
    source = read_points(chosen.input)
    steps = steps_for(chosen, source, filters)
    finish(chosen, source, run_filters(source, steps), write, from_cells=len(steps) < len(filters))


def steps_for(
    chosen: argparse.Namespace, source: vtkPointSet, filters: Sequence[SkeletonFilter]
) -> Sequence[SkeletonFilter]:
    """The filters without the first one, which triangulates, when the input is a mesh already.

    Raises
    ------
    InputError
        For options of the triangulation then.
    """
    if not holds_simplices(source) or chosen.points_only:
        return filters
    refuse(chosen, names_of(DelaunayOptions), "points or --points-only", "a mesh in {input}")
    return filters[1:]


def prepared(chosen: argparse.Namespace, writers: dict | None = None) -> Callable[[vtkPolyData], None]:
    """What writes the result, after all that can be wrong with the outputs has been looked at.

    `writers` by suffix, where a command has others than most.
    """
    check_drawings(chosen)
    return writer_for(chosen.output, writers)


def written(
    chosen: argparse.Namespace, source: vtkPointSet, result: vtkPolyData, write: Callable[[vtkPolyData], None]
) -> None:
    """Write the result, and draw it where asked."""
    write(result)
    draw_all(chosen, source, result)


def finish(
    chosen: argparse.Namespace,
    source: vtkPointSet,
    result: vtkPolyData,
    write: Callable[[vtkPolyData], None],
    *,
    from_cells: bool,
) -> None:
    """Write, draw, and say what was done."""
    written(chosen, source, result, write)
    tell(chosen, source, result, summary(chosen, source, result, from_cells=from_cells))


def run_filters(source: vtkPointSet, steps: Sequence[SkeletonFilter]) -> vtkPolyData:
    """Chain the filters behind the source and run them; errors are raised, warnings printed in a line each."""
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    with ProgressLine() as line:
        for step in steps:
            line.watch(step)
        steps[0].SetInputDataObject(0, source)
        for before, after in pairwise(steps):
            after.SetInputConnection(0, before.GetOutputPort())
        result = steps[-1].run()
    for message in filter(None, window.GetOutput().splitlines()):
        print(f"warning: {message}", file=sys.stderr)
    return result


def tell(chosen: argparse.Namespace, source: vtkPointSet, result: vtkPolyData, text: str) -> None:
    """Print what was done: the text, or for scripts a line of JSON with the facts in the result's field data."""
    counts = {
        "input_points": source.GetNumberOfPoints(),
        "points": result.GetNumberOfPoints(),
        "lines": result.GetNumberOfLines(),
        "faces": result.GetNumberOfPolys(),
    }
    tell_counts(chosen, counts, single_facts(result), text)


def tell_counts(chosen: argparse.Namespace, counts: dict, facts: dict, text: str) -> None:
    """Print the text, or a line of JSON."""
    if chosen.json:
        print(json.dumps({"input": chosen.input, "output": chosen.output, **counts, "facts": facts}))
    else:
        print(text)


def summary(chosen: argparse.Namespace, source: vtkPointSet, result: vtkPolyData, *, from_cells: bool) -> str:
    """One line about what came in and went out."""
    merged = result.GetFieldData().GetArray("DuplicatesMerged")
    found = [result.GetFieldData().GetArray(name) for name in ("Components", "Loops")]
    loops = ", {} pieces, {} loops".format(*(int(array.GetValue(0)) for array in found)) if all(found) else ""
    sheets = f", {result.GetNumberOfPolys():,} faces" if result.GetNumberOfPolys() else ""
    cells = f", its own {source.GetNumberOfCells():,} cells" if from_cells else ""
    counts = {
        "input_points": source.GetNumberOfPoints(),
        "points": result.GetNumberOfPoints(),
        "lines": result.GetNumberOfLines(),
    }
    return summary_of(chosen, counts, merged.GetValue(0) if merged is not None else 0, (cells, sheets + loops))


def summary_of(chosen: argparse.Namespace, counts: dict, merged: int, more: tuple[str, str] = ("", "")) -> str:
    """One line of these counts, with more to say of what came in and what went out."""
    doubles = f" ({merged:,} merged)" if merged else ""
    return (
        f"{chosen.input}: {counts['input_points']:,} points{doubles}{more[0]} -> "
        f"{chosen.output}: {counts['points']:,} nodes, {counts['lines']:,} lines{more[1]}"
    )
