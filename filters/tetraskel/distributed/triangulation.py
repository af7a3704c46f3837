"""From points spread over ranks to their triangulation, spread over ranks by place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.distributed.blocks import Block, deal_by_place
from tetraskel.distributed.communicator import Communicator
from tetraskel.distributed.delaunay import OwnedCells, delaunay_of_block
from tetraskel.distributed.parts import MeshPart, part_of_mesh
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.points import finite_points

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class TriangulatedPart:
    """One rank's share of a triangulation.

    Attributes
    ----------
    part : MeshPart
        Its simplices. The points are those of its block and the other points of its simplices; `original_ids` of the
        mesh are their input ids.
    owned : (n,) bool
        Points of the block: each point of all ranks is owned once.
    home : (n, 2) int
        Rank that brought each point, and its index there.
    n_input : int
        Points brought by all ranks.
    n_distinct : int
        Of them, those that differ.
    """

    part: MeshPart
    owned: NDArray[np.bool_]
    home: Ints
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
    whole = finite_points(points)
    n_input = comm.total(len(whole))
    block = deal_by_place(comm, whole, np.asarray(ids, np.int64))
    cells = delaunay_of_block(comm, block, tick)
    used = cells.known.own.copy()
    used[cells.simplices.ravel()] = True
    mesh, rows = _mesh_of(block, cells, used)
    part = part_of_mesh(comm, mesh, rows)
    order = np.argsort(rows)
    owned = cells.known.own[used][order]
    own_rows = np.argsort(block.row)
    home = np.full((len(rows), 2), -1, np.int64)
    home[owned] = block.home[own_rows]
    return TriangulatedPart(part, owned, home, n_input, block.total)


def _mesh_of(block: Block, cells: OwnedCells, used: NDArray[np.bool_]) -> tuple[Triangulation, Ints]:
    """The owned simplices over the points they use and those of the block, and the rows of these points."""
    new_id = (np.cumsum(used) - 1).astype(np.int32)
    known = cells.known
    mesh = Triangulation(known.points[used], new_id[cells.simplices], cells.neighbors, engine="exact")
    return mesh, known.row[used]
