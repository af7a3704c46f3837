"""Collapse of the dual complex onto a graph with the same loops.

An elementary collapse takes away a cell together with a face that belongs to no other cell, and leaves the homotopy
type as it was (Whitehead 1939). Here 3-cells go first, each through one ridge, then 2-cells through free 1-cells,
the narrowest passage first, so that what is left runs where the object is wide.
"""

from __future__ import annotations

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

SECONDS_PER_FACET = 1e-6  # compiled; for the progress bar only


@dataclass(frozen=True)
class Collapse:
    """What was taken away, in order, and what is left.

    Attributes
    ----------
    kept : (f,) bool
        1-cells of the graph that is left.
    facets, ridges : (k,) int
        1-cell and 2-cell of each collapse, in order.
    n_punctures : int
        2-cells taken away although they had no free face: one per cavity, since a closed sheet has no border.
    """

    kept: Bools
    facets: Ints
    ridges: Ints
    n_punctures: int


def collapse_to_graph(cells: DualComplex, widths: Floats, tick: Tick = silent) -> Collapse:
    """Collapse everything above dimension 1.

    Parameters
    ----------
    cells : DualComplex
    widths : (f,) float
        Passage width of each 1-cell.
    """
    ridge_alive = np.ones(cells.n_ridges, np.int8)
    ridge_alive[_ridges_below_inner_points(cells)] = 0
    order = np.argsort(widths, kind="stable")
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    facet_alive = np.ones(len(rank), np.int8)
    facets, ridges = np.empty(cells.n_ridges, np.int32), np.empty(cells.n_ridges, np.int32)
    around = np.zeros(len(rank), np.int8)
    counts = np.zeros(2, np.int64)
    run_loop(
        _collapse_loop,
        (rank, order, cells.ring_start, cells.ring_facets, cells.facet_ridges.ravel(), cells.facet_ridges.shape[1]),
        (ridge_alive, facet_alive, facets, ridges, counts, around),
        tick,
        SECONDS_PER_FACET * len(rank),
    )
    return Collapse(facet_alive.astype(bool), facets[: counts[0]], ridges[: counts[0]], int(counts[1]))


def _ridges_below_inner_points(cells: DualComplex) -> Ints:
    """The 2-cell through which each 3-cell collapses: towards its parent in a breadth-first forest from outside."""
    if len(cells.inner_points) == 0:
        return np.empty(0, np.int64)
    outside = len(cells.inner_points)
    number = np.full(max(int(cells.ridge_points.max(initial=0)), int(cells.inner_points[-1])) + 1, outside)
    number[cells.inner_points] = np.arange(outside)
    ends = number[cells.ridge_points]
    useful = np.flatnonzero(ends[:, 0] != ends[:, 1])
    key = np.sort(ends[useful], axis=1) @ np.array([outside + 1, 1])
    keys, first = np.unique(key, return_index=True)
    low, high = np.divmod(keys, outside + 1)
    shape = (outside + 1, outside + 1)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order

    graph = coo_array((np.ones(len(keys)), (low, high)), shape=shape).tocsr()
    sequence, parent = breadth_first_order(graph, outside, directed=False)
    sons = sequence[1:]
    pair = np.sort(np.stack([sons, parent[sons]], axis=1), axis=1) @ np.array([outside + 1, 1])
    return useful[first[np.searchsorted(keys, pair)]]


def _collapse_loop(  # type: ignore[no-untyped-def]
    rank,
    facet_at,
    ring_start,
    ring_facets,
    facet_ridges,
    per_facet,
    ridge_alive,
    facet_alive,
    facets,
    ridges,
    counts,
    around,
):
    """Collapse 2-cells through free 1-cells, smallest rank first; puncture where nothing is free."""
    n_facets, n_free = len(rank), 0
    free, of_rank = make_heap(n_facets, 1)
    for f in range(n_facets):
        for k in range(f * per_facet, f * per_facet + per_facet):
            r = facet_ridges[k]
            if r >= 0 and ridge_alive[r]:
                around[f] += 1
        if around[f] == 1:
            push(free, of_rank, n_free, rank[f], f)
            n_free += 1
    done, punctures, narrowest = 0, 0, 0
    while True:
        facet = -1
        if n_free > 0:
            _, facet = pop(free, of_rank, n_free)
            n_free -= 1
            if around[facet] != 1:
                continue
        else:
            while narrowest < n_facets and around[facet_at[narrowest]] == 0:
                narrowest += 1
            if narrowest == n_facets:
                break
        where = facet if facet >= 0 else facet_at[narrowest]
        gone = -1
        for k in range(where * per_facet, where * per_facet + per_facet):
            r = facet_ridges[k]
            if gone < 0 and r >= 0 and ridge_alive[r]:
                gone = r
        ridge_alive[gone] = 0
        if facet >= 0:
            facet_alive[facet] = 0
            facets[done] = facet
            ridges[done] = gone
            done += 1
        else:
            punctures += 1
        for k in range(ring_start[gone], ring_start[gone + 1]):
            f = ring_facets[k]
            around[f] -= 1
            if around[f] == 1:
                push(free, of_rank, n_free, rank[f], f)
                n_free += 1
    counts[0] = done
    counts[1] = punctures
