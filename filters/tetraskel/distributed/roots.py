"""Where the trees of a triangulation spread over ranks begin, and which pieces it has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.communicator import Communicator, Route
from tetraskel.distributed.parts import MeshPart
from tetraskel.kernels.adjacency import facet_points
from tetraskel.kernels.pieces import label_pieces
from tetraskel.kernels.predicates import exact_integers
from tetraskel.kernels.roots import first_facets_by_piece

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def root_facets(comm: Communicator, part: MeshPart, pieces: Ints) -> tuple[Ints, Ints, Ints, int]:
    """First hull facet of each piece of all ranks, by the rule of `first_facets_by_piece`.

    Parameters
    ----------
    pieces : (m,) int
        Piece of each own simplex, with one name on all ranks.

    Returns
    -------
    cells, entries, trees : (r,) int
        This rank's root simplices, the vertices opposite their facets, and the trees' numbers, increasing.
    n_trees : int
        On all ranks.
    """
    cells, entries, names = _own_first_facets(part, pieces)
    del pieces
    facets = facet_points(part.mesh.simplices, cells.astype(np.int64) * (part.mesh.dim + 1) + entries)
    corners = np.concatenate(comm.allgather(part.mesh.coordinates[facets].reshape(len(cells), part.mesh.dim**2)))
    mine = np.column_stack([names, np.full(len(cells), comm.rank), np.arange(len(cells))])
    rows = np.column_stack([mine, part.point_ids[facets].reshape(len(cells), part.mesh.dim)]).astype(np.int64)
    rows = np.concatenate(comm.allgather(rows))
    firsts = _first_of_each(corners.reshape(-1, part.mesh.dim, part.mesh.dim), rows[:, 0], rows[:, 3:])
    trees = np.flatnonzero(rows[firsts, 1] == comm.rank)
    own = rows[firsts[trees], 2]
    return cells[own].astype(np.int64), entries[own], trees, len(firsts)


def _own_first_facets(part: MeshPart, pieces: Ints) -> tuple[Ints, Ints, Ints]:
    """Of each piece the first hull facet that this rank has: its simplex, the vertex opposite, and the piece."""
    _, local = np.unique(pieces, return_inverse=True)
    neighbors = part.mesh.neighbors.copy()
    neighbors.reshape(-1)[part.halves] = 0  # not a border, whichever simplex is there
    cells, entries = first_facets_by_piece(replace(part.mesh, neighbors=neighbors), local.reshape(-1))
    return cells, entries, pieces[cells]


def _first_of_each(corners: Floats, pieces: Ints, ids: Ints) -> Ints:
    """Indices of the first facet of each piece, these in their order."""
    sums = [exact_integers(corners[:, :, axis]).sum(axis=1).tolist() for axis in range(corners.shape[2])]
    keys = list(zip(*sums, *ids.T.tolist(), strict=True))
    first: dict[int, int] = {}
    for index in sorted(range(len(keys)), key=keys.__getitem__):
        first.setdefault(int(pieces[index]), index)
    return np.array(list(first.values()), np.int64)


def joined_pieces(comm: Communicator, part: MeshPart) -> Ints:
    """(m,) piece of each own simplex; a piece on several ranks has one name.

    Strategy: each rank labels its own pieces; which of them touch across ranks is told to all, without repetition: that
    is about one pair for each two ranks whose pieces touch.
    """
    own = label_pieces(part.mesh.neighbors).astype(np.int64)
    first = comm.before(int(own.max(initial=-1)) + 1)
    width = part.mesh.dim + 1
    mine = first + own[part.halves // width]
    route = Route(comm, part.ranks)
    touched = route.forward(np.stack([part.mates, mine], axis=1))
    pairs = np.unique(np.stack([first + own[touched[:, 0] // width], touched[:, 1]], axis=1), axis=0)
    all_pairs = np.concatenate(comm.allgather(pairs))
    n_labels = comm.total(int(own.max(initial=-1)) + 1)
    return _joined(all_pairs, n_labels)[first + own]


def _joined(pairs: Ints, n: int) -> Ints:
    """(n,) smallest label that each label is joined to by pairs."""
    label = np.arange(n)
    while len(pairs):
        a, b = label[pairs].T
        if np.array_equal(a, b):
            break
        np.minimum.at(label, np.maximum(a, b), np.minimum(a, b))
        while not np.array_equal(label, jumped := label[label]):
            label = jumped
    return label
