"""Flat simplices removed from a tree spread over ranks; see `tetraskel.kernels.flat` for what that means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.distributed.forests import Family, ForestPart, Nodes, families_of, numbered, preorder_places

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

RANK, INDEX, DEPTH, TOP = range(4)  # what is passed down: the nearest kept node, its new depth, the orphan it is under


def contract_part(comm: Communicator, forest: ForestPart, flat: Bools) -> tuple[ForestPart, Ints]:
    """The forest without this rank's nodes marked `flat`, and the old index of each of this rank's nodes.

    Strategy: what each node hangs from is passed down the levels: the nearest kept node above. Kept nodes without one
    are orphans; the first of each tree becomes its root and takes the others in. Sons keep the order of the old
    preorder.
    """
    if comm.total(int(flat.sum())) == 0:
        return forest, np.arange(len(forest))
    families = families_of(comm, forest.depth, forest.parent_rank, forest.parent_at)
    place = preorder_places(comm, forest, families)
    above = _hung_from(comm, forest, flat, families)
    del families
    roots = _new_roots(comm, forest, ~flat & (above[:, RANK] < 0))
    kept = comm.keep(np.flatnonzero(~flat).astype(np.int32))[0]
    nodes = _kept_nodes(comm, forest, kept, (place, above, roots))
    del place, above
    ranks, indices = comm.keep(nodes.parent_rank, _new_indices(comm, nodes, ~flat))
    part, order = numbered(comm, replace(nodes, parent_rank=ranks, parent_at=indices))
    return part, comm.keep(kept[order])[0]


def _kept_nodes(comm: Communicator, forest: ForestPart, kept: Ints, found: tuple[Ints, Ints, Ints]) -> Nodes:
    """The nodes that stay, with their parents' old indices."""
    place, above, roots = found
    tree = forest.tree_id[kept]
    orphan = (above[kept, RANK] < 0) & (forest.number[kept] != roots[tree, 0])
    parents = np.where(orphan[:, None], roots[tree, 1:], above[kept, :DEPTH]).astype(np.int32)
    depth = (above[kept, DEPTH] + (above[kept, TOP] != roots[tree, 0])).astype(np.int32)
    return Nodes(*comm.keep(depth, tree, parents[:, RANK], parents[:, INDEX], place[kept]))


def _hung_from(comm: Communicator, forest: ForestPart, flat: Bools, families: list[Family]) -> Ints:
    """(k, 4) for each node the nearest kept node above it and what is to be known of that; rank -1 for none."""
    n = len(forest)
    none = np.full((n, 4), -1, index_type(forest.n_nodes))
    above, below = comm.keep(none, none.copy())  # of each node, and what it passes to its sons
    _pass_on(comm, forest, flat, np.flatnonzero(forest.parent_rank < 0), (above, below))
    for family in families:
        above[family.sons] = family.down(below[family.parents])
        _pass_on(comm, forest, flat, family.sons, (above, below))
    return above


def _pass_on(comm: Communicator, forest: ForestPart, flat: Bools, nodes: Ints, found: tuple[Ints, Ints]) -> None:
    above, below = found
    orphans = nodes[above[nodes, RANK] < 0]
    above[orphans, TOP] = forest.number[orphans]
    above[nodes, DEPTH] += 1  # of the node, if it stays
    below[nodes] = above[nodes]
    below[nodes, DEPTH] -= 1
    kept = nodes[~flat[nodes]]
    below[kept, RANK], below[kept, INDEX], below[kept, DEPTH] = comm.rank, kept, above[kept, DEPTH]


def _new_roots(comm: Communicator, forest: ForestPart, orphan: Bools) -> Ints:
    """(trees, 3) number, rank and index of the first orphan of each tree."""
    n_trees = int(comm.highest(np.array([forest.tree_id.max(initial=-1)]))[0]) + 1
    own = np.flatnonzero(orphan)
    own = own[np.unique(forest.tree_id[own], return_index=True)[1]]
    mine = np.stack([forest.tree_id[own], forest.number[own], np.full(len(own), comm.rank), own], axis=1)
    rows = np.concatenate(comm.allgather(mine.astype(np.int64)))
    rows = rows[np.lexsort([rows[:, 1], rows[:, 0]])]
    trees, first = np.unique(rows[:, 0], return_index=True)
    roots = np.full((n_trees, 3), -1, np.int64)
    roots[trees] = rows[first, 1:]
    return roots


def _new_indices(comm: Communicator, nodes: Nodes, kept: Bools) -> Ints:
    """Indices of the parents among the kept nodes of their ranks; -1 stays."""
    index, sons = comm.keep(
        (np.cumsum(kept, dtype=np.int32) - 1), np.flatnonzero(nodes.parent_rank >= 0).astype(np.int32)
    )
    route = Route(comm, nodes.parent_rank[sons])
    back = route.back(index[route.forward(nodes.parent_at[sons])])
    found = np.full(len(nodes.depth), -1, np.int32)
    found[sons] = back
    return found
