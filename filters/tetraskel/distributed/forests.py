"""Rooted ordered trees spread over ranks, and what flows along their edges, level by level."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.distributed.numbering import sums_before

Ints = NDArray[Any]

ARRAYS = (
    "number", "parent", "depth", "son_rank", "son_count", "subtree_size", "tree_id", "parent_rank", "parent_at",
)  # fmt: skip


@dataclass(frozen=True)
class ForestPart:
    """One rank's nodes, in the order of their numbers; see `tetraskel.kernels.forest.Forest` for the numbers' meaning.

    Attributes
    ----------
    number : (k,) int
        Number of each node among all ranks.
    parent : (k,) int
        Number of the parent, -1 for a root.
    depth, son_rank, son_count, subtree_size, tree_id : (k,) int
        As in the serial forest.
    parent_rank, parent_at : (k,) int
        Rank that has the parent, -1 for a root, and its index there.
    n_nodes : int
        On all ranks.
    """

    number: Ints
    parent: Ints
    depth: Ints
    son_rank: Ints
    son_count: Ints
    subtree_size: Ints
    tree_id: Ints
    parent_rank: Ints
    parent_at: Ints
    n_nodes: int

    def __len__(self) -> int:
        return len(self.number)

    def kept(self, comm: Communicator) -> ForestPart:
        """The same, to outlast exchanges."""
        kept = comm.keep(*(getattr(self, name) for name in ARRAYS))
        arrays: dict[str, Any] = dict(zip(ARRAYS, kept, strict=True))
        return replace(self, **arrays)


@dataclass(frozen=True)
class Family:
    """Sons of one level, those here and the parents here: where values pass from one to the other.

    Attributes
    ----------
    sons : (s,) int
        Nodes of this rank on the level.
    parents : (r,) int
        Nodes of this rank that are parents of sons of the level, on any rank; once for each son.
    """

    sons: Ints
    route: Route
    parents: Ints

    def up(self, values: Ints) -> Ints:
        """Values of the sons (s, ...), here, for each of `parents`."""
        return self.route.forward(values)

    def down(self, values: Ints) -> Ints:
        """Values for each of `parents` (r, ...), here, for the sons."""
        return self.route.back(values)


def families_of(comm: Communicator, depth: Ints, parent_rank: Ints, parent_at: Ints) -> list[Family]:
    """The families of all levels below the roots, top first."""
    deepest = int(comm.highest(np.array([depth.max(initial=0)]))[0])
    bounds = np.concatenate([[0], np.cumsum(np.bincount(depth, minlength=deepest + 1))])
    n_roots = int((parent_rank < 0).sum())
    sons_of_ranks = np.bincount(parent_rank + 1, minlength=comm.size + 1)[1:, None]
    n_parents = int(np.concatenate(comm.alltoall(list(sons_of_ranks))).sum())
    order, turned, parents = comm.keep(
        np.argsort(depth, kind="stable").astype(np.int32),
        np.empty(len(depth) - n_roots, np.int32),
        np.empty(n_parents, np.int32),
    )
    families, sent, received = [], 0, 0
    for level in range(1, deepest + 1):
        sons = order[bounds[level] : bounds[level + 1]]
        route = Route(comm, parent_rank[sons])
        above = route.forward(parent_at[sons])
        places = slice(sent, sent + len(sons)), slice(received, received + len(above))
        turned[places[0]], parents[places[1]] = route.order, above  # one place for those of all levels
        route.order = turned[places[0]]
        families.append(Family(sons, route, parents[places[1]]))
        sent, received = places[0].stop, places[1].stop
    return families


def subtree_sizes(comm: Communicator, families: list[Family], n: int, n_nodes: int) -> Ints:
    """(n,) number of nodes from each node down, of `n_nodes` on all ranks."""
    sizes = comm.keep(np.ones(n, index_type(n_nodes)))[0]
    for family in reversed(families):
        np.add.at(sizes, family.parents, family.up(sizes[family.sons]))
    return sizes


def preorder_places(comm: Communicator, forest: ForestPart, families: list[Family]) -> Ints:
    """(k,) place of each node in its tree when a node is followed by its first son's subtree, then the second's."""
    place = comm.keep(np.zeros(len(forest), index_type(forest.n_nodes)))[0]
    for family in families:
        own = np.stack([forest.subtree_size[family.sons], forest.son_rank[family.sons]], axis=1).astype(np.int64)
        sizes, ranks = family.up(own).T
        order = np.lexsort([ranks, family.parents])
        before = _sums_within(family.parents[order], sizes[order])
        steps = np.empty(len(order), np.int64)
        steps[order] = before + 1
        place[family.sons] = family.down(place[family.parents] + steps)
    return place


def _sums_within(groups: Ints, values: Ints) -> Ints:
    """Sum of the values before each one in its group; groups are contiguous."""
    before = np.cumsum(values) - values
    heads = np.flatnonzero(np.diff(groups, prepend=-1))
    return before - np.repeat(before[heads], np.diff(np.append(heads, len(groups))))


@dataclass(frozen=True)
class Nodes:
    """Nodes of a forest before they are numbered.

    Attributes
    ----------
    depth, tree_id, parent_rank, parent_at : (k,) int
        See `ForestPart`.
    order : (k,) int
        Sons of one parent are in the order of these, roots in that of their trees.
    """

    depth: Ints
    tree_id: Ints
    parent_rank: Ints
    parent_at: Ints
    order: Ints


def numbered(comm: Communicator, nodes: Nodes) -> tuple[ForestPart, Ints]:
    """Number nodes tree by tree in the order of a breadth-first walk; also the former index of each."""
    n = len(nodes.depth)
    families = families_of(comm, nodes.depth, nodes.parent_rank, nodes.parent_at)
    son_rank, son_count, number = comm.keep(*(np.zeros(n, np.int64) for _ in range(3)))
    for family in families:
        ranked = np.lexsort([family.up(nodes.order[family.sons]), family.parents])
        places = np.empty(len(ranked), np.int64)
        places[ranked] = _sums_within(family.parents[ranked], np.ones(len(ranked), np.int64))
        son_rank[family.sons] = family.down(places)
        np.add.at(son_count, family.parents, 1)
    roots = np.flatnonzero(nodes.parent_rank < 0)
    trees = np.sort(np.concatenate(comm.allgather(nodes.tree_id[roots].astype(np.int64))))
    number[roots] = np.searchsorted(trees, nodes.tree_id[roots])
    start, stop, front = 0, len(trees), roots
    bases = comm.keep(np.zeros(n, np.int64))[0]
    for family in families:
        front = front[np.argsort(number[front])]
        bases[front], total = sums_before(comm, number[front], son_count[front], start, stop)
        number[family.sons] = stop + family.down(bases[family.parents]) + son_rank[family.sons]
        start, stop, front = stop, stop + total, family.sons
    del bases
    sizes = subtree_sizes(comm, families, n, stop)
    if len(trees) > 1:
        number = tree_by_tree(comm, number, nodes.depth, nodes.tree_id)
    return _in_order(comm, nodes, number, (son_rank, son_count, sizes), stop)


def _in_order(
    comm: Communicator, nodes: Nodes, number: Ints, measures: tuple[Ints, Ints, Ints], n_nodes: int
) -> tuple[ForestPart, Ints]:
    """Sort the nodes by their numbers; parents' indices follow."""
    order = comm.keep(np.argsort(number).astype(np.int32))[0]
    parent, parent_at = parents_in_order(comm, number, (nodes.parent_rank, nodes.parent_at), order)
    rank, count, size = (values[order] for values in measures)
    part = ForestPart(
        number[order], parent, nodes.depth[order], rank, count, size, nodes.tree_id[order],
        nodes.parent_rank[order], parent_at, n_nodes,
    )  # fmt: skip
    return part.kept(comm), order


def parents_in_order(comm: Communicator, number: Ints, parents: tuple[Ints, Ints], order: Ints) -> tuple[Ints, Ints]:
    """Number and index of each node's parent when the nodes of each rank are sorted by their numbers.

    Parameters
    ----------
    number : (k,) int
        Of each node.
    parents : two (k,) int
        Rank and index of each parent before sorting, -1 for a root.
    order : (k,) int
        Indices that sort the numbers.
    """
    index = np.empty(len(order), np.int32)
    index[order] = np.arange(len(order), dtype=np.int32)
    index = comm.keep(index)[0]
    sons = comm.keep(np.flatnonzero(parents[0] >= 0).astype(np.int32))[0]
    route = Route(comm, parents[0][sons])
    above = route.forward(parents[1][sons])
    found = []
    for values in (number, index):
        of_parent = np.full(len(order), -1, values.dtype)
        of_parent[sons] = route.back(values[above])
        found.append(comm.keep(of_parent[order])[0])
    return found[0], found[1]


def tree_by_tree(comm: Communicator, number: Ints, depth: Ints, tree_id: Ints) -> Ints:
    """From numbers level by level over all trees to numbers tree after tree, level by level in each."""
    trees, counts = _nodes_by_tree_and_level(comm, depth, tree_id)
    tree = np.searchsorted(trees, tree_id)
    level_starts = np.cumsum(counts.sum(axis=0)) - counts.sum(axis=0)
    in_level = np.cumsum(counts, axis=0) - counts + level_starts
    in_tree = (np.cumsum(counts.ravel()) - counts.ravel()).reshape(counts.shape)
    return number - in_level[tree, depth] + in_tree[tree, depth]


def _nodes_by_tree_and_level(comm: Communicator, depth: Ints, tree_id: Ints) -> tuple[Ints, Ints]:
    """The trees' ids, and a table (trees, levels) of how many nodes each has on each level."""
    pairs = np.stack([tree_id, depth], axis=1).astype(np.int64)
    own, counts = np.unique(pairs, axis=0, return_counts=True)
    rows = np.concatenate(comm.allgather(np.column_stack([own, counts]).astype(np.int64)))
    trees = np.unique(rows[:, 0])
    table = np.zeros((len(trees), int(rows[:, 1].max(initial=0)) + 1), np.int64)
    np.add.at(table, (np.searchsorted(trees, rows[:, 0]), rows[:, 1]), rows[:, 2])
    return trees, table
