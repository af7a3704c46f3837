"""The skeleton of a tree spread over ranks: each rank draws its nodes, and the lines that lead to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.distributed.copies import Copies, parents_elsewhere
from tetraskel.distributed.forests import ForestPart, families_of
from tetraskel.distributed.numbering import sums_before
from tetraskel.kernels.skeleton import END, JUNCTION
from tetraskel.options import SkeletonOptions

Floats = NDArray[np.float64]
Ints = NDArray[Any]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class SkeletonPart:
    """One rank's nodes of the skeleton; see `tetraskel.kernels.skeleton.TreeSkeleton`.

    Attributes
    ----------
    node : (k,) int
        Index of each in the tree's part.
    index, parent : (k,) int
        Its index in the serial skeleton, and that of its parent, -1 for a root.
    degree, node_type, branch_id : (k,) int
    parent_rank, parent_at : (k,) int
        Rank that has the parent, and its index among that rank's nodes of the skeleton; -1 for a root.
    n_branches : int
        On all ranks.
    """

    node: Ints
    index: Ints
    parent: Ints
    degree: Ints
    node_type: Ints
    branch_id: Ints
    parent_rank: Ints
    parent_at: Ints
    n_branches: int


def skeleton_part(
    comm: Communicator, forest: ForestPart, *, keep_leaves: bool = SkeletonOptions.keep_leaves
) -> SkeletonPart:
    """The skeleton of a forest: its nodes without the leaves, cut into branches."""
    kept = (forest.son_count > 0) | (forest.parent < 0) | keep_leaves
    node, kept = comm.keep(np.flatnonzero(kept).astype(np.int32), kept)
    index, n_nodes = sums_before(comm, forest.number, kept.view(np.int8), 0, forest.n_nodes)
    index = comm.keep(index.astype(index_type(forest.n_nodes)))[0]
    parent, parent_at, begins, degree = _linked(comm, forest, kept, index)
    parent, parent_at, begins, degree, index = comm.keep(
        parent[node], parent_at[node], begins[node], degree[node], index[node]
    )
    number, n_branches = sums_before(comm, index, begins.view(np.int8), 0, n_nodes)
    branch = comm.keep(np.where(begins, number, -1).astype(index_type(n_branches)))[0]
    del number
    depth, parent_rank = comm.keep(forest.depth[node], forest.parent_rank[node])
    for family in families_of(comm, depth, parent_rank, parent_at):
        inherited = family.down(branch[family.parents])
        branch[family.sons] = np.where(begins[family.sons], branch[family.sons], inherited)
    node_type = np.clip(degree - 1, END, JUNCTION).astype(np.uint8)
    node_type = comm.keep(node_type)[0]
    return SkeletonPart(node, index, parent, degree, node_type, branch, parent_rank, parent_at, n_branches)


def _linked(comm: Communicator, forest: ForestPart, kept: Bools, index: Ints) -> tuple[Ints, Ints, Bools, Ints]:
    """Of each node of the tree its parent's skeleton index and row there, whether a branch begins, and its degree."""
    sons, own_index = comm.keep(
        np.flatnonzero(kept & (forest.parent_rank >= 0)).astype(np.int32), np.cumsum(kept, dtype=np.int32) - 1
    )
    route = Route(comm, forest.parent_rank[sons])
    above = route.forward(forest.parent_at[sons])
    n_sons = np.bincount(above, minlength=len(forest)).astype(np.int32)
    is_bound = (forest.parent < 0) | (n_sons != 1)
    found = []
    (degree,) = comm.keep(n_sons + (forest.parent >= 0))
    for values, nothing in ((index, -1), (own_index, -1), (is_bound, False)):
        of_parent = np.full(len(forest), nothing, values.dtype)
        of_parent[sons] = route.back(values[above])
        found.extend(comm.keep(of_parent))
    return found[0], found[1], found[2], degree


@dataclass(frozen=True)
class Lines:
    """The branches of a skeleton as far as one rank has them.

    Attributes
    ----------
    points : (p, e) float
        Where this rank's nodes lie, then those parents that others have.
    ghosts : Copies
        These parents, by their skeleton index.
    offsets, nodes : (l+1,) int, (...) int
        Polylines over the points, each from the parent of its first node on; a branch on several ranks is several.
    branch_id : (l,) int
    lengths : (l,) float
        Of the whole branch, in the length unit; the sum of its pieces.
    """

    points: Floats
    ghosts: Copies
    offsets: Ints
    nodes: Ints
    branch_id: Ints
    lengths: Floats


def lines_of(comm: Communicator, skeleton: SkeletonPart, points: Floats) -> Lines:
    """Draw the skeleton; `points` (k, e) is where its nodes lie."""
    ghosts, parent = parents_elsewhere(comm, skeleton.parent, skeleton.parent_rank, skeleton.parent_at)
    whole = ghosts.with_theirs(comm, points)
    offsets, nodes, branch_id = _polylines(skeleton, parent)
    steps = np.sqrt(((whole[parent[nodes]] - whole[nodes]) ** 2).sum(axis=1))
    own = np.add.reduceat(steps, offsets[:-1]) if len(nodes) else np.empty(0)
    lengths = _lengths_of_branches(comm, branch_id, own, skeleton.n_branches)
    heads = parent[nodes[offsets[:-1]]] if len(nodes) else np.empty(0, np.int64)
    ends = offsets + np.arange(len(offsets))
    return Lines(whole, ghosts, ends, np.insert(nodes, offsets[:-1], heads), branch_id, lengths)


def _polylines(skeleton: SkeletonPart, parent: Ints) -> tuple[Ints, Ints, Ints]:
    """Offsets and nodes, without the parents they begin at, of the stretches of branches; and their branches."""
    drawn = np.flatnonzero(skeleton.branch_id >= 0)
    order = drawn[np.lexsort((skeleton.index[drawn], skeleton.branch_id[drawn]))]
    branch = skeleton.branch_id[order]
    goes_on = np.zeros(len(order), bool)
    goes_on[1:] = (branch[1:] == branch[:-1]) & (parent[order[1:]] == order[:-1])
    starts = np.flatnonzero(~goes_on)
    return np.append(starts, len(order)).astype(np.int64), order.astype(np.int64), branch[starts]


def _lengths_of_branches(comm: Communicator, branch_id: Ints, own: Floats, n_branches: int) -> Floats:
    """(l,) length of the branch that each stretch belongs to."""
    route = Route(comm, branch_id.astype(np.int64) * comm.size // max(n_branches, 1))
    branches = route.forward(branch_id)
    names, number = np.unique(branches, return_inverse=True)
    sums = np.zeros(len(names))
    np.add.at(sums, number.reshape(-1), route.forward(own))
    return route.back(sums[number.reshape(-1)])
