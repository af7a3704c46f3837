"""Points or a mesh to the tree of their simplices, whole.

Triangulates the points (or takes the tetrahedra of the file), walks the simplices, and writes a node per simplex and
a line from every parent to its sons.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.arguments import add_options, values
from tetraskel.options import DelaunayOptions, TreeOptions


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel tree` takes."""
    from tetraskel.cli.chain import add_files

    add_files(parser)
    add_options(parser, DelaunayOptions, TreeOptions)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the tree."""
    from tetraskel.cli.chain import run_chain
    from tetraskel.vtkfilters import DelaunayMesh, TreeBuilder

    run_chain(chosen, [DelaunayMesh(**values(chosen, DelaunayOptions)), TreeBuilder(**values(chosen, TreeOptions))])
