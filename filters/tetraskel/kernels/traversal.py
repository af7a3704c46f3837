"""Walking the simplices: from a root facet, across facet after facet, each simplex once.

Breadth first, nodes are what a first-in-first-out queue would make of them, a level at a time in NumPy; depth
first follows the first son to its end, a node at a time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.sons import CROSSINGS

Ints = NDArray[np.integer]
Entries = NDArray[np.uint8]


@dataclass(frozen=True)
class Walk:
    """The nodes of a walk in the order they were made.

    Attributes
    ----------
    cell : (n,) int
        Simplex of each node.
    entry : (n,) int
        Local index of the vertex opposite the facet the node was entered through.
    parent : (n,) int
        Parent node, -1 for a root.
    depth : (n,) int
        Number of facets crossed since the root.
    """

    cell: Ints
    entry: Entries
    parent: Ints
    depth: Ints


def walk_breadth_first(
    neighbors: Ints, codes: NDArray[np.uint8], root_cells: Ints, root_entries: Entries, tick: Tick = silent
) -> Walk:
    """Every node reached from the roots, all roots at depth 0, level after level.

    Strategy: a level's candidates are the simplices across its facets, in order. Of several candidates for one
    simplex the first must win: claims are written in reverse order, so that the first is what stays, and each
    candidate looks whether the claim is its own.
    """
    n, width = neighbors.shape
    crossings = CROSSINGS[width - 1].reshape(-1, width - 1).astype(np.intp)
    rows = _packed_rows(neighbors)
    free = np.ones(n + 1, bool)
    free[-1] = False  # the outside, neighbour -1
    claim = np.empty(n, np.int32)
    cell, parent, entry = np.empty(n, np.int32), np.full(n, -1, np.int32), np.empty(n, np.uint8)

    front, stop, level_ends = root_cells.astype(np.intp), len(root_cells), [0]
    cell[:stop], entry[:stop], free[front] = front, root_entries, False
    here = neighbors[front]  # (f, d+1) what lies around each simplex of the front
    while len(front):
        start = level_ends[-1]
        keys = np.take(codes, front).astype(np.intp) * width + entry[start:stop]
        opposite = np.take(crossings, keys, axis=0) + np.arange(0, here.size, width)[:, None]
        ahead = np.take(here.ravel(), opposite.ravel()).astype(np.intp)
        candidates = np.flatnonzero(free[ahead])
        targets = np.take(ahead, candidates)
        numbers = np.arange(len(targets), dtype=np.int32)
        claim[targets[::-1]] = numbers[::-1]
        first = np.flatnonzero(np.take(claim, targets) == numbers)
        targets, sources = np.take(targets, first), np.take(candidates, first) // (width - 1)
        level_ends.append(stop)
        start, stop = stop, stop + len(targets)
        free[targets] = False
        cell[start:stop] = targets
        parent[start:stop] = sources + level_ends[-2]
        here = np.take(rows, targets).view(np.int32).reshape(-1, width)
        entry[start:stop] = _entries(here, np.take(front, sources))
        front = targets
        tick(stop / n)
    depth = np.repeat(np.arange(len(level_ends) - 1, dtype=np.int32), np.diff(level_ends))
    return Walk(cell[:stop], entry[:stop], parent[:stop], depth)


def _packed_rows(neighbors: Ints) -> NDArray[np.generic]:
    """The rows of the neighbour array as one item each, so that a row is fetched at once."""
    whole = np.ascontiguousarray(neighbors, np.int32)
    item = np.complex128 if whole.shape[1] == 4 else np.dtype((np.void, 12))
    return whole.view(item).ravel()


def _entries(rows: Ints, parents: Ints) -> Entries:
    """Column of each row that holds the parent's simplex."""
    is_parent = (rows == parents.astype(np.int32)[:, None]).view(np.uint8)
    entry = is_parent[:, 1].copy()
    for column in range(2, rows.shape[1]):
        entry += is_parent[:, column] * np.uint8(column)
    return entry


def walk_depth_first(
    neighbors: Ints, codes: NDArray[np.uint8], root_cells: Ints, root_entries: Entries, tick: Tick = silent
) -> Walk:
    """Every node reached from the roots, root after root, first sons first."""
    crossings = CROSSINGS[neighbors.shape[1] - 1].tolist()
    across, code = neighbors.tolist(), codes.tolist()
    free = [True] * len(across)
    cells: list[int] = []
    entries: list[int] = []
    parents: list[int] = []
    depths: list[int] = []
    for root in zip(root_cells.tolist(), root_entries.tolist(), strict=True):
        stack = [(*root, -1, 0)]
        while stack:
            cell, entry, parent, depth = stack.pop()
            if not free[cell]:
                continue
            free[cell] = False
            node = len(cells)
            for column, value in zip((cells, entries, parents, depths), (cell, entry, parent, depth), strict=True):
                column.append(value)
            for facet in reversed(crossings[code[cell]][entry]):
                ahead = across[cell][facet]
                if ahead >= 0 and free[ahead]:
                    stack.append((ahead, across[ahead].index(cell), node, depth + 1))
            if node % 65536 == 0:
                tick(node / len(across))
    return Walk(
        np.array(cells, np.int32), np.array(entries, np.uint8), np.array(parents, np.int32), np.array(depths, np.int32)
    )
