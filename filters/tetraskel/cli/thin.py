"""Points of a surface to fewer of them, as dense as the curve skeleton needs them.

Many are kept where the object or a gap in it is thin, few where it is wide. Where --most-points leaves no room for
as many as --samples-per-radius asks, it is said how many are farther apart; edges may ask for any number. An array
file (.npy) is read a piece at a time, some ten times over, and may be larger than memory.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from tetraskel.cli.arguments import add_drawings, add_input, add_json, add_options, values
from tetraskel.cli.outputs import OutputFile
from tetraskel.options import ThinningOptions

EXAMPLES = (
    ("What is left of a scan that is larger than memory, for its curve skeleton:", "thin scan.npy fewer.vtp"),
    (
        "More points around each limb, but not more than so many in all:",
        "thin scan.ply fewer.vtp --samples-per-radius 12 --most-points 500000",
    ),
)
SUFFIXES = (".vtp", ".vtk", ".csv")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel thin` takes."""
    add_input(parser, "points: .vtp .vtu .vtk .vti .ply .obj .stl .csv .xyz .txt .npy, or - for a table from a pipe")
    parser.add_argument(
        "output", metavar="OUT", type=OutputFile, help=f"the points that are kept: {' '.join(SUFFIXES)}"
    )
    add_drawings(parser)
    add_json(parser)
    add_options(parser, ThinningOptions)


def run(chosen: argparse.Namespace) -> None:
    """Choose the points and write them."""
    from tetraskel.cli.chain import prepared, run_filters, tell_counts, written
    from tetraskel.cli.files import WRITERS, read_points
    from tetraskel.vtkfilters import PointThinning
    from tetraskel.vtkfilters.convert import single_facts

    options = values(chosen, ThinningOptions)
    write = prepared(chosen, {suffix: WRITERS[suffix] for suffix in SUFFIXES})
    if Path(chosen.input).suffix.lower() == ".npy":
        source = result = _thinned_file(chosen.input, options)
    else:
        source = read_points(chosen.input)
        result = run_filters(source, [PointThinning(**options)])
    written(chosen, source, result, write)
    facts = single_facts(result)
    coarse = f", {int(facts['CoarsePoints']):,} of them farther apart than asked" if facts["CoarsePoints"] else ""
    n_input, n_kept = int(facts["InputPoints"]), result.GetNumberOfPoints()
    counts = {"input_points": n_input, "points": n_kept, "lines": 0, "faces": 0}
    text = f"{chosen.input}: {n_input:,} points -> {chosen.output}: {n_kept:,} points{coarse}"
    tell_counts(chosen, counts, facts, text)


def _thinned_file(path: str, options: dict):
    """What is left of an array file, which is never in memory as a whole."""
    from tetraskel.cli.files import expect_file, expect_points
    from tetraskel.cli.tables import open_npy
    from tetraskel.kernels.thinning import thinned
    from tetraskel.vtkfilters.point_thinning import data_of_thinned
    from tetraskel.vtkfilters.progress import ProgressLine

    points = open_npy(expect_file(path))
    expect_points(len(points), path)
    with ProgressLine() as line:
        found = thinned(points, **options, tick=lambda share: line.show("Thinning the points", share))
    return data_of_thinned(points[found.ids], found, len(points))
