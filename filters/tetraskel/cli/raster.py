"""A mask, or points or a mesh made into one, to its morphological, thinned or distance skeleton.

An image (.vti) is inside where its point array is not 0. Anything else is made into a mask of the given resolution,
its inside found from the points alone, or as --inside says.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from tetraskel.cli.arguments import add_options, names_of, refuse, values
from tetraskel.options import DelaunayOptions, InteriorOptions, RasterInputOptions

EXAMPLES = (
    (
        "The lines of a mask of 64 grid points along its longest side (needs scikit-image):",
        "raster scan.ply thin.vtp --method thinning --resolution 64",
    ),
    ("The ridge of the distance in an image:", "raster mask.vti ridge.vtp --method distance"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel raster` takes."""
    from tetraskel.cli.chain import add_files, add_inside

    add_files(parser)
    add_options(parser, RasterInputOptions)
    add_inside(parser)
    parser.set_defaults(inside="gates")
    add_options(parser, DelaunayOptions)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the skeleton."""
    from tetraskel.cli.chain import finish, interior_cells, prepared, run_chain, run_filters
    from tetraskel.cli.files import read_points
    from tetraskel.vtkfilters import DelaunayMesh, RasterSkeleton

    step = RasterSkeleton(**values(chosen, RasterInputOptions))
    if Path(chosen.input).suffix.lower() == ".vti" and not chosen.points_only:
        of_objects = ["resolution", "inside", "boundary", "label_array", *names_of(DelaunayOptions, InteriorOptions)]
        refuse(chosen, of_objects, "points, a mesh or --points-only", "an image in {input}")
        write = prepared(chosen)
        source = read_points(chosen.input, images=True)
        finish(chosen, source, run_filters(source, [step]), write, from_cells=False)
        return
    refuse(chosen, ["mask_array"], "an image (.vti)", "{input}")
    mesh = DelaunayMesh(**values(chosen, DelaunayOptions))
    run_chain(chosen, [mesh, *interior_cells(chosen, extract=False), step])
