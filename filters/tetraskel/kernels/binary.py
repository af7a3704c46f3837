"""A ternary tree as a binary one: first son to the left, next sibling to the right."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.forest import Forest
from tetraskel.kernels.tree import Tree

Ints = NDArray[np.integer]


@dataclass(frozen=True)
class BinaryTree:
    """The same nodes with the same numbers; -1 for none.

    Attributes
    ----------
    left : (n,) int
        First son.
    right : (n,) int
        Next sibling (for the root of a tree, the root of the next tree).
    """

    left: Ints
    right: Ints

    def parents(self) -> Ints:
        """(n,) parents in the tree this one was made from: up the chain of siblings, then to the left one's parent."""
        n = len(self.left)
        origin = np.arange(n + 1)
        origin[self.right[self.right >= 0]] = np.flatnonzero(self.right >= 0)
        while not np.array_equal(origin, further := origin[origin]):
            origin = further
        parent_of_first = np.full(n, -1)
        parent_of_first[self.left[self.left >= 0]] = np.flatnonzero(self.left >= 0)
        return parent_of_first[origin[:n]]


def binarize(tree: Tree | Forest) -> BinaryTree:
    """The binary tree of a tree with any number of sons (Knuth's natural correspondence), node for node."""
    forest = tree.forest if isinstance(tree, Tree) else tree
    n = len(forest)
    left, right = np.full(n, -1, np.int32), np.full(n, -1, np.int32)
    order = np.lexsort((forest.son_rank, forest.parent))
    parent = forest.parent[order]
    siblings = np.flatnonzero(parent[1:] == parent[:-1])
    right[order[siblings]] = order[siblings + 1]
    first = order[(forest.son_rank[order] == 0) & (parent >= 0)]
    left[forest.parent[first]] = first
    return BinaryTree(left, right)
