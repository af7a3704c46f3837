"""The gate tree of a triangulation spread over ranks: its basins on all of them, the tree on the first.

Basins are found together, with the serial numbers. The graph between them is the smaller part of what would have to be
sent: each rank sends the links of the maximum spanning forest of its own facets, for no others can be gates.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route, index_type
from tetraskel.distributed.cuts import Cuts
from tetraskel.distributed.parts import MeshPart
from tetraskel.kernels.basins import Basins, facets_between, widest_neighbors
from tetraskel.kernels.gates import GateArrays, GateTree, Links, SharedFacets, beyond_gates, gate_tree_of_links
from tetraskel.kernels.spanning_tree import joined_parts

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def basins_of_part(comm: Communicator, part: MeshPart, cuts: Cuts, widths: Floats) -> Basins:
    """The basins of this rank's simplices, with the numbers and the count of all ranks, and its facets between them.

    A facet on a cut belongs to the rank whose basin has the smaller number; `facets` are numbered by own simplices.

    Parameters
    ----------
    part : MeshPart
        Simplices are numbered rank after rank.
    widths : (m, d+1) float
        Passage widths.
    """
    m, k = cuts.neighbors.shape[0], len(cuts.cells)
    numbers = cuts.with_others(part.cell_ids.astype(index_type(part.n_cells + 1)), part.n_cells)
    widest = comm.keep(widest_neighbors(cuts.neighbors, widths, numbers))[0]
    ahead = widest[cuts.cells] == m + np.arange(k)  # cut facets that lead on from their simplex
    first_of_pair = ahead & cuts.swapped(ahead) & (numbers[cuts.cells] < numbers[m : m + k])
    widest[cuts.cells[first_of_pair]] = cuts.cells[first_of_pair]
    del numbers
    joined, n_joined = joined_parts(np.concatenate([widest, np.arange(m, m + k + 1, dtype=np.int32)]))
    del widest
    joined = comm.keep(joined)[0]
    n_ends = n_joined - k - 1
    first, outside = comm.before(n_ends), comm.total(n_ends)
    ends = first + np.arange(n_ends)
    onward = _ends_beyond(comm, cuts, np.append(ends, outside), joined[:m], ahead & ~first_of_pair)
    basin = comm.keep(np.concatenate([ends, onward, [outside]]).astype(index_type(outside + 1))[joined[:m]])[0]
    del joined, ends, onward
    everywhere = cuts.with_others(basin, outside)
    facets = facets_between(cuts.neighbors, everywhere)
    across = everywhere[cuts.neighbors.reshape(-1)[facets]]
    here = basin[facets // cuts.neighbors.shape[1]]
    of_simplex = np.append(basin, everywhere[-1:])
    of_simplex, facets, here, across, wide = comm.keep(of_simplex, facets, here, across, widths.reshape(-1)[facets])
    return Basins(of_simplex, outside + 1, facets, here, across, wide)


def _ends_beyond(comm: Communicator, cuts: Cuts, ends: Ints, joined: Ints, leading: NDArray[np.bool_]) -> Ints:
    """(k,) basin that the way across each cut facet leads to; 0 where no simplex goes that way.

    Strategy: each rank has followed the ways of its simplices to their ends, or to a cut. What lies beyond a cut is
    the end of a way there, or another cut, -1 - its number among all. The ways from cut to cut the first rank follows.

    Parameters
    ----------
    ends : (e+1,) int
        Basins that end on this rank, and the outside's.
    joined : (m,) int
        Where the way of each own simplex ends here: e basins, then k cuts, then the outside.
    leading : (k,) bool
        Cut facets that a way crosses.
    """
    first = comm.before(len(leading))
    codes = np.concatenate([ends[:-1], -1 - first - np.arange(len(leading)), ends[-1:]])
    codes = codes.astype(index_type(max(int(ends[-1]), cuts.n_halves) + 1))
    beyond = cuts.swapped(codes[joined[cuts.cells]])
    links = np.flatnonzero(leading).astype(codes.dtype)
    route = Route(comm, np.zeros(len(links), np.intp))
    found = np.zeros(len(leading), codes.dtype)
    found[links] = route.back(
        _followed(*route.forward(np.stack([links + codes.dtype.type(first), beyond[links]], axis=1)).T)
    )
    return found


def _followed(names: Ints, onward: Ints) -> Ints:
    """Ends of the ways from each of `names` (increasing); `onward` is an end, or -1 - the next name."""
    onward = onward.copy()
    active = np.flatnonzero(onward < 0)
    while len(active):  # everybody looks one further, twice as far each time
        onward[active] = onward[np.searchsorted(names, -1 - onward[active])]
        active = active[onward[active] < 0]
    return onward


def tree_on_first(comm: Communicator, part: MeshPart, basins: Basins, rooms: Floats) -> GateTree | None:
    """The gate tree on the first rank, None on the others; its facets are numbered by the simplices of all ranks.

    Parameters
    ----------
    basins : Basins
        This rank's.
    rooms : (m,) float
        Room radii of its simplices.
    """
    own = _own_links(basins)
    start = comm.before(len(part)) * (part.mesh.dim + 1)
    pairs = comm.gather(np.stack([own.first, own.second], axis=1))
    facets = (start + own.facets.astype(np.int64)).astype(index_type((part.mesh.dim + 1) * part.n_cells))
    links = Links(pairs[:, 0], pairs[:, 1], comm.gather(own.width), comm.gather(facets))
    with_rooms, radii = _largest_rooms(basins.of_simplex[:-1], rooms)
    with_rooms, radii = comm.gather(with_rooms), comm.gather(radii)
    if comm.rank != 0:
        return None
    own_room = np.zeros(basins.count)
    np.maximum.at(own_room, with_rooms, radii)
    return gate_tree_of_links(basins, links.spanning(basins.count), own_room)


def _own_links(basins: Basins) -> Links:
    """The links of the maximum spanning forest of this rank's facets."""
    names, ends = np.unique(np.concatenate([basins.first, basins.second]), return_inverse=True)
    first, second = ends.reshape(2, -1)
    own = Links(first, second, basins.width, basins.facets).spanning(len(names))
    return replace(own, first=names[own.first], second=names[own.second])


def _largest_rooms(basin: Ints, rooms: Floats) -> tuple[Ints, Floats]:
    """Basins with rooms, and the radius of the largest room in each."""
    some = np.flatnonzero(rooms > 0)
    found, which = np.unique(basin[some], return_inverse=True)
    largest = np.zeros(len(found))
    np.maximum.at(largest, which.reshape(-1), rooms[some])
    return found, largest


def shared_on_first(comm: Communicator, shared: SharedFacets) -> SharedFacets:
    """Shared facets of all ranks, on the first one."""
    rows = comm.gather(np.stack([shared.pairs, shared.narrow, shared.all], axis=1).astype(np.int64))
    pairs, pair_of = np.unique(rows[:, 0], return_inverse=True)
    narrow, every = np.zeros((2, len(pairs)), np.int64)
    np.add.at(narrow, pair_of.reshape(-1), rows[:, 1])
    np.add.at(every, pair_of.reshape(-1), rows[:, 2])
    return replace(shared, pairs=pairs, narrow=narrow, all=every)


def rows_at_gates(comm: Communicator, tree: GateTree | None, part: MeshPart, rows: Ints) -> Ints:
    """(b, ...) what the owners of the gates' simplices say of these, on the first rank; none on the others.

    Parameters
    ----------
    tree : GateTree or None
        That of `tree_on_first`.
    rows : (m, ...) int
        Of own simplices.
    """
    cells = np.empty(0, np.int64) if tree is None else np.maximum(tree.facet, 0) // (part.mesh.dim + 1)
    ends = np.cumsum(np.concatenate(comm.allgather(np.array([len(part)]))))
    route = Route(comm, np.searchsorted(ends, cells, side="right"))
    return route.back(rows[route.forward(cells) - (ends[comm.rank] - len(part))])


def gate_arrays_of_part(
    comm: Communicator, tree: GateTree | None, part: MeshPart, cuts: Cuts, basins: Basins
) -> GateArrays:
    """The gate tree on this rank's simplices; the parents have the numbers of all ranks."""
    width = part.mesh.dim + 1
    numbers = cuts.with_others(part.cell_ids.astype(np.int64), -1)
    rows = np.concatenate([basins.of_simplex[:-1, None], numbers[cuts.neighbors]], axis=1)
    told = rows_at_gates(comm, tree, part, rows.astype(np.int64))
    parent, floats = np.empty(0, np.int64), np.empty((0, 2))
    if tree is not None:
        ahead = told[np.arange(len(told)), 1 + tree.facet % width]
        parent = beyond_gates(tree, tree.facet // width, ahead, told[:, 0]).astype(np.int64)
        floats = np.stack([tree.width, tree.room_radius], axis=1)
    basin = basins.of_simplex[:-1]
    floats, parent = comm.from_first(floats)[basin], comm.from_first(parent)[basin]
    return GateArrays(floats[:, 0], floats[:, 1], parent)
