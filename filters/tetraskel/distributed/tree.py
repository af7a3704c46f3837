"""The tree of a triangulation spread over ranks: the serial one, each rank with the nodes of its simplices.

Level by level, every rank offers the simplices ahead of its nodes to those who own them, with the place of the offer
in the serial queue; the owner takes the first offer for each. The sons of a level are then numbered by sums along the
level (`numbering`), so that the places of the next offers are those of the serial queue, too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.distributed.forests import ForestPart, families_of, parents_in_order, subtree_sizes, tree_by_tree
from tetraskel.distributed.numbering import sums_before
from tetraskel.distributed.parts import MeshPart
from tetraskel.distributed.roots import joined_pieces, root_facets
from tetraskel.errors import MeshError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.node_arrays import Arrays, simplex_arrays
from tetraskel.kernels.sons import CROSSINGS, crossing_codes
from tetraskel.kernels.tree import Tree

Ints = NDArray[Any]


@dataclass(frozen=True)
class TreePart:
    """One rank's nodes of the tree.

    Attributes
    ----------
    forest : ForestPart
    cell : (k,) int
        Own simplex of each node.
    entry : (k,) int
        Local index of the vertex opposite the entry facet.
    part : MeshPart
    """

    forest: ForestPart
    cell: Ints
    entry: Ints
    part: MeshPart


def build_tree_part(comm: Communicator, part: MeshPart, tick: Tick = silent) -> TreePart:
    """The breadth-first tree of the triangulation of all ranks.

    Raises
    ------
    MeshError
        For a piece without border.
    """
    codes = comm.keep(crossing_codes(part.mesh, tick))[0]
    walk = _Walk(comm, part, codes)
    walk.run(root_facets(comm, part, np.zeros(len(part), np.int32)), tick)
    if walk.n_nodes < part.n_cells:
        del walk
        roots = root_facets(comm, part, joined_pieces(comm, part))
        walk = _Walk(comm, part, codes)
        walk.run(roots, tick)
    if walk.n_nodes < part.n_cells:
        closed = part.n_cells - walk.n_nodes
        raise MeshError(f"expected pieces with a border, got {closed} simplices without one; remove doubled cells.")
    del codes
    return walk.result()


def simplex_arrays_of_part(tree: TreePart, tick: Tick = silent) -> Arrays:
    """What the simplices of one rank say of its nodes, with the ids that simplices and points have on all ranks."""
    ids = tree.part.point_ids.astype(np.int64)
    walked = Tree(tree.forest, tree.cell, tree.entry, tree.part.mesh, "breadth")  # type: ignore[arg-type]
    named = {"CellId": tree.part.cell_ids[tree.cell].astype(np.int64), "ApexId": ids[walked.apex]}
    return {**simplex_arrays(walked, tick), **named, "EntryFacet": ids[walked.entry_facet]}


class _Walk:
    """The walk so far: what each simplex of this rank became."""

    def __init__(self, comm: Communicator, part: MeshPart, codes: NDArray[np.uint8]) -> None:
        m, self.width = part.mesh.simplices.shape
        self.comm, self.part, self.codes = comm, part, codes
        self.crossings = CROSSINGS[self.width - 1].reshape(-1, self.width - 1).astype(np.intp)
        none = np.full(m, -1, np.int32)
        depth, sons, entry = np.zeros(m, np.int32), np.zeros(m, np.int8), np.zeros(m, np.uint8)
        self.number, self.parent_at, self.parent_rank, self.depth, self.tree, self.claim = comm.keep(
            none.astype(index_type(part.n_cells)), none, none.copy(), depth, depth.copy(), none.copy()
        )
        self.entry, self.son_rank, self.son_count = comm.keep(entry, sons, sons.copy())
        self.n_nodes = self.n_trees = 0

    def run(self, roots: tuple[Ints, Ints, Ints, int], tick: Tick) -> None:
        """Walk from root facets: own cells, their entries and trees, and how many trees there are on all ranks."""
        front, entries, trees, self.n_trees = roots
        self.number[front], self.entry[front], self.tree[front] = trees, entries, trees
        start, stop, depth = 0, self.n_trees, 0
        while stop > start:
            depth += 1
            front, total = self._next_level(front, start, stop)
            self.depth[front] = depth
            start, stop = stop, stop + total
            tick(stop / max(self.part.n_cells, 1))
        self.n_nodes = stop

    def _next_level(self, front: Ints, start: int, stop: int) -> tuple[Ints, int]:
        """The nodes of this rank below the front of all ranks, in order, and how many there are on all ranks."""
        dim = self.width - 1
        opposite = self.crossings[self.codes[front].astype(np.intp) * self.width + self.entry[front]]
        halves = front[:, None] * self.width + opposite  # (f, d) facets ahead
        ahead = self.part.across(halves)
        queue = self.number[front].astype(np.int64)[:, None] * dim + np.arange(dim)  # places of the offers
        here = np.nonzero((ahead >= 0) & (ahead < len(self.part)))
        here = tuple(index[self.number[ahead[here]] < 0] for index in here)
        away = np.nonzero(ahead >= len(self.part))
        link = ahead[away] - len(self.part)
        route = Route(self.comm, self.part.ranks[link])
        offers = route.forward(np.stack([self.part.mates[link], queue[away]], axis=1))
        targets = np.concatenate([ahead[here], offers[:, 0] // self.width])
        taken = self._first_offers(targets, np.concatenate([queue[here], offers[:, 1]]))
        won = np.zeros(len(targets), bool)
        won[taken] = True
        sons = np.zeros(ahead.shape, bool)
        sons[here] = won[: len(here[0])]
        sons[away] = route.back(won[len(here[0]) :])
        numbers, ranks, total = self._numbers_of_sons(front, sons, start, stop)
        self._take_own(front, halves, here, (sons, numbers, ranks))
        self._take_others(offers[won[len(here[0]) :], 0], front, away, (sons, numbers, ranks))
        return targets[taken], total

    def _first_offers(self, targets: Ints, queue: Ints) -> Ints:
        """Indices of the offers that are the first for a simplex without a node, in the order of the queue."""
        order = np.argsort(queue)
        order = order[self.number[targets[order]] < 0]
        wanted = targets[order]
        place = np.arange(len(order))
        self.claim[wanted[::-1]] = place[::-1]
        return order[self.claim[wanted] == place]

    def _numbers_of_sons(self, front: Ints, sons: NDArray[np.bool_], start: int, stop: int) -> tuple[Ints, Ints, int]:
        counts = sons.sum(axis=1)
        self.son_count[front] = counts
        bases, total = sums_before(self.comm, self.number[front], counts, start, stop)
        ranks: Ints = np.cumsum(sons, axis=1) - sons
        return stop + bases[:, None] + ranks, ranks, total

    def _take_own(self, front: Ints, halves: Ints, here: tuple, found: tuple[Ints, Ints, Ints]) -> None:
        sons, numbers, ranks = found
        taken = tuple(index[sons[here]] for index in here)
        cells = np.take(self.part.mesh.neighbors, halves[taken])
        above = front[taken[0]]
        self.entry[cells] = (self.part.mesh.neighbors[cells] == above[:, None]).argmax(axis=1)
        self.number[cells], self.son_rank[cells] = numbers[taken], ranks[taken]
        self.tree[cells] = self.tree[above]
        self.parent_rank[cells], self.parent_at[cells] = self.comm.rank, above

    def _take_others(self, halves: Ints, front: Ints, away: tuple, found: tuple[Ints, Ints, Ints]) -> None:
        """Tell others the numbers of their new nodes; `halves` are the facets through which nodes were made here."""
        sons, numbers, ranks = found
        taken = tuple(index[sons[away]] for index in away)
        above = front[taken[0]]
        link = np.searchsorted(self.part.halves, above * self.width + self._opposite(front, taken))
        route = Route(self.comm, self.part.ranks[link])
        number, rank, tree = route.forward(np.stack([numbers[taken], ranks[taken], self.tree[above]], axis=1)).T
        cells, self_link = halves // self.width, np.searchsorted(self.part.halves, halves)
        self.entry[cells] = halves % self.width
        self.number[cells], self.son_rank[cells], self.tree[cells] = number, rank, tree
        self.parent_rank[cells] = self.part.ranks[self_link]
        self.parent_at[cells] = self.part.mates[self_link] // self.width

    def _opposite(self, front: Ints, taken: tuple) -> Ints:
        cells = front[taken[0]]
        return self.crossings[self.codes[cells].astype(np.intp) * self.width + self.entry[cells], taken[1]]

    def result(self) -> TreePart:
        """The finished tree, nodes in the order of their numbers."""
        number = self.number
        if self.n_trees > 1:
            number = tree_by_tree(self.comm, number, self.depth, self.tree)
        order = self.comm.keep(np.argsort(number).astype(np.int32))[0]
        parent, parent_at = parents_in_order(self.comm, number, (self.parent_rank, self.parent_at), order)
        forest = ForestPart(
            number[order], parent, self.depth[order], self.son_rank[order], self.son_count[order],
            np.empty(0, np.int32), self.tree[order], self.parent_rank[order], parent_at, self.n_nodes,
        ).kept(self.comm)  # fmt: skip
        entry, mesh_part = self.comm.keep(self.entry[order])[0], self.part
        families = families_of(self.comm, forest.depth, forest.parent_rank, forest.parent_at)
        sizes = subtree_sizes(self.comm, families, len(forest), forest.n_nodes)
        return TreePart(replace(forest, subtree_size=sizes), order, entry, mesh_part)
