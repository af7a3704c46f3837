"""What every skeleton keeps whatever the detail: the root of each component, and its loops with what joins them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.dual_complex import DualComplex
from tetraskel.kernels.loops import CLASSES_AT_ONCE
from tetraskel.kernels.medial_tree import MedialTree, crossed_along

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Core:
    """The part of the skeleton that no detail takes away.

    Attributes
    ----------
    nodes : (k,) int
        All nodes of the core, ascending; at least one per component.
    edges : (e, 2) int
        Pairs of nodes: loops and the paths between them.
    tree : MedialTree
        Rooted on the core.
    """

    nodes: Ints
    edges: Ints
    tree: MedialTree


def loop_core(
    tree: MedialTree, cells: DualComplex, crossings: NDArray[np.int64], cut: Bools, tick: Tick = silent
) -> Core:
    """The shortest independent loops, joined to one another inside each component.

    Each 1-cell that is not in the tree closes a loop through the tree; which of the object's loops it goes round is
    the sum of its crossings. Taken by increasing cost, those independent of the ones before are a shortest basis
    through the root (Erickson and Whittlesey 2005).
    """
    closing = _closing_edges(tree, cells, crossings, cut, tick)
    if len(closing) == 0:
        return Core(np.sort(tree.roots), np.empty((0, 2), np.int64), tree)
    ends = cells.facets[closing].astype(np.int64)
    edges = np.unique(
        np.concatenate([np.sort(ends, axis=1), *(_chain(tree, end) for end in ends.ravel().tolist())]), axis=0
    )
    looped = np.unique(tree.component[ends[:, 0]])
    pruned = _without_stubs(edges)
    for component in looped:
        tree = _rooted_at(tree, component, pruned)
    nodes = np.unique(np.concatenate([tree.roots, pruned.ravel()]))
    return Core(nodes, pruned, tree)


def _closing_edges(tree: MedialTree, cells: DualComplex, crossings: NDArray[np.int64], cut: Bools, tick: Tick) -> Ints:
    if crossings.shape[1] == 0:
        return np.empty(0, np.int64)
    along = crossed_along(tree, crossings, tick)
    first, second = cells.facets.T
    around = along[first] ^ along[second] ^ crossings
    loops = np.flatnonzero((around != 0).any(axis=1) & ~cut)
    loops = loops[np.argsort(tree.cost[first[loops]] + tree.cost[second[loops]], kind="stable")]
    return loops[_independent(around[loops])]


def _independent(vectors: NDArray[np.int64]) -> Ints:
    """Rows (k, w words of 62 bits) that are not sums modulo 2 of rows before them."""
    basis: dict[int, int] = {}  # by highest bit
    chosen = []
    seen: set[int] = set()
    for row, words in enumerate(vectors.tolist()):
        whole = sum(word << (CLASSES_AT_ONCE * i) for i, word in enumerate(words))
        if whole in seen:
            continue
        seen.add(whole)
        while whole and whole.bit_length() in basis:
            whole ^= basis[whole.bit_length()]
        if whole:
            basis[whole.bit_length()] = whole
            chosen.append(row)
    return np.array(chosen, dtype=np.int64)


def _chain(tree: MedialTree, node: int) -> Ints:
    """(k, 2) edges from a node to its root, smaller node first."""
    path = path_up(tree.parent, node)
    return np.sort(np.stack([path[:-1], path[1:]], axis=1), axis=1)


def path_up(parent: Ints, node: int) -> Ints:
    """Nodes from `node` to its root."""
    path = [int(node)]
    while parent[path[-1]] >= 0:
        path.append(int(parent[path[-1]]))
    return np.array(path)


def _without_stubs(edges: Ints) -> Ints:
    """Edges of loops and of paths between loops: no node of degree one is left."""
    while True:
        nodes, place = np.unique(edges, return_inverse=True)
        degree = np.bincount(place.ravel(), minlength=len(nodes))
        loose = (degree[place.reshape(edges.shape)] == 1).any(axis=1)
        if not loose.any():
            return edges
        edges = edges[~loose]


def _rooted_at(tree: MedialTree, component: int, core: Ints) -> MedialTree:
    """The same paths with the root of `component` moved to the nearest node of the core along them."""
    on_core = np.zeros(len(tree.parent), bool)
    on_core[core] = True
    old = tree.roots[component]
    if on_core[old]:
        return tree
    mine = tree.sequence[(tree.component[tree.sequence] == component) & on_core[tree.sequence]]
    way = path_up(tree.parent, mine[0])  # from the first core node reached to the old root
    parent, parent_edge, roots = tree.parent.copy(), tree.parent_edge.copy(), tree.roots.copy()
    parent[way[1:]], parent_edge[way[1:]] = way[:-1], tree.parent_edge[way[:-1]]
    parent[way[0]], parent_edge[way[0]], roots[component] = -1, -1, way[0]
    others = np.ones(len(parent), bool)
    others[way] = False
    sequence = np.concatenate([way.astype(tree.sequence.dtype), tree.sequence[others[tree.sequence]]])
    return replace(tree, parent=parent, parent_edge=parent_edge, roots=roots, sequence=sequence)
