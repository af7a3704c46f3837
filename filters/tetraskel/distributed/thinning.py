"""Thinning of points that are spread over ranks: the serial result, whatever rank has which points.

Each rank looks at its own points and finds the best one in each leaf of the octree. The best of all ranks are found
where the name of the leaf says; the first rank, which gets these and nothing else, decides which leaves are divided.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route
from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.leaf_samples import Sample, joined, sample_of_all
from tetraskel.kernels.octree import Octree
from tetraskel.kernels.thinning import CHECKED, Thinned, checked, divided_enough, leaves_to_divide, octree_around
from tetraskel.options import ThinningOptions

Ints = NDArray[np.int64]


def thinned_on_ranks(
    comm: Communicator, points: NDArray, ids: Ints, options: ThinningOptions, tick: Tick = silent
) -> Thinned:
    """Which points of all ranks to keep; every rank gets all ids.

    Parameters
    ----------
    points : (k, d) float
        Of this rank.
    ids : (k,) int
        Of these among all ranks; a point is on one rank only (see `first_with_each`).

    Raises
    ------
    InputError
        As `thinned` does.
    """
    given, low, high = checked(points, part(tick, 0.0, CHECKED))
    if comm.total(len(given)) <= options.most_points:
        everything = np.sort(np.concatenate(comm.allgather(ids)))
        return Thinned(everything, np.zeros(len(everything)), 0)
    first = octree_around(comm.lowest(low), comm.highest(high), options.most_points)
    found = divided_enough(
        first,
        lambda octree, told: _sample_of_ranks(comm, sample_of_all(given, ids, octree, told)),
        lambda sample, octree, told: _told_by_first(comm, sample, octree, options, told),
        part(tick, CHECKED, 1.0),
    )
    kept, spacing = comm.from_first(found.ids), comm.from_first(found.spacing)
    return Thinned(kept, spacing, found.n_coarse)


def first_with_each(comm: Communicator, ids: Ints) -> NDArray[np.bool_]:
    """(k,) whether no rank before this one has a point with this id, and this one none before it."""
    route = Route.by_keys(comm, scramble(ids.astype(np.uint64)))
    met = route.forward(ids)  # in the order of the ranks
    first = np.zeros(len(met), bool)
    first[np.unique(met, return_index=True)[1]] = True
    return route.back(first)


def _sample_of_ranks(comm: Communicator, own: Sample) -> Sample:
    """One point of each leaf, of all ranks, on the first."""
    route = Route.by_keys(comm, scramble(own.leaf.astype(np.uint64)))
    met = joined([Sample(*(route.forward(getattr(own, field.name)) for field in fields(Sample)))])
    return joined([Sample(*(comm.gather(getattr(met, field.name)) for field in fields(Sample)))])


def _told_by_first(
    comm: Communicator, sample: Sample, octree: Octree, options: ThinningOptions, tick: Tick
) -> tuple[Ints, int]:
    leaves, n_coarse = leaves_to_divide(sample, octree, options, tick) if comm.rank == 0 else (sample.leaf, 0)
    return comm.from_first(leaves), int(comm.from_first(np.array([n_coarse]))[0])
