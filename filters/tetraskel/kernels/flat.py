"""Flat simplices, removed from a tree by contraction.

The paper's definition 5 measures flatness; displaced cospherical points make flat tetrahedra along the sides of an
object, and the tree grows branches there that mean nothing.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.forest import Forest, complete_forest, preorder
from tetraskel.kernels.quality import qualities
from tetraskel.kernels.tree import Tree, expect_tree
from tetraskel.options import FlatOptions

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


def remove_flat(tree: Tree, *, threshold: float = FlatOptions.threshold, tick: Tick = silent) -> Tree:
    """Contract the nodes of flat simplices: those with quality 1/Qk below `threshold`.

    The sons of a flat node move to its nearest kept ancestor, in order, in the flat node's place. A flat root hands its
    place to its first kept descendant, and what else hung from it becomes that node's. Depths, ranks and sizes are
    computed anew, nodes are numbered in the order of the tree's traversal, and `cell` still names the simplex.

    Parameters
    ----------
    tree : Tree
    threshold : float
        In [0, 1], no unit; 0 keeps everything.

    Returns
    -------
    Tree
    """
    expect_tree(tree)
    FlatOptions(threshold=threshold)
    quality = qualities(tree.mesh, tick)
    forest, kept = contract(tree.forest, quality[tree.cell] < threshold, tree.traversal)
    return replace(tree, forest=forest, cell=tree.cell[kept], entry=tree.entry[kept])


def all_flat(n_simplices: int, threshold: float) -> str:
    """What to say to those who would get nothing."""
    return (
        f"expected simplices of quality {threshold:g} or better, got none among {n_simplices}: the points almost lie "
        "in a plane or on a line; lower the threshold."
    )


def contract(forest: Forest, flat: Bools, traversal: str) -> tuple[Forest, Ints]:
    """The forest without the nodes marked `flat`, and the old number of each of its nodes.

    Strategy: contraction in place keeps the preorder of what stays, so the new tree is known from each kept node's
    nearest kept ancestor and its old preorder position; a new root only moves to the front of its tree.
    """
    if not flat.any():
        return forest, np.arange(len(forest))
    place = preorder(forest) if traversal == "breadth" else np.arange(len(forest))
    above = _nearest_kept(forest.parent, flat)
    kept = np.flatnonzero(~flat)
    parent, roots = above[kept], _new_roots(forest, kept, above)
    orphans = (parent < 0) & ~np.isin(kept, roots)
    root_of_tree = np.full(int(forest.tree_id.max(initial=0)) + 1, -1, np.int64)
    root_of_tree[forest.tree_id[roots]] = roots
    parent[orphans] = root_of_tree[forest.tree_id[kept[orphans]]]
    return _renumber(kept, parent, place[kept], forest.tree_id[kept], traversal)


def _nearest_kept(parent: Ints, flat: Bools) -> NDArray[np.int64]:
    """(n,) nearest ancestor that is not flat, -1 for none. Pointers over flat nodes are doubled until they stop."""
    n = len(parent)
    jump = np.append(np.where(flat, parent, np.arange(n)), -1)
    while not np.array_equal(jump, further := jump[jump]):
        jump = further
    return jump[parent]


def _new_roots(forest: Forest, kept: Ints, above: Ints) -> Ints:
    """The first kept node of each tree, in the order of the traversal."""
    orphans = kept[above[kept] < 0]
    return orphans[np.unique(forest.tree_id[orphans], return_index=True)[1]]


def _renumber(kept: Ints, parent: Ints, place: Ints, tree_id: Ints, traversal: str) -> tuple[Forest, Ints]:
    """Number kept nodes tree by tree in the order of the traversal."""
    order = np.lexsort((place, tree_id))
    kept, tree_id = kept[order], tree_id[order]
    parent = _positions(kept, parent[order])
    depth = _depths(parent)
    if traversal == "breadth":
        order = np.lexsort((np.arange(len(kept)), depth, tree_id))
        kept, tree_id, depth = kept[order], tree_id[order], depth[order]
        number = np.append(np.argsort(order), -1)
        parent = number[parent[order]]
    return complete_forest(parent.astype(np.int32), depth, tree_id), kept


def _positions(kept: Ints, wanted: Ints) -> Ints:
    """Index in `kept` of each old node number in `wanted`; -1 stays."""
    where = np.full(int(kept.max(initial=0)) + 2, -1, np.int64)
    where[kept] = np.arange(len(kept))
    return where[wanted]


def _depths(parent: Ints) -> NDArray[np.int32]:
    """(n,) depth of each node, by pointer doubling: ancestors 1, 2, 4, ... levels up."""
    up = np.append(parent, -1)
    depth = np.append((parent >= 0).astype(np.int32), np.int32(0))
    while (up >= 0).any():
        depth, up = depth + depth[up], up[up]
    return depth[:-1]
