"""The skeleton a tree draws: its nodes without the leaves, cut into branches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.centres import centres
from tetraskel.kernels.forest import Forest
from tetraskel.kernels.tree import Tree, expect_tree
from tetraskel.options import SkeletonOptions, TreeOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

END, REGULAR, JUNCTION = 0, 1, 2


@dataclass(frozen=True)
class TreeSkeleton:
    """Nodes of a tree drawn as branches.

    Attributes
    ----------
    points : (n, e) float
        Where the nodes lie.
    node : (n,) int
        Number of each in the tree.
    parent : (n,) int
        Index of the parent in this skeleton, -1 for a root.
    degree : (n,) int
        Number of lines that meet.
    node_type : (n,) int
        0 end, 1 regular, 2 junction.
    branch_offsets : (b+1,) int
        Branch k is `branch_nodes[branch_offsets[k]:branch_offsets[k+1]]`.
    branch_nodes : (...) int
        Indices of the points along each branch, from the root outwards; branches share their junctions.
    branch_id : (n,) int
        Branch of each point; a junction has that of the branch that leads to it, a root -1.
    """

    points: Floats
    node: Ints
    parent: Ints
    degree: Ints
    node_type: Ints
    branch_offsets: Ints
    branch_nodes: Ints
    branch_id: Ints

    @property
    def branch_lengths(self) -> Floats:
        """(b,) length of each branch, in the length unit."""
        return lengths_along(self.points[self.branch_nodes], self.branch_offsets)


def lengths_along(path: Floats, offsets: Ints) -> Floats:
    """(b,) length of each of the polylines `path[offsets[k]:offsets[k+1]]`, in the length unit."""
    if len(path) == 0:
        return np.empty(0)
    steps = np.append(np.sqrt(((path[1:] - path[:-1]) ** 2).sum(axis=1)), 0.0)
    steps[offsets[1:] - 1] = 0.0  # from the end of one polyline to the beginning of the next
    return np.add.reduceat(steps, offsets[:-1])


def assemble_skeleton(
    tree: Tree, *, centre: str = TreeOptions.centre, keep_leaves: bool = SkeletonOptions.keep_leaves
) -> TreeSkeleton:
    """The skeleton of a tree: nodes at a centre of their simplices, without the nodes that have no sons.

    Parameters
    ----------
    centre : {"barycentre", "incentre", "circumcentre"}
        See `tetraskel.kernels.centres.centres`.
    keep_leaves : bool
        Keep the nodes without sons. A root always stays.
    """
    expect_tree(tree)
    return skeleton_of(tree.forest, centres(tree.mesh, centre)[tree.cell], keep_leaves=keep_leaves)


def skeleton_of(forest: Forest, points: Floats, *, keep_leaves: bool = SkeletonOptions.keep_leaves) -> TreeSkeleton:
    """The skeleton of a forest whose nodes lie at `points` (n, e)."""
    node = np.flatnonzero((forest.son_count > 0) | (forest.parent < 0) | keep_leaves)
    index = np.full(len(forest) + 1, -1, np.int64)
    index[node] = np.arange(len(node))
    parent = index[forest.parent[node]]
    sons = np.bincount(parent[parent >= 0], minlength=len(node))
    degree = sons + (parent >= 0)
    node_type = np.clip(degree - 1, END, JUNCTION)
    branch_id = _branch_ids(parent, sons)
    offsets, nodes = _branches(parent, branch_id, forest.depth[node])
    return TreeSkeleton(points[node], node, parent, degree, node_type, offsets, nodes, branch_id)


def _branch_ids(parent: Ints, sons: Ints) -> Ints:
    """Branch of each node; a branch begins below a root or a junction and is numbered by where it begins.

    Strategy: each node points to its parent unless a branch begins with it; the pointers are doubled until every
    node points to the beginning of its branch.
    """
    n = len(parent)
    is_root = parent < 0
    bounds = is_root | (sons != 1)  # a branch ends here, others begin below
    begins = ~is_root & bounds[parent]
    jump = np.where(begins | is_root, np.arange(n), parent)
    while not np.array_equal(jump, further := jump[jump]):
        jump = further
    number = np.full(n, -1, np.int64)
    number[begins] = np.arange(int(begins.sum()))
    return number[jump]


def _branches(parent: Ints, branch_id: Ints, depth: Ints) -> tuple[Ints, Ints]:
    """Offsets and nodes of the branches, each with the node it begins at in front."""
    members = np.flatnonzero(branch_id >= 0)
    members = members[np.lexsort((depth[members], branch_id[members]))]
    sizes = np.bincount(branch_id[members])
    starts = np.cumsum(sizes) - sizes
    nodes = np.insert(members, starts, parent[members[starts]])
    return np.concatenate([[0], np.cumsum(sizes + 1)]).astype(np.int64), nodes
