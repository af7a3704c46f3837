"""Points or a mesh to the tree of their simplices, whole.

Triangulates the points (or takes the tetrahedra of the file), walks the simplices, and writes a node per simplex and
a line from every parent to its sons.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.arguments import add_options, values
from tetraskel.options import DelaunayOptions, TreeOptions

EXAMPLES = (
    ("The tree of all tetrahedra of some points, with a picture:", "tree cloud.csv tree.vtp --png tree.png"),
    ("Of an object's inside only, depth first:", "tree scan.ply tree.vtp --inside gates --traversal depth"),
    ("Points from another program:", "tree - tree.vtp --json < cloud.csv"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel tree` takes."""
    from tetraskel.cli.chain import add_files, add_inside

    add_files(parser)
    add_inside(parser)
    add_options(parser, DelaunayOptions, TreeOptions)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the tree."""
    from tetraskel.cli.chain import interior_cells, run_chain
    from tetraskel.vtkfilters import DelaunayMesh, TreeBuilder

    mesh = DelaunayMesh(**values(chosen, DelaunayOptions))
    run_chain(chosen, [mesh, *interior_cells(chosen, extract=True), TreeBuilder(**values(chosen, TreeOptions))])
