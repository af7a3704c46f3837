"""Rooted ordered trees as arrays: who is whose son, how deep, how many below.

Nodes are numbered tree after tree, inside a tree in the order of the traversal; the sons of a node are in order
of their numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# A forest with more levels than this is a few long paths: a loop over its nodes then beats a loop over levels.
MANY_LEVELS = 20_000


@dataclass(frozen=True)
class Forest:
    """Ordered trees over nodes 0 to n-1.

    Attributes
    ----------
    parent : (n,) int
        Parent node, -1 for a root. Always smaller than the node itself.
    depth : (n,) int
        0 for a root, else one more than the parent's.
    son_rank : (n,) int
        0 for the first son of its parent (and for a root).
    son_count : (n,) int
        Number of sons.
    subtree_size : (n,) int
        Number of nodes from here down, this one included.
    tree_id : (n,) int
        Which tree the node belongs to.
    """

    parent: Ints
    depth: Ints
    son_rank: Ints
    son_count: Ints
    subtree_size: Ints
    tree_id: Ints

    def __len__(self) -> int:
        return len(self.parent)

    @property
    def is_leaf(self) -> Bools:
        """(n,) nodes without sons."""
        return np.asarray(self.son_count == 0)

    @property
    def roots(self) -> Ints:
        """Nodes without parent, in order."""
        return np.flatnonzero(self.parent < 0)


def complete_forest(parent: Ints, depth: Ints, tree_id: Ints) -> Forest:
    """The forest of these parents, depths and tree ids: sons ranked and counted, subtrees measured."""
    count = np.bincount(parent[parent >= 0], minlength=len(parent)).astype(np.uint8)
    rank, size = np.zeros(len(parent), np.uint8), np.ones(len(parent), np.int32)
    levels = level_slices(depth)
    if len(levels) > MANY_LEVELS:
        _measure_node_by_node(parent, rank, size)
    else:
        _measure_level_by_level(parent, by_level(depth), levels, rank, size)
    return Forest(parent, depth, rank, count, size, tree_id)


def level_slices(depth: Ints) -> list[slice]:
    """Where each depth lies in `by_level(depth)`."""
    ends = np.cumsum(np.bincount(depth)) if len(depth) else np.empty(0, int)
    return [slice(int(start), int(end)) for start, end in zip([0, *ends[:-1]], ends, strict=False)]


def by_level(depth: Ints) -> Ints:
    """Node ids by increasing depth, in order of their numbers inside a depth."""
    if np.all(depth[1:] >= depth[:-1]):
        return np.arange(len(depth))
    return np.argsort(depth, kind="stable")


def _measure_level_by_level(
    parent: Ints, nodes: Ints, levels: list[slice], rank: NDArray[np.uint8], size: NDArray[np.int32]
) -> None:
    """Ranks and sizes, deepest level first: in a level the sons of one parent are neighbours."""
    for level in reversed(levels[1:]):
        sons = nodes[level]
        parents = parent[sons]
        first = np.flatnonzero(np.diff(parents, prepend=-1))
        rank[sons] = np.arange(len(sons)) - np.repeat(first, np.diff(first, append=len(sons)))
        size[parents[first]] += np.add.reduceat(size[sons], first)


def _measure_node_by_node(parent: Ints, rank: NDArray[np.uint8], size: NDArray[np.int32]) -> None:
    sizes, seen, parents = size.tolist(), [0] * len(parent), parent.tolist()
    ranks = [0] * len(parent)
    for node, above in enumerate(parents):
        if above >= 0:
            ranks[node] = seen[above]
            seen[above] += 1
    for node in range(len(parents) - 1, -1, -1):
        if parents[node] >= 0:
            sizes[parents[node]] += sizes[node]
    rank[:], size[:] = ranks, sizes


def preorder(forest: Forest) -> NDArray[np.int32]:
    """(n,) position of each node when a node is followed by its first son's whole subtree, then the second's."""
    position = np.zeros(len(forest), np.int32)
    roots = forest.roots
    position[roots] = np.cumsum(forest.subtree_size[roots]) - forest.subtree_size[roots]
    for sons in _levels_below_roots(forest):
        parents = forest.parent[sons]
        first = np.flatnonzero(np.diff(parents, prepend=-1))
        before = np.cumsum(forest.subtree_size[sons]) - forest.subtree_size[sons]
        before -= np.repeat(before[first], np.diff(first, append=len(sons)))
        position[sons] = position[parents] + 1 + before
    return position


def _levels_below_roots(forest: Forest) -> Iterator[Ints]:
    nodes = by_level(forest.depth)
    for level in level_slices(forest.depth)[1:]:
        yield nodes[level]
