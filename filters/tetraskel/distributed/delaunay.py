"""The Delaunay tetrahedra of points spread over ranks, each rank those whose first point it owns.

Each rank triangulates the points it knows and asks the others about cells that points unknown to it may forbid; what
they answer it then knows, and triangulates again, until nobody has an answer.

**Which cells must be asked about.** Let S be the cells, infinite ones included, with a point of this rank's block. A
point x that is unknown forbids the cell it lies in, and the cells it forbids are joined across facets (they are the
cavity that inserting x would dig). So if x forbids any cell of S, then it forbids the cell of S that x lies in, or a
cell of S with a neighbour outside S. Unknown points lie in the boxes of the other ranks. Hence it is enough to ask
about the cells of S (1) whose box meets another rank's box, (2) with a neighbour outside S, (3) that are infinite. No
circumsphere is computed, nothing is inflated: answers come from the exact predicates of the engine, ties included,
so that degenerate points are no exception. When no question has an answer, all cells of S are cells of the
triangulation of all points, and the star of every point of the block is complete.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.blocks import Block
from tetraskel.distributed.boxes import boxes_of_stretches, even_stretches, tree_of_boxes
from tetraskel.distributed.communicator import Communicator, Route
from tetraskel.distributed.known import Known, boxes_of_block, known_at_first, told
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.exact import conflicts, engine

Floats = NDArray[np.float64]
Ints = NDArray[Any]
Bools = NDArray[np.bool_]

CHUNK = 1 << 16  # cells looked at together
LEAF = 16  # points in a box of the tree in which answers are looked for


@dataclass(frozen=True)
class OwnedCells:
    """The tetrahedra of a rank.

    Attributes
    ----------
    known : Known
        The points they are made of, and others.
    simplices : (m, 4) int
        Indices into `known`, positively oriented, in the serial order.
    neighbors : (m, 4) int
        Own tetrahedron across each facet, -1 for none: the outside, or another rank's.
    rounds : int
        How often points were triangulated.
    """

    known: Known
    simplices: Ints
    neighbors: Ints
    rounds: int


def delaunay_of_block(comm: Communicator, block: Block, tick: Tick = silent) -> OwnedCells:
    """The tetrahedra whose first point along the curve lies in this rank's block.

    Raises
    ------
    InputError
        When all points lie in one plane.
    """
    around, known = _surroundings(comm, block)
    asked, rounds = _Asked(), 0
    while True:
        rounds += 1
        simplices, neighbors = comm.keep(*_triangulated(known, tick))
        open_cells, slots = _open_cells(known, simplices, neighbors, around.foreign)
        fresh = asked.not_yet(known.place[simplices[open_cells]], slots)
        answers = around.answers(known.points[simplices[open_cells[fresh]]], slots[fresh])
        if comm.total(len(answers[1])) == 0:
            break
        del simplices, neighbors  # the next ones need their room
        known = known.with_others(*answers).kept(comm)
    simplices, neighbors = comm.keep(*_owned(known, simplices, neighbors))
    return OwnedCells(known, simplices, neighbors, rounds)


def _triangulated(known: Known, tick: Tick) -> tuple[Ints, Ints]:
    if not known.own.any():
        nothing = np.empty((0, 4), np.int32)
        return nothing, nothing
    return engine.delaunay(known.points, tick)[:2]


def _owned(known: Known, simplices: Ints, neighbors: Ints) -> tuple[Ints, Ints]:
    """The simplices whose first point is an own one, and their neighbours among themselves."""
    owned = known.own[simplices.min(axis=1)] if len(simplices) else np.empty(0, bool)
    new_id = np.append(np.cumsum(owned, dtype=np.int32) - 1, np.int32(-1))
    new_id[:-1][~owned] = -1
    return simplices[owned], new_id[neighbors[owned]]


def _open_cells(known: Known, simplices: Ints, neighbors: Ints, foreign: Floats) -> tuple[Ints, NDArray[np.int8]]:
    """Cells to ask about, and the slot opposite the hull facet where the infinite one behind it is meant, else -1."""
    star = np.zeros(len(simplices), bool)
    pieces = [slice(start, start + CHUNK) for start in range(0, len(simplices), CHUNK)]
    for piece in pieces:
        star[piece] = known.own[simplices[piece]].any(axis=1)
    finite, cells, slots = [np.empty(0, np.int64)], [np.empty(0, np.int64)], [np.empty(0, np.int8)]
    for piece in pieces:
        own, across = known.own[simplices[piece]], neighbors[piece]  # (c, 4)
        others = own.sum(axis=1, dtype=np.int8)[:, None] - own.view(np.int8)  # own points of the facet opposite a slot
        border = star[piece] & np.where(across < 0, others == 0, ~star[across]).any(axis=1)
        inner = piece.start + np.flatnonzero(star[piece] & ~border)
        met = np.zeros(len(inner), bool)
        conflicts.cells_in_boxes(
            simplices.ravel(), known.points.ravel(), foreign.ravel(), inner, met, conflicts.scratch()[1]
        )
        finite.append(np.union1d(piece.start + np.flatnonzero(border), inner[met]))
        infinite, slot = np.nonzero((across < 0) & (others > 0))
        cells.append(piece.start + infinite)
        slots.append(slot.astype(np.int8))
    n_finite = sum(len(found) for found in finite)
    return np.concatenate([*finite, *cells]), np.concatenate([np.full(n_finite, -1, np.int8), *slots])


class _Asked:
    """Questions asked before: a cell that nobody forbade then is not asked about again."""

    def __init__(self) -> None:
        self.before: NDArray[np.void] = np.empty(0, np.void)

    def not_yet(self, corners: Ints, slots: NDArray[np.int8]) -> Ints:
        """Indices of the questions not asked before; these are now asked."""
        rows = np.ascontiguousarray(np.concatenate([corners, slots[:, None]], axis=1, dtype=corners.dtype))
        keys = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).ravel()
        if len(self.before) == 0:
            self.before = keys[:0]
        fresh = np.flatnonzero(~np.isin(keys, self.before))
        self.before = np.concatenate([self.before, keys[fresh]])
        return fresh


@dataclass(frozen=True)
class _Surroundings:
    """What a rank needs to ask and to answer."""

    comm: Communicator
    block: Block
    foreign: Floats  # tree of the boxes of other ranks
    labels: Ints  # rank of each leaf of that tree
    own_boxes: Floats  # tree of the boxes of own points
    starts: Ints  # where the points of its leaves begin
    scale: float

    def answers(self, corners: Floats, slots: NDArray[np.int8]) -> tuple[Floats, Ints, Ints]:
        """Points of other ranks that forbid cells with these (q, 4, 3) corners: coordinates, places and names."""
        (flat,) = self.comm.keep(np.ascontiguousarray(corners).reshape(len(corners), 12))
        del corners
        found = np.zeros((len(slots), self.comm.size), bool)
        conflicts.labels_in_conflict(
            self._scaled(flat).ravel(),
            slots,
            self._scaled(self.foreign).ravel(),
            self.labels,
            found,
            *conflicts.scratch(),
        )
        questions, ranks = np.nonzero(found)
        route = Route(self.comm, ranks)
        (flat,) = self.comm.keep(flat[questions])
        asked, asked_slots = route.forward(flat), route.forward(slots[questions])
        answers = np.empty(len(asked), np.int64)
        points = self._scaled(self.block.points).ravel()
        conflicts.deepest_conflicts(
            self._scaled(asked).ravel(),
            asked_slots,
            self._scaled(self.own_boxes).ravel(),
            self.starts,
            points,
            answers,
            *conflicts.scratch(),
        )
        source = route.source
        wanted = [np.unique(answers[(source == rank) & (answers >= 0)]) for rank in range(self.comm.size)]
        return told(self.comm, self.block, wanted)

    def _scaled(self, values: Floats) -> Floats:
        """Times the engine's power of two, the same on all ranks."""
        return np.ldexp(values, engine.HIGHEST_EXPONENT - int(np.frexp(self.scale)[1]))


def _surroundings(comm: Communicator, block: Block) -> tuple[_Surroundings, Known]:
    """What lies around the block, and the points it knows at first."""
    boxes = boxes_of_block(block)
    all_boxes = comm.allgather(boxes.corners)
    around = np.concatenate([-boxes.widths[:, None].repeat(3, 1), boxes.widths[:, None].repeat(3, 1)], axis=1)
    known = known_at_first(comm, block, boxes, comm.allgather(boxes.corners + around))
    others = [all_boxes[rank] for rank in range(comm.size) if rank != comm.rank]
    ranks = [np.full(len(all_boxes[rank]), rank) for rank in range(comm.size) if rank != comm.rank]
    foreign = tree_of_boxes(np.concatenate([*others, np.empty((0, 6))]))
    starts = even_stretches(len(block), LEAF)
    own = tree_of_boxes(boxes_of_stretches(block.points, starts))
    labels = np.concatenate([*ranks, np.empty(0)]).astype(np.int64)
    largest = comm.highest(np.array([np.abs(block.points).max(initial=0.0)]))
    foreign, labels, own, starts = comm.keep(foreign, labels, own, starts)
    return _Surroundings(comm, block, foreign, labels, own, starts, float(largest[0])), known
