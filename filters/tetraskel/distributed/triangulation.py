"""From points spread over ranks to their triangulation, spread over ranks by place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.distributed.blocks import deal_by_place
from tetraskel.distributed.communicator import Communicator
from tetraskel.distributed.parts import MeshPart, part_of_mesh
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.points import finite_points

if TYPE_CHECKING:
    from tetraskel.distributed.delaunay import OwnedCells

Ints = NDArray[np.int64]


@dataclass(frozen=True)
class TriangulatedPart:
    """One rank's share of a triangulation.

    Attributes
    ----------
    part : MeshPart
        Its simplices. The points are those of its block and the other points of its simplices.
    owned : (n,) bool
        Points of the block: each point of all ranks is owned once.
    origins : (n, 3) int
        Input id of each point, the rank that brought it, and its index there.
    n_input : int
        Points brought by all ranks.
    n_distinct : int
        Of them, those that differ.
    """

    part: MeshPart
    owned: NDArray[np.bool_]
    origins: Ints
    n_input: int
    n_distinct: int


def triangulate_part(comm: Communicator, points: ArrayLike, ids: Ints, tick: Tick = silent) -> TriangulatedPart:
    """The Delaunay triangulation of the points of all ranks, by the exact engine; simplices are numbered as serially.

    Parameters
    ----------
    points : (k, 3) array
        What this rank brings, in any unit, dealt to the ranks in any way. They fill space.
    ids : (k,) int
        Input id of each; copies of a point on several ranks have one id.

    Raises
    ------
    InputError
        For points that are not finite, or lie in one plane.
    """
    from tetraskel.distributed.delaunay import delaunay_of_block  # loads only where numba is

    whole = comm.keep(finite_points(points))
    n_input = comm.total(len(whole[0]))
    block = deal_by_place(comm, whole.pop(), np.asarray(ids, np.int64))
    n_distinct = block.total
    cells = delaunay_of_block(comm, block, tick)
    del block
    known, rows = cells.known, _rows_by_id(cells)
    new_id = np.full(len(known), -1, np.int32)
    new_id[rows] = np.arange(len(rows), dtype=np.int32)
    points, simplices, neighbors, point_ids, owned, origins = comm.keep(
        known.points[rows], new_id[cells.simplices], cells.neighbors,
        known.row[rows].astype(np.int64), known.own[rows], known.names[rows, 1:].astype(np.int64),
    )  # fmt: skip
    del cells, known, rows, new_id
    part = part_of_mesh(comm, Triangulation(points, simplices, neighbors, engine="exact"), point_ids)
    return TriangulatedPart(part, owned, origins, n_input, n_distinct)


def _rows_by_id(cells: OwnedCells) -> Ints:
    """The known points that are own or of own cells, in the order of their ids."""
    used = cells.known.own.copy()
    used[cells.simplices.ravel()] = True
    rows = np.flatnonzero(used)
    return rows[np.argsort(cells.known.row[rows], kind="stable")]
