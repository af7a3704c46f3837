"""Inside and outside of an object by gates, for a triangulation spread over ranks: the serial answer."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route
from tetraskel.distributed.cuts import Cuts
from tetraskel.distributed.gates import (
    basins_of_part,
    gate_arrays_of_part,
    rows_at_gates,
    shared_on_first,
    tree_on_first,
)
from tetraskel.distributed.parts import MeshPart
from tetraskel.distributed.surface import lie_on_surface
from tetraskel.kernels.adjacency import facet_points, scramble
from tetraskel.kernels.basins import Basins
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.denoise import lies_on_surface
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.gates import (
    GateArrays,
    GateTree,
    Regions,
    opposite_sides,
    regions_behind_doors,
    shared_facets,
)
from tetraskel.kernels.interior import Classified, told_by_gates, touched_sides
from tetraskel.kernels.noise import mean_at_gates, scatter
from tetraskel.kernels.passage_widths import widths_and_rooms
from tetraskel.kernels.smoothing import settled
from tetraskel.options import InteriorOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class InsidePart:
    """What is known of a rank's m simplices.

    Attributes
    ----------
    inside : (m,) bool
        Simplices inside.
    everywhere : (n,) bool
        Inside of all that `neighbors` names, and at last of the outside.
    neighbors : (m, d+1) int
        See `Cuts`.
    messages : list of str
        What there is to warn of; the same on all ranks.
    gates : GateArrays or None
        Where asked for.
    """

    inside: Bools
    everywhere: Bools
    neighbors: Ints
    messages: list[str]
    gates: GateArrays | None


def interior_of_part(
    comm: Communicator,
    mesh: MeshPart,
    options: InteriorOptions,
    *,
    with_arrays: bool = False,
    tick: Tick = silent,
) -> InsidePart:
    """Which of this rank's simplices lie inside, by the gates of all ranks; see `kernels.interior.interior`.

    Parameters
    ----------
    mesh : MeshPart
        Simplices are numbered rank after rank. A point of the mesh is among those of one rank at least, whether or not
        a simplex there uses it.
    options : InteriorOptions
        With the method "gates".
    with_arrays : bool
        Say what the gate tree knows of each simplex, too.

    Raises
    ------
    InputError
        For points that span no size that can be calculated with.
    EngineError
        When SciPy is missing.
    """
    classified = MeshOfRanks(comm, mesh, options.noise, part(tick, 0.0, 0.9))
    inside, messages = told_by_gates(classified, options.ratio, tick)
    gates = classified.gate_arrays() if with_arrays else None
    everywhere = classified.cuts.with_others(inside, outside=False)
    return InsidePart(inside, everywhere, classified.mesh.neighbors, messages, gates)


class MeshOfRanks(Classified):
    """A part of a mesh, asked together with all others."""

    def __init__(self, comm: Communicator, mesh: MeshPart, noise: float, tick: Tick = silent) -> None:
        self.comm, self.part, self.dim = comm, mesh, mesh.mesh.dim
        _expect_extent(comm, mesh.mesh.points)
        told = part(tick, 0.0, 0.5)
        widths, rooms = comm.keep(*widths_and_rooms(mesh.mesh.coordinates, mesh.mesh.simplices, told))
        self.cuts = Cuts(comm, mesh)
        self.mesh = replace(mesh.mesh, neighbors=self.cuts.neighbors)
        self.basins: Basins = basins_of_part(comm, mesh, self.cuts, widths)
        tick(0.7)
        self.tree: GateTree | None = tree_on_first(comm, mesh, self.basins, rooms)
        self.least_width = self._least_width(noise) if noise else 0.0
        tick(0.9)

    def _least_width(self, noise: float) -> Floats | float:
        """What noise makes of gates; known on the first rank, which sees all points for it."""
        ids, points = self._points_on_first()
        corners = rows_at_gates(self.comm, self.tree, self.part, self.part.point_ids[self.part.mesh.simplices])
        if self.tree is None:
            return 0.0
        return noise * mean_at_gates(self.tree, scatter(points), np.searchsorted(ids, corners))

    def behind_doors(self, ratio: float) -> Bools:
        """See `Classified.behind_doors`."""
        found = Regions(np.empty(0, np.int32), np.empty(0))
        if self.tree is not None:
            found = regions_behind_doors(self.tree, ratio, self.least_width)
        of_basin = self.comm.from_first(found.of_basin.astype(np.int32))
        (of_basin,) = self.comm.keep(of_basin.astype(np.int64))
        regions = Regions(of_basin, self.comm.from_first(found.size))
        shared = shared_on_first(self.comm, shared_facets(self.basins, regions, ratio))
        inside = self.comm.from_first(opposite_sides(shared) if self.comm.rank == 0 else np.empty(0, bool))
        return self.comm.keep(inside[regions.of_basin[self.basins.of_simplex[:-1]]])[0]

    def is_any(self, inside: Bools) -> bool:
        """See `Classified.is_any`."""
        return self.comm.total(int(inside.any())) > 0

    def lies_on_surface(self) -> bool:
        """See `Classified.lies_on_surface`; on a lattice the first rank sees all points for it."""
        nothing = np.zeros(len(self.part), bool)
        n_points = self.comm.total(self._points_once(touched_sides(self.mesh, nothing)).shape[1])
        found = lie_on_surface(self.comm, self.mesh.points, self.part.point_ids, n_points)
        if found is not None:
            return found
        points = self._points_on_first()[1]
        told = np.array([lies_on_surface(points)]) if self.comm.rank == 0 else np.empty(0, bool)
        return bool(self.comm.from_first(told)[0])

    def smaller_surface(self, inside: Bools) -> Bools:
        """See `Classified.smaller_surface`."""
        return settled(self.mesh, self.cuts.with_others(inside, outside=False), self.cuts)[: len(self.part)]

    def surface_share(self, inside: Bools) -> float:
        """See `Classified.surface_share`."""
        known = self._points_once(touched_sides(self.mesh, inside))
        n, n_both = self.comm.sums(np.array([known.shape[1], np.count_nonzero(known.all(axis=0))]))
        return float(n_both / max(n, 1))

    def _points_once(self, touched: Bools) -> Bools:
        """(2, k) which sides each of k points touches on any rank; the k of all ranks are all points, once.

        Strategy: around most points all simplices are own ones. The others lie on facets without an own simplex
        across, or some rank has them without a simplex; what each rank knows of those meets where their ids decide.
        """
        loose = self.part.point_ids[~touched.any(axis=0)].astype(np.int64)
        shared: Bools = np.isin(self.part.point_ids, np.concatenate(self.comm.allgather(loose)))
        shared[facet_points(self.mesh.simplices, np.flatnonzero(self.part.mesh.neighbors.ravel() < 0))] = True
        met = self._met(self.part.point_ids[shared].astype(np.int64), touched[:, shared])
        return np.concatenate([touched[:, ~shared], met], axis=1)

    def _met(self, ids: Ints, flags: Bools) -> Bools:
        """(2, k) flags of the points that meet on this rank, as set by any rank."""
        route = Route.by_keys(self.comm, scramble(ids.astype(np.uint64)))
        met, point = np.unique(route.forward(ids), return_inverse=True)
        either = np.zeros((2, len(met)), bool)
        for side, told in enumerate(flags):
            either[side, point.reshape(-1)[route.forward(told)]] = True
        return either

    def _points_on_first(self) -> tuple[Ints, Floats]:
        """Ids, increasing, and coordinates of the points of all ranks, on the first one."""
        ids, points = self.comm.gather(self.part.point_ids.astype(np.int64)), self.comm.gather(self.mesh.points)
        ids, rows = np.unique(ids, return_index=True)
        return ids, points[rows]

    def gate_arrays(self) -> GateArrays:
        """What the gate tree knows of each own simplex."""
        return gate_arrays_of_part(self.comm, self.tree, self.part, self.cuts, self.basins)


def _expect_extent(comm: Communicator, points: Floats) -> None:
    """`expect_extent` of the points of all ranks."""
    low = comm.lowest(points.min(axis=0, initial=np.inf))
    expect_extent(np.stack([low, comm.highest(points.max(axis=0, initial=-np.inf))]))
