"""Whether points spread over ranks lie on a surface, from the few places that the serial code looks at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.blocks import deal_by_place
from tetraskel.distributed.communicator import Communicator
from tetraskel.kernels.denoise import FEWEST, is_surface_around, places_to_look_at
from tetraskel.kernels.nearest import Cloud

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# Points whose distances differ by less, as a share of the farthest, are taken for equally far: which of them a search
# finds first depends on the tree it searches.
AS_FAR = 1e-9


def lie_on_surface(comm: Communicator, points: Floats, ids: Ints, n_points: int) -> bool | None:
    """What `denoise.lies_on_surface` says of the points of all ranks; None where that depends on how it searches.

    Strategy: along the curve each rank finds the places to look at on its stretch, and tells all. Each then knows how
    far at most the nearest points of each place are, and only points so near go to the first rank.

    Parameters
    ----------
    points : (k, d) float
        Of this rank, copies of points of other ranks among them.
    ids : (k,) int
        Input id of each, the same for all copies of a point.
    n_points : int
        Of all ranks, without copies.
    """
    block = deal_by_place(comm, points, ids.astype(np.int64))
    if block.total != n_points:
        return None  # some are equal, which counts
    wanted = places_to_look_at(n_points)
    if len(wanted) == 0:
        return False
    here = wanted[(wanted >= block.first) & (wanted < block.first + len(block))] - block.first
    places = np.concatenate(comm.allgather(block.points[here]))
    place, away, near = _nearest(comm, block.points, places, FEWEST + 1)
    place, away, near = comm.gather(place), comm.gather(away), comm.gather(near)
    told = np.empty(0, np.int8)
    if comm.rank == 0:
        order = np.lexsort([away, place])
        first = np.searchsorted(place[order], np.arange(len(places)))
        nearest = order[first[:, None] + np.arange(FEWEST + 1)]
        told = np.array([_told(places, away[nearest], near[nearest])], np.int8)
    said = int(comm.from_first(told)[0])
    return None if said < 0 else bool(said)


def _nearest(comm: Communicator, points: Floats, places: Floats, k: int) -> tuple[Ints, Floats, Floats]:
    """Own points that may be among the k nearest of each place: which place, how far, and where."""
    nothing = np.full((len(places), k), np.inf), np.zeros((len(places), k), np.int64)
    away, near = Cloud(points).query(places, k) if len(points) else nothing
    farthest = comm.lowest(away[:, -1])
    place, column = np.nonzero(np.isfinite(away) & (away <= farthest[:, None]))
    return place, away[place, column], points[near[place, column]]


def _told(places: Floats, away: Floats, around: Floats) -> int:
    """1 for a surface, 0 for none, -1 where some of the points are equally far."""
    if (np.diff(away, axis=1) <= AS_FAR * away[:, -1:]).any():
        return -1
    return int(is_surface_around(places, away[:, :-1], around[:, :-1]))
