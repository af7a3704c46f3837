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
Counts = NDArray[np.int32]

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
    def number(self) -> Ints:
        """(n,) each node's own number."""
        return np.arange(len(self))

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
    levels = level_slices(depth)
    if len(levels) > MANY_LEVELS:
        rank, count, size = _measure_node_by_node(parent)
    elif is_sorted(depth):
        rank, count, size = _measure_level_by_level(parent, levels)
    else:
        order = np.argsort(depth, kind="stable")
        number = np.append(np.argsort(order), -1)
        in_levels = _measure_level_by_level(number[parent[order]], levels)
        rank, count, size = (values[number[:-1]] for values in in_levels)
    return Forest(parent, depth, rank, count, size, tree_id)


def is_sorted(values: Ints) -> bool:
    """Whether values never decrease."""
    return bool(np.all(values[1:] >= values[:-1]))


def level_slices(depth: Ints) -> list[slice]:
    """Where each depth lies when nodes are sorted by depth."""
    ends = np.cumsum(np.bincount(depth)) if len(depth) else np.empty(0, int)
    return [slice(int(start), int(end)) for start, end in zip([0, *ends[:-1]], ends, strict=False)]


def _measure_level_by_level(parent: Ints, levels: list[slice]) -> tuple[Counts, Counts, Counts]:
    """Ranks, son counts and sizes of nodes numbered level by level: the sons of one parent are then neighbours."""
    n, n_roots = len(parent), levels[0].stop if levels else 0
    rank, count, size = np.zeros(n, np.int32), np.zeros(n, np.int32), np.ones(n, np.int32)
    new_family = np.flatnonzero(parent[n_roots + 1 :] != parent[n_roots:-1]) + (n_roots + 1)
    first = np.append(np.arange(n_roots, n)[:1], new_family).astype(np.int32)
    families = np.diff(first, append=np.int32(n))
    count[parent[first]] = families
    rank[n_roots:] = np.arange(n_roots, n, dtype=np.int32) - np.repeat(first, families)
    bounds = np.searchsorted(first, [level.start for level in levels[1:]] + [n])
    for k in range(len(levels) - 1, 0, -1):
        firsts = first[bounds[k - 1] : bounds[k]]
        size[parent[firsts]] += np.add.reduceat(size[levels[k]], firsts - levels[k].start)
    return rank, count, size


def _measure_node_by_node(parent: Ints) -> tuple[Counts, Counts, Counts]:
    """The same for nodes in any order that has parents before sons."""
    parents = parent.tolist()
    sizes, counts, ranks = [1] * len(parents), [0] * len(parents), [0] * len(parents)
    for node, above in enumerate(parents):
        if above >= 0:
            ranks[node] = counts[above]
            counts[above] += 1
    for node in range(len(parents) - 1, -1, -1):
        if parents[node] >= 0:
            sizes[parents[node]] += sizes[node]
    return np.array(ranks, np.int32), np.array(counts, np.int32), np.array(sizes, np.int32)


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
    nodes = np.argsort(forest.depth, kind="stable")
    for level in level_slices(forest.depth)[1:]:
        yield nodes[level]
