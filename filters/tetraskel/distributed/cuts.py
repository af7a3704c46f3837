"""What neighbours across cuts have and say: the simplices of other ranks that touch a rank's own."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.distributed.parts import MeshPart
from tetraskel.kernels.smoothing import Border

Array = NDArray[Any]
Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Cuts(Border):
    """The cuts around a rank's m simplices, over which all ranks talk together.

    Attributes
    ----------
    neighbors : (m, d+1) int
        Simplex across each facet: an own one, m + j across the cut facet `halves[j]` of the part, -1 outside the mesh.
    cells : (k,) int
        Own simplex with each cut facet.
    n_halves : int
        Cut facets of all ranks, each seen from both sides.
    """

    def __init__(self, comm: Communicator, part: MeshPart) -> None:
        self.comm, self.part = comm, part
        width = part.mesh.dim + 1
        neighbors = part.mesh.neighbors.copy()
        neighbors.reshape(-1)[part.halves] = len(part) + np.arange(len(part.halves))
        mates = part.mates.astype(index_type(width * part.n_cells))
        self.cells, self.neighbors, self._mates = comm.keep(part.halves // width, neighbors, mates)
        del neighbors, mates
        self.n_halves = comm.total(len(part.halves))
        self._route = Route(comm, part.ranks)
        self._link = comm.keep(self._links_of(self._route.forward(self._mates)))[0]

    def swapped(self, values: Array) -> Array:
        """What the other side says of each cut facet, from what this side says (k,)."""
        received = self._route.forward(values)
        theirs = np.empty_like(received)
        theirs[self._link] = received
        return self.comm.keep(theirs)[0]

    def with_others(self, values: Array, outside: Any) -> Array:
        """Values of all that `neighbors` names, from those of own simplices (m,), and at last the outside's."""
        last = np.array([outside], values.dtype)
        values = self.comm.keep(values)[0]
        return self.comm.keep(np.concatenate([values, self.swapped(values[self.cells]), last]))[0]

    def keep(self, *arrays: Array) -> list[Array]:
        """See `Border.keep`."""
        return self.comm.keep(*arrays)

    def is_anybody(self, here: bool) -> bool:
        """See `Border.is_anybody`."""
        return self.comm.total(int(here)) > 0

    def gains(self, willing: Ints, gain: Floats) -> tuple[Ints, Floats]:
        """See `Border.gains`."""
        links, route = self._told_of(willing)
        theirs = route.forward(gain[np.searchsorted(willing, self.cells[links])])
        found = self._links_of(route.forward(self._mates[links]))
        order = np.argsort(found)
        return len(self.part) + found[order], theirs[order]

    def moved(self, moving: Ints) -> tuple[Ints, Ints]:
        """See `Border.moved`."""
        links, route = self._told_of(moving)
        found = self._links_of(route.forward(self._mates[links]))
        return len(self.part) + found, self.cells[found]

    def _told_of(self, cells: Ints) -> tuple[Ints, Route]:
        """The cut facets of some own simplices, and the way to their other sides."""
        chosen = np.zeros(len(self.part), bool)
        chosen[cells] = True
        links = np.flatnonzero(chosen[self.cells])
        return links, Route(self.comm, self.part.ranks[links])

    def _links_of(self, halves: Ints) -> Ints:
        """Which cut facets of the part these are."""
        return np.searchsorted(self.part.halves, halves)
