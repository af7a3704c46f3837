"""Points or a mesh to a Voronoi skeleton of the object: sk1, sk2, sk3 or sk4.

Finds the object's inside from the points alone (or as --inside says) and draws the Voronoi vertices, edges and, in
space, faces that the method asks for, with radii.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.arguments import add_options, values
from tetraskel.options import DelaunayOptions, VoronoiOptions

EXAMPLES = (
    (
        "The sheets midway between facing sides of an object:",
        "voronoi scan.ply sheets.vtp --method sk4 --least-angle 90",
    ),
    ("The Voronoi vertices inside, as a table:", "voronoi scan.ply vertices.csv --method sk1"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel voronoi` takes."""
    from tetraskel.cli.chain import add_files, add_inside

    add_files(parser)
    add_options(parser, VoronoiOptions)
    add_inside(parser)
    parser.set_defaults(inside="gates")
    add_options(parser, DelaunayOptions)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the skeleton."""
    from tetraskel.cli.chain import interior_cells, run_chain
    from tetraskel.cli.files import check_output
    from tetraskel.vtkfilters import DelaunayMesh, VoronoiSkeleton

    check_output(chosen.output, (".vtp", ".vtk", ".csv"))  # the formats of graphs would lose the faces
    mesh = DelaunayMesh(**values(chosen, DelaunayOptions))
    inside = interior_cells(chosen, extract=False)
    run_chain(chosen, [mesh, *inside, VoronoiSkeleton(**values(chosen, VoronoiOptions))])
