"""Points or a mesh to the skeleton of their tree.

The paper's chain: triangulate, walk the simplices as a tree, remove flat simplices, leave out the leaves, and write a
polyline per branch.
"""

from __future__ import annotations

import argparse

from tetraskel.cli.arguments import add_options, values
from tetraskel.options import DelaunayOptions, FlatOptions, SkeletonOptions, TreeOptions


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `tetraskel skeleton` takes."""
    from tetraskel.cli.chain import add_files, add_inside

    add_files(parser)
    add_inside(parser)
    add_options(parser, DelaunayOptions, TreeOptions, FlatOptions, SkeletonOptions)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the skeleton."""
    from tetraskel.cli.chain import interior_cells, run_chain
    from tetraskel.vtkfilters import DelaunayMesh, FlatTetraRemoval, SkeletonOutput, TreeBuilder

    mesh = DelaunayMesh(**values(chosen, DelaunayOptions))
    tree = TreeBuilder(**values(chosen, TreeOptions))
    flat = FlatTetraRemoval(**values(chosen, FlatOptions))
    drawn = SkeletonOutput(**values(chosen, SkeletonOptions))
    run_chain(chosen, [mesh, *interior_cells(chosen), tree, flat, drawn])
