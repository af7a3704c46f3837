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

from tetraskel.distributed.communicator import Communicator, Route
from tetraskel.distributed.forests import ForestPart, Nodes, families_of, subtree_sizes, tree_by_tree
from tetraskel.distributed.numbering import sums_before
from tetraskel.distributed.parts import MeshPart
from tetraskel.distributed.roots import joined_pieces, root_facets
from tetraskel.errors import MeshError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.sons import CROSSINGS, crossing_codes

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
    codes = crossing_codes(part.mesh, tick)
    pieces: Ints = np.zeros(len(part), np.int64)
    walk = _Walk(comm, part, codes)
    walk.run(root_facets(comm, part, pieces), tick)
    if walk.n_nodes < part.n_cells:
        pieces = joined_pieces(comm, part)
        walk = _Walk(comm, part, codes)
        walk.run(root_facets(comm, part, pieces), tick)
    if walk.n_nodes < part.n_cells:
        closed = part.n_cells - walk.n_nodes
        raise MeshError(f"expected pieces with a border, got {closed} simplices without one; remove doubled cells.")
    return walk.result()


class _Walk:
    """The walk so far: what each simplex of this rank became."""

    def __init__(self, comm: Communicator, part: MeshPart, codes: NDArray[np.uint8]) -> None:
        m, self.width = part.across.shape
        self.comm, self.part, self.codes = comm, part, codes
        self.crossings = CROSSINGS[self.width - 1].reshape(-1, self.width - 1).astype(np.intp)
        self.number: Ints = np.full(m, -1, np.int64)
        self.parent, self.parent_at = (np.full(m, -1, np.int64) for _ in range(2))
        self.depth, self.son_rank, self.son_count = (np.zeros(m, np.int32) for _ in range(3))
        self.tree, self.parent_rank = np.zeros(m, np.int32), np.full(m, -1, np.int32)
        self.entry = np.zeros(m, np.uint8)
        self.claim = np.empty(m, np.int64)
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
        ahead = self.part.across.ravel()[halves].astype(np.int64)
        queue = self.number[front][:, None] * dim + np.arange(dim)  # places of the offers
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
        cells = self.part.across.ravel()[halves[taken]]
        above = front[taken[0]]
        self.entry[cells] = (self.part.across[cells] == above[:, None]).argmax(axis=1)
        self.number[cells], self.son_rank[cells] = numbers[taken], ranks[taken]
        self.parent[cells], self.tree[cells] = self.number[above], self.tree[above]
        self.parent_rank[cells], self.parent_at[cells] = self.comm.rank, above

    def _take_others(self, halves: Ints, front: Ints, away: tuple, found: tuple[Ints, Ints, Ints]) -> None:
        """Tell others the numbers of their new nodes; `halves` are the facets through which nodes were made here."""
        sons, numbers, ranks = found
        taken = tuple(index[sons[away]] for index in away)
        above = front[taken[0]]
        link = self.part.across[above, self._opposite(front, taken)] - len(self.part)
        route = Route(self.comm, self.part.ranks[link])
        told = np.stack([numbers[taken], ranks[taken], self.number[above], self.tree[above]], axis=1)
        number, rank, parent, tree = route.forward(told).T
        cells, self_link = halves // self.width, np.searchsorted(self.part.halves, halves)
        self.entry[cells] = halves % self.width
        self.number[cells], self.son_rank[cells], self.parent[cells], self.tree[cells] = number, rank, parent, tree
        self.parent_rank[cells] = self.part.ranks[self_link]
        self.parent_at[cells] = self.part.mates[self_link] // self.width

    def _opposite(self, front: Ints, taken: tuple) -> Ints:
        cells = front[taken[0]]
        return self.crossings[self.codes[cells].astype(np.intp) * self.width + self.entry[cells], taken[1]]

    def result(self) -> TreePart:
        """The finished tree, nodes in the order of their numbers."""
        number, parent = self.number, self.parent
        if self.n_trees > 1:
            number = tree_by_tree(self.comm, number, self.depth, self.tree)
        order = np.argsort(number)
        index = np.empty(len(order), np.int64)
        index[order] = np.arange(len(order))
        nodes = Nodes(self.depth[order], self.tree[order], self.parent_rank[order], self.parent_at[order], order)
        sons = np.flatnonzero(nodes.parent_rank >= 0)
        route = Route(self.comm, nodes.parent_rank[sons])
        above = route.forward(nodes.parent_at[sons])
        parent, parent_at = np.full(len(order), -1, np.int64), np.full(len(order), -1, np.int64)
        parent[sons], parent_at[sons] = route.back(np.stack([number[above], index[above]], axis=1)).T
        forest = ForestPart(
            number[order], parent, nodes.depth, self.son_rank[order], self.son_count[order], np.empty(0, np.int64),
            nodes.tree_id, nodes.parent_rank, parent_at, self.n_nodes,
        )  # fmt: skip
        families = families_of(self.comm, forest.depth, forest.parent_rank, forest.parent_at)
        forest = replace(forest, subtree_size=subtree_sizes(families, len(forest)))
        return TreePart(forest, order, self.entry[order], self.part)
