"""From the tree back to the triangulation: the other half of the paper's bijection.

Crossing a facet exchanges one point for another: the simplex of a node is its parent's with the point left behind
replaced by the apex. So root facets, and per node its parent, the point left behind and the apex, are enough.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.forest import level_slices
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.predicates import orientation_signs
from tetraskel.kernels.tree import Tree, expect_tree

Ints = NDArray[np.integer]


@dataclass(frozen=True)
class TreeCode:
    """All that has to be kept of a triangulation, nodes in the order of the traversal.

    Attributes
    ----------
    root_facets : (t, d) int
        Points of the facet each tree begins with.
    parent : (n,) int
        -1 for a root.
    left : (n,) int
        Point of the parent's simplex that the node's simplex does not have; -1 for a root.
    apex : (n,) int
        Point of the node's simplex that the parent's (for a root, its facet) does not have.
    """

    root_facets: Ints
    parent: Ints
    left: Ints
    apex: Ints


def encode_tree(parent: Ints, entry_facet: Ints, apex: Ints) -> TreeCode:
    """The code of a tree from parents (n,), entry facets (n, d) and apexes (n,)."""
    total = entry_facet.sum(axis=1, dtype=np.int64)
    left = np.where(parent >= 0, total[parent] + apex[parent] - total, -1)  # the rest is common to both sums
    return TreeCode(entry_facet[parent < 0], parent, left, apex)


def decode_simplices(code: TreeCode, depth: Ints) -> NDArray[np.int32]:
    """(n, d+1) simplices of the nodes of a code, level by level; vertices in no particular order."""
    width = code.root_facets.shape[1] + 1
    simplices = np.empty((len(code.parent), width), np.int32)
    roots = np.flatnonzero(code.parent < 0)
    simplices[roots, :-1], simplices[roots, -1] = code.root_facets, code.apex[roots]
    order = np.argsort(depth, kind="stable")
    for level in level_slices(depth)[1:]:
        nodes = order[level]
        rows = simplices[code.parent[nodes]]
        simplices[nodes] = np.where(rows == code.left[nodes, None], code.apex[nodes, None], rows)
    return simplices


def decode_tree(tree: Tree) -> Triangulation:
    """Rebuild every simplex from the tree's code, and from the simplices their neighbours.

    Returns
    -------
    Triangulation
        The simplices of the mesh the tree was built from, in its order, vertices in positive order.

    Raises
    ------
    InputError
        For a tree from which nodes were removed: its simplices are no longer all there.
    """
    expect_tree(tree)
    n = len(tree)
    if n and (tree.cell.max() >= n or len(np.unique(tree.cell)) < n):
        raise InputError("expected a whole tree, got one from which flat nodes were removed; decode it before removal.")
    simplices = np.empty((n, tree.mesh.dim + 1), np.int32)
    code = encode_tree(tree.parent, tree.entry_facet, tree.apex)
    simplices[tree.cell] = decode_simplices(code, tree.depth)
    negative = orientation_signs(tree.mesh.coordinates[simplices]) < 0
    simplices[negative, -2:] = simplices[negative, :-3:-1]
    mesh = triangulation_of(tree.mesh.points, simplices) if n else tree.mesh
    return replace(mesh, original_ids=tree.mesh.original_ids, point_map=tree.mesh.point_map, engine=tree.mesh.engine)
