"""A triangulation spread over ranks: each rank's simplices, and who has the other side of its facets."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.errors import MeshError
from tetraskel.kernels.adjacency import facet_points, scramble
from tetraskel.kernels.mesh import Triangulation, submesh

Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class MeshPart:
    """One rank's simplices of a triangulation.

    Attributes
    ----------
    mesh : Triangulation
        The simplices this rank owns over the points it needs; its neighbours know this rank's simplices only.
    point_ids : (n,) int
        Id of each point among all ranks, increasing: the order of the points here is that of all.
    cell_ids : (m,) int
        Id of each simplex among all ranks.
    halves : (k,) int
        Facets whose other side another rank has, as simplex * (d+1) + opposite vertex, increasing.
    ranks, mates : (k,) int
        That rank, and the facet as that rank numbers it.
    n_cells : int
        Number of simplices on all ranks.
    """

    mesh: Triangulation
    point_ids: Ints
    cell_ids: Ints
    halves: Ints
    ranks: Ints
    mates: Ints
    n_cells: int

    def __len__(self) -> int:
        return len(self.mesh)

    def across(self, halves: Ints) -> NDArray[np.int64]:
        """Own simplex across each of these facets; m + j for the facet `halves[j]` of the part; -1 for none."""
        across = np.take(self.mesh.neighbors, halves).astype(np.int64)
        open_ones = np.nonzero(across < 0)
        link = np.searchsorted(self.halves, halves[open_ones])
        is_cut = np.append(self.halves, -1)[link] == halves[open_ones]
        across[open_ones] = np.where(is_cut, len(self.mesh) + link, -1)
        return across


def part_of_mesh(comm: Communicator, mesh: Triangulation, point_ids: Ints, cell_ids: Ints | None = None) -> MeshPart:
    """Find the other sides of the facets that this rank's simplices leave open.

    Strategy: each open facet is sent to a rank that its points' ids decide, where its two sides meet; each is then told
    of the other.

    Parameters
    ----------
    mesh : Triangulation
        This rank's simplices; none of them on two ranks.
    point_ids : (n,) int
        Id of each of its points among all ranks.
    cell_ids : (m,) int, optional
        Of the simplices; by default they are numbered rank after rank.

    Raises
    ------
    MeshError
        When a facet belongs to more than two simplices.
    """
    mesh, point_ids = _sorted_by_id(mesh, point_ids)
    open_halves = np.flatnonzero(mesh.neighbors.ravel() < 0)
    facets = point_ids[facet_points(mesh.simplices, open_halves)].astype(np.int64)
    route = Route.by_keys(comm, scramble(facets.astype(np.uint64)).sum(axis=1, dtype=np.uint64))
    sent = np.concatenate([facets, open_halves[:, None]], axis=1)
    met = route.forward(sent)
    other = route.back(_paired(met, route.source))
    found = np.flatnonzero(other[:, 0] >= 0)
    n_cells, first = comm.total(len(mesh)), comm.before(len(mesh))
    if cell_ids is None:
        cell_ids = np.arange(first, first + len(mesh), dtype=index_type(n_cells))
    cell_ids, halves, ranks, mates = comm.keep(cell_ids, open_halves[found], other[found, 0], other[found, 1])
    return MeshPart(mesh, point_ids, cell_ids, halves, ranks, mates, n_cells)


def submesh_of_part(comm: Communicator, part: MeshPart, kept: Bools) -> MeshPart:
    """The simplices where (m,) `kept` holds, numbered anew rank after rank; points and their ids stay as they are.

    A facet whose other side is gone, here or on another rank, becomes part of the boundary.
    """
    width = part.mesh.dim + 1
    cells, corners = np.divmod(part.halves, width)
    own = np.where(kept[cells], (np.cumsum(kept)[cells] - 1) * width + corners, -1)
    mesh = submesh(part.mesh, kept)
    simplices, neighbors, own = comm.keep(mesh.simplices, mesh.neighbors, own)
    mesh = replace(mesh, simplices=simplices, neighbors=neighbors)
    met = Route(comm, part.ranks).forward(np.stack([part.mates, own], axis=1))
    theirs = np.full(len(own), -1, np.int64)
    theirs[np.searchsorted(part.halves, met[:, 0])] = met[:, 1]
    found = np.flatnonzero((own >= 0) & (theirs >= 0))
    halves, ranks, mates = comm.keep(own[found], part.ranks[found], theirs[found])
    n_cells, first = comm.total(len(mesh)), comm.before(len(mesh))
    cell_ids = comm.keep(np.arange(first, first + len(mesh), dtype=index_type(n_cells)))[0]
    return MeshPart(mesh, part.point_ids, cell_ids, halves, ranks, mates, n_cells)


def _sorted_by_id(mesh: Triangulation, point_ids: Ints) -> tuple[Triangulation, Ints]:
    """The mesh with its points in the order of their ids, so that comparing indices is comparing ids."""
    if np.all(point_ids[1:] > point_ids[:-1]):
        return mesh, point_ids
    order = np.argsort(point_ids, kind="stable")
    if np.any(np.diff(point_ids[order]) == 0):
        raise MeshError("expected points with ids that differ, got two with one; generate global ids anew.")
    new_id = np.empty(len(order), np.int32)
    new_id[order] = np.arange(len(order), dtype=np.int32)
    return replace(mesh, points=mesh.points[order], simplices=new_id[mesh.simplices]), point_ids[order]


def _paired(met: Ints, source: Ints) -> Ints:
    """(r, 2) rank and facet number of the other side of each facet that came here, -1 for none."""
    facets, halves = met[:, :-1], met[:, -1]
    order = np.lexsort(facets.T[::-1])
    same = (facets[order[1:]] == facets[order[:-1]]).all(axis=1)
    if np.any(same[1:] & same[:-1]):
        raise MeshError(
            "expected facets shared by at most two simplices, got some shared by more; remove ghost cells or "
            "overlapping cells first."
        )
    other = np.full((len(met), 2), -1, np.int64)
    left, right = order[:-1][same], order[1:][same]
    other[left] = np.stack([source[right], halves[right]], axis=1)
    other[right] = np.stack([source[left], halves[left]], axis=1)
    return other
