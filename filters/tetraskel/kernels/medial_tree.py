"""The medial tree: from every node the cheapest way to the widest one, and what hangs below each node.

A step costs its length over the fourth power of the strength on the way (burn time, and how well the sides face each
other there): paths run along the ridges of the strength, in a plate along its middle.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.dual_complex import DualComplex
from tetraskel.kernels.heaps import make_heap, pop, push
from tetraskel.kernels.loops_in_python import run_loop

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

SECONDS_PER_NODE = 2e-6
COST_POWER = 4
LEAST_STRENGTH = 1e-9  # of the largest: paths through balls without radius cost much, not infinitely much


@dataclass(frozen=True)
class MedialTree:
    """Shortest paths from the roots, one root per component.

    Attributes
    ----------
    roots : (c,) int
        Strongest node of each component, in the order of the smallest node of each.
    component : (m,) int
        Of each node.
    parent : (m,) int
        Next node on the way to the root, -1 at a root.
    parent_edge : (m,) int
        1-cell to the parent, -1 at a root.
    sequence : (m,) int
        Nodes in the order in which they were reached; parents come first.
    cost : (m,) float
        Of the way to the root.
    """

    roots: Ints
    component: Ints
    parent: Ints
    parent_edge: Ints
    sequence: Ints
    cost: Floats


def medial_tree(cells: DualComplex, positions: Floats, strength: Floats, cut: Bools, tick: Tick = silent) -> MedialTree:
    """Cheapest paths in the dual graph.

    Parameters
    ----------
    positions : (m, d) float
    strength : (m,) float
        Positive; what a path likes.
    cut : (f,) bool
        1-cells that are no way.
    """
    start, ways, edge_of_way = _ways(cells, cut)
    step = _step_costs(cells, positions, strength)
    m = cells.n_nodes
    by_strength = np.argsort(-strength, kind="stable")
    parent, parent_edge, component = (np.full(m, -1, np.int32) for _ in range(3))
    sequence, cost = np.empty(m, np.int32), np.full(m, np.inf)
    run_loop(
        _paths_loop,
        (start, ways, edge_of_way, step, by_strength),
        (parent, parent_edge, sequence, component, cost, np.zeros(m, bool)),
        tick,
        SECONDS_PER_NODE * m,
    )
    roots = np.flatnonzero(parent < 0)
    roots = roots[np.argsort(component[roots])]
    return _renumbered(MedialTree(roots, component, parent, parent_edge, sequence, cost))


def _renumbered(tree: MedialTree) -> MedialTree:
    """Components in the order of their smallest nodes."""
    _, first = np.unique(tree.component, return_index=True)
    order = np.argsort(first)
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    return MedialTree(
        tree.roots[order], number[tree.component], tree.parent, tree.parent_edge, tree.sequence, tree.cost
    )


def _ways(cells: DualComplex, cut: Bools) -> tuple[Ints, Ints, Ints]:
    """Rows: where the ways out of each node begin; the node each leads to; the 1-cell it takes."""
    edges = np.flatnonzero(~cut)
    ends = cells.facets[edges]
    source = ends.ravel()
    order = np.argsort(source, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(source, minlength=cells.n_nodes))])
    return start, ends[:, ::-1].ravel()[order], edges.astype(np.int32)[order >> 1]


def _step_costs(cells: DualComplex, positions: Floats, strength: Floats) -> Floats:
    first, second = cells.facets.T
    length = np.sqrt(((positions[first] - positions[second]) ** 2).sum(axis=1))
    weakest = LEAST_STRENGTH * float(strength.max(initial=0.0)) or 1.0
    return length / np.maximum(0.5 * (strength[first] + strength[second]), weakest) ** COST_POWER


def _paths_loop(  # type: ignore[no-untyped-def]
    start, ways, edge_of_way, step, by_strength, parent, parent_edge, sequence, component, cost, done
):
    """Dijkstra's algorithm from the strongest node of each component; ties go to the smaller node."""
    n_done, n_components = 0, 0
    costs, nodes = make_heap(len(ways) + 1, 0.0)
    for root in by_strength:
        if done[root]:
            continue
        cost[root] = 0.0
        push(costs, nodes, 0, 0.0, root)
        n_waiting = 1
        while n_waiting > 0:
            reached, node = pop(costs, nodes, n_waiting)
            n_waiting -= 1
            if done[node]:
                continue
            done[node] = True
            component[node] = n_components
            sequence[n_done] = node
            n_done += 1
            for k in range(start[node], start[node + 1]):
                other = ways[k]
                total = reached + step[edge_of_way[k]]
                if total < cost[other]:
                    cost[other] = total
                    parent[other] = node
                    parent_edge[other] = edge_of_way[k]
                    push(costs, nodes, n_waiting, total, other)
                    n_waiting += 1
        n_components += 1


def crossed_along(tree: MedialTree, crossings: NDArray[np.int64], tick: Tick = silent) -> NDArray[np.int64]:
    """(m, w) sums modulo 2 of the 1-cells' crossings (f, w) on the way from the root to each node."""
    result = np.zeros((len(tree.parent), crossings.shape[1]), np.int64)
    for word in range(crossings.shape[1]):
        values = np.zeros(len(tree.parent), np.int64)
        inputs = (tree.sequence, tree.parent, tree.parent_edge, np.ascontiguousarray(crossings[:, word]))
        run_loop(_crossed_loop, inputs, (values,), tick)
        result[:, word] = values
    return result


def _crossed_loop(sequence, parent, parent_edge, crossings, values):  # type: ignore[no-untyped-def]
    for node in sequence:
        if parent[node] >= 0:
            values[node] = values[parent[node]] ^ crossings[parent_edge[node]]


def way_up(parent: Ints, node: int, known: Container[int]) -> list[int]:
    """A node and those above it, up to the first that is known; that is the last."""
    way = [node]
    while way[-1] not in known:
        way.append(int(parent[way[-1]]))
    return way


def lengths_and_tips(
    sequence: Ints, parent: Ints, positions: Floats, radii: Floats, tick: Tick = silent
) -> tuple[Floats, Floats, Ints]:
    """Length of the way from the root, farthest reach below each node, and the node that reaches it.

    Returns
    -------
    length : (m,) float
    reach : (m,) float
        Largest length + radius among the node and all below it.
    tip : (m,) int
        The node that has it; the first in order when several do.
    """
    step = np.zeros(len(parent))
    sons = np.flatnonzero(parent >= 0)
    step[sons] = np.sqrt(((positions[sons] - positions[parent[sons]]) ** 2).sum(axis=1))
    length, reach, tip = np.zeros(len(parent)), np.zeros(len(parent)), np.arange(len(parent))
    run_loop(_reach_loop, (sequence, parent, step, radii), (length, reach, tip), tick, 1e-7 * len(parent))
    return length, reach, tip


def _reach_loop(sequence, parent, step, radii, length, reach, tip):  # type: ignore[no-untyped-def]
    n = len(sequence)
    for i in range(n):
        node = sequence[i]
        if parent[node] >= 0:
            length[node] = length[parent[node]] + step[node]
        reach[node] = length[node] + radii[node]
    for i in range(n - 1, -1, -1):
        node = sequence[i]
        above = parent[node]
        if above >= 0 and reach[node] > reach[above]:
            reach[above] = reach[node]
            tip[above] = tip[node]
