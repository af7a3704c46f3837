"""Inside made smoother: simplices change sides where that makes the surface between the sides smaller.

Flat simplices in the surface itself belong to neither side; where such ones are put at random, they leave handles
and pits no larger than themselves.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import for_chunks
from tetraskel.kernels.loops_in_python import run_compiled
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.passage_widths import corners_by_axis

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

ROUNDS = 8  # hardly anything moves after the third


def smaller_surface(mesh: Triangulation, inside: Bools) -> Bools:
    """(m,) inside after single simplices have changed sides while the surface shrinks by it.

    Strategy: a simplex gains by changing sides when more of its own surface lies between the sides than not. Of
    adjacent ones that would gain only the one that gains most moves, all at once, so that the order of the
    simplices does not matter; then only the moved, their neighbours and the disappointed look again.
    """
    side = np.append(inside, False)
    candidates = on_surface(mesh.neighbors, side)
    for _ in range(ROUNDS):
        gain = _gains(mesh, side, candidates)
        willing, gain = candidates[gain > 0], gain[gain > 0]
        if len(willing) == 0:
            break
        moving = willing[gain > _best_neighbor(mesh.neighbors, willing, gain)]
        side[moving] = ~side[moving]
        again = np.concatenate([willing, mesh.neighbors[moving].ravel()])
        candidates = np.unique(again[again >= 0])
    return side[:-1]


def on_surface(neighbors: Ints, side: Bools) -> Ints:
    """Simplices with a neighbour on the other side; `side` is (m+1,), its last entry the outside's."""
    found = np.empty(len(neighbors), bool)

    def work(piece: slice) -> None:
        found[piece] = (side[neighbors[piece]] != side[:-1][piece, None]).any(axis=1)

    for_chunks(work, len(neighbors))
    return np.flatnonzero(found)


def _gains(mesh: Triangulation, side: Bools, cells: Ints) -> Floats:
    """(k,) by how much the surface would shrink if each simplex changed sides alone."""
    gain = np.empty(len(cells))
    constants = (mesh.coordinates, mesh.simplices, mesh.neighbors, side)
    if mesh.dim == 3 and run_compiled("gains", constants, (cells,), (gain,)):
        return gain

    def work(piece: slice) -> None:
        some = cells[piece]
        sizes = facet_sizes(corners_by_axis(mesh.coordinates, mesh.simplices[some]))
        gain[piece] = np.where(side[some] != side[mesh.neighbors[some]].T, sizes, -sizes).sum(axis=0)

    for_chunks(work, len(cells))
    return gain


def _best_neighbor(neighbors: Ints, cells: Ints, gain: Floats) -> Floats:
    """(k,) largest gain among the neighbours of each of `cells` (increasing), which are all that gain."""
    ahead = neighbors[cells]
    at = np.minimum(np.searchsorted(cells, ahead), len(cells) - 1)
    return np.where(cells[at] == ahead, gain[at], 0).max(axis=1)


def facet_sizes(corners: Floats) -> Floats:
    """(d+1, k) length or area of the facet opposite each vertex, from (d, d+1, k) corners."""
    sizes = np.empty(corners.shape[1:])
    for vertex in range(len(sizes)):
        first, *others = (corners[:, other] for other in range(len(sizes)) if other != vertex)
        sides = [other - first for other in others]
        if len(sides) == 1:
            sizes[vertex] = np.sqrt((sides[0] ** 2).sum(axis=0))
        else:
            sizes[vertex] = 0.5 * np.sqrt((np.cross(sides[0], sides[1], axis=0) ** 2).sum(axis=0))
    return sizes
