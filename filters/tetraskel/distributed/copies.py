"""Nodes of other ranks that lines of this one begin at: where they are, and what is known of them there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route

Array = NDArray[Any]
Ints = NDArray[Any]


@dataclass(frozen=True)
class Copies:
    """Nodes of other ranks.

    Attributes
    ----------
    ids : (c,) int
        Names of the nodes among all ranks, ascending.
    owners : (c,) int
        Rank that has each.
    rows : (c,) int
        Which of that rank's nodes it is.
    """

    ids: Ints
    owners: Ints
    rows: Ints

    def __len__(self) -> int:
        return len(self.ids)

    def with_theirs(self, comm: Communicator, values: Array) -> Array:
        """(k + c, ...) what is known of this rank's (k, ...) nodes, and of the copies by their owners."""
        route = Route(comm, self.owners)
        return np.concatenate([values, route.back(values[route.forward(self.rows)])])


def parents_elsewhere(comm: Communicator, parent: Ints, parent_rank: Ints, parent_at: Ints) -> tuple[Copies, Ints]:
    """Parents that other ranks have, each once, and the parents (k,) as places among own nodes and then the copies.

    Parameters
    ----------
    parent, parent_rank, parent_at : (k,) int
        Name of each node's parent, the rank that has it, and which of that rank's nodes it is; -1 for a root.
    """
    away = np.flatnonzero((parent_rank >= 0) & (parent_rank != comm.rank))
    ids, first, number = np.unique(parent[away], return_index=True, return_inverse=True)
    above = np.array(parent_at)
    above[away] = len(parent) + number.reshape(-1)
    return Copies(ids, parent_rank[away][first], parent_at[away][first]), above
