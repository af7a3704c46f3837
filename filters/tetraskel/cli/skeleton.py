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
    from tetraskel.cli.chain import add_files

    add_files(parser)
    add_options(parser, DelaunayOptions, TreeOptions, FlatOptions, SkeletonOptions)


def run(chosen: argparse.Namespace) -> None:
    """Make and write the skeleton."""
    from tetraskel.cli.chain import run_chain
    from tetraskel.vtkfilters import DelaunayMesh, FlatTetraRemoval, SkeletonOutput, TreeBuilder

    stages = {
        DelaunayMesh: DelaunayOptions,
        TreeBuilder: TreeOptions,
        FlatTetraRemoval: FlatOptions,
        SkeletonOutput: SkeletonOptions,
    }
    run_chain(chosen, [stage(**values(chosen, options)) for stage, options in stages.items()])
