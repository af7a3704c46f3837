"""From the tree back to the triangulation: the other half of the paper's bijection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.tree import Tree

Ints = NDArray[np.integer]


def decode_tree(tree: Tree) -> Triangulation:
    """Rebuild every simplex from the tree's entry facets and apexes, and from them the neighbours.

    Only the points, the traversal order and, per node, simplex number, entry facet and apex are used.

    Returns
    -------
    Triangulation
        The simplices of the mesh the tree was built from, in its order.

    Raises
    ------
    InputError
        For a tree from which nodes were removed: its simplices are no longer all there.
    """
    n = len(tree)
    if n and (tree.cell.max() >= n or len(np.unique(tree.cell)) < n):
        raise InputError("expected a whole tree, got one from which flat nodes were removed; decode it before removal.")
    simplices = decode_simplices(tree.entry_facet, tree.apex, tree.entry, tree.cell)
    return replace(
        triangulation_of(tree.mesh.points, simplices),
        original_ids=tree.mesh.original_ids,
        point_map=tree.mesh.point_map,
        engine=tree.mesh.engine,
    )


def decode_simplices(entry_facet: Ints, apex: Ints, entry: Ints, cell: Ints) -> Ints:
    """(n, d+1) simplices: each entry facet (n, d) with its apex (n,) put back in place `entry`, in order of `cell`."""
    n, dim = entry_facet.shape
    simplices = np.empty((n, dim + 1), np.int32)
    columns = np.arange(dim + 1)[None, :]
    rows = np.empty_like(simplices)
    rows[columns == entry[:, None]] = apex
    rows[columns != entry[:, None]] = entry_facet.ravel()
    simplices[cell] = rows
    return simplices
