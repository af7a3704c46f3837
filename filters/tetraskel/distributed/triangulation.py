"""From points spread over ranks to their triangulation, spread over ranks by place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.distributed.blocks import deal_by_place
from tetraskel.distributed.communicator import Communicator
from tetraskel.distributed.parts import MeshPart, part_of_mesh
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.points import finite_points

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

    whole = finite_points(points)
    n_input = comm.total(len(whole))
    block = deal_by_place(comm, whole, np.asarray(ids, np.int64))
    cells = delaunay_of_block(comm, block, tick)
    known, used = cells.known, cells.known.own.copy()
    used[cells.simplices.ravel()] = True
    new_id = (np.cumsum(used) - 1).astype(np.int32)
    mesh = Triangulation(known.points[used], new_id[cells.simplices], cells.neighbors, engine="exact")
    part = part_of_mesh(comm, mesh, known.row[used])
    order = np.flatnonzero(used)[np.argsort(known.row[used])]
    return TriangulatedPart(part, known.own[order], known.names[order, 1:], n_input, block.total)
