"""The interior alone, in an order that depends on nothing but coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.dual_complex import facets_of
from tetraskel.kernels.loops_in_python import call_compiled
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.passage_widths import widths_of_facets
from tetraskel.kernels.points import morton_order

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

SECONDS_PER_CELL = 2e-7  # compiled; for the progress bar only


@dataclass(frozen=True)
class InnerMesh:
    """Interior simplices of a mesh.

    Attributes
    ----------
    coordinates : (n, d) float
        The points used by the interior, along a Morton curve.
    simplices, neighbors : (k, d+1) int
        Sorted by their smallest points; ascending inside each (no stage needs the orientation). -1 beyond the boundary.
    point_ids : (n,) int
        Id of each point in the mesh.
    mesh : Triangulation
        Where it was taken from.
    """

    coordinates: Floats
    simplices: Ints
    neighbors: Ints
    point_ids: Ints
    mesh: Triangulation

    @cached_property
    def cloud(self) -> Cloud:
        """The points, for questions about the nearest."""
        return Cloud(self.coordinates)

    @cached_property
    def widest_door(self) -> float:
        """Largest passage width of the boundary's facets: no place on the boundary is farther from all points."""
        outer = facets_of(self.simplices, self.neighbors).outer
        return float(widths_of_facets(self.coordinates, outer).max(initial=0.0))


def inner_mesh(mesh: Triangulation, inside: Bools, tick: Tick = silent) -> InnerMesh:
    """The simplices inside, renumbered by coordinates: permuted input gives the same arrays.

    Parameters
    ----------
    mesh : Triangulation
    inside : (m,) bool
    """
    cells = np.flatnonzero(inside)
    used = np.zeros(len(mesh.points), bool)
    used[mesh.simplices[cells]] = True
    ids = np.flatnonzero(used)
    ids = ids[morton_order(mesh.coordinates[ids])] if len(ids) else ids
    number = np.full(len(mesh.points), -1, np.int32)
    number[ids] = np.arange(len(ids), dtype=np.int32)
    return InnerMesh(mesh.coordinates[ids], *chosen_simplices(mesh, cells, number, tick), ids, mesh)


def chosen_simplices(mesh: Triangulation, cells: Ints, number: Ints, tick: Tick) -> tuple[Ints, Ints]:
    """Simplices and neighbours (k, d+1) of some `cells`, sorted by their points, which have new numbers (n,)."""
    if mesh.dim == 3:
        arguments = (mesh.simplices, mesh.neighbors, cells, number, len(number))
        found = call_compiled("incidence_loops.chosen_simplices", arguments, tick, SECONDS_PER_CELL * len(cells))
        if found is not None:
            return found
    simplices = number[mesh.simplices[cells]]
    order = _order_of(simplices)
    place = np.full(len(mesh) + 1, -1, np.int32)  # the last for "no neighbour"
    place[cells[order]] = np.arange(len(cells), dtype=np.int32)
    return _turned(simplices[order], place[mesh.neighbors[cells[order]]])


def _order_of(simplices: Ints) -> Ints:
    """Indices that sort simplices by their ascending points: close in the order is close in space."""
    ranked = np.sort(simplices.astype(np.int64), axis=1)
    head = (ranked[:, 0] << 32) | ranked[:, 1]
    tail = (ranked[:, -2] << 32) | ranked[:, -1]
    by_tail = np.argsort(tail, kind="stable")
    return by_tail[np.argsort(head[by_tail], kind="stable")]


def _turned(simplices: Ints, neighbors: Ints) -> tuple[Ints, Ints]:
    """Vertices of each simplex in ascending order, and neighbours with them."""
    order = np.argsort(simplices, axis=1)
    return np.take_along_axis(simplices, order, axis=1), np.take_along_axis(neighbors, order, axis=1)
