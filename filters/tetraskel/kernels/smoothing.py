"""Inside made smoother: simplices change sides where that makes the surface between the sides smaller.

Flat simplices in the surface itself belong to neither side; where such ones are put at random, they leave handles
and pits no larger than themselves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import for_chunks
from tetraskel.kernels.loops_in_python import run_compiled
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.passage_widths import corners_by_axis

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]
Array = NDArray[Any]

ROUNDS = 8  # hardly anything moves after the third


class Border:
    """What other parts of a mesh say of simplices next to this one's; the parts go through the rounds together.

    This is the border of a whole mesh, with nobody behind it.
    """

    def keep(self, *arrays: Array) -> list[Array]:
        """Arrays that are used again after the others were heard."""
        return list(arrays)

    def is_anybody(self, here: bool) -> bool:
        """Whether any part says yes."""
        return here

    def gains(self, willing: Ints, gain: Floats) -> tuple[Ints, Floats]:
        """Tell the gains of own simplices; those told of here, increasing, with indices above all own ones."""
        return willing[:0], gain[:0]

    def moved(self, moving: Ints) -> tuple[Ints, Ints]:
        """Tell which own simplices changed sides; of those told of here the indices, and the own ones beside them."""
        return moving[:0], moving[:0]


def smaller_surface(mesh: Triangulation, inside: Bools) -> Bools:
    """(m,) inside after single simplices have changed sides while the surface shrinks by it."""
    return settled(mesh, np.append(inside, False), Border())[:-1]


def settled(mesh: Triangulation, side: Bools, border: Border) -> Bools:
    """(n,) the sides after the moves that make the surface smaller.

    Strategy: a simplex gains by changing sides when more of its own surface lies between the sides than not. Of
    adjacent ones that would gain only the one that gains most moves, all at once, so that the order of the
    simplices does not matter; then only the moved, their neighbours and the disappointed look again.

    Parameters
    ----------
    mesh : Triangulation
        Whole, or a part whose neighbours name simplices of other parts, too, with numbers from m on.
    side : (n,) bool
        Of its m simplices, of those beyond, and at last of the outside.
    border : Border
        The way to the other parts.
    """
    side, candidates = border.keep(side.copy(), on_surface(mesh.neighbors, side))
    for _ in range(ROUNDS):
        gain = _gains(mesh, side, candidates)
        willing, gain = border.keep(candidates[gain > 0], gain[gain > 0])
        if not border.is_anybody(len(willing) > 0):
            break
        others, their_gain = border.gains(willing, gain)
        known, known_gain = np.concatenate([willing, others]), np.concatenate([gain, their_gain])
        moving = willing[gain > _best_neighbor(mesh.neighbors[willing], known, known_gain)]
        beyond, beside = border.moved(moving)
        side[moving], side[beyond] = ~side[moving], ~side[beyond]
        again = np.concatenate([willing, mesh.neighbors[moving].ravel(), beside])
        candidates = np.unique(again[(again >= 0) & (again < len(mesh))])
    return side


def on_surface(neighbors: Ints, side: Bools) -> Ints:
    """Simplices with a neighbour on the other side; `side` is that of all neighbours, and at last the outside's."""
    found = np.empty(len(neighbors), bool)

    def work(piece: slice) -> None:
        found[piece] = (side[neighbors[piece]] != side[piece, None]).any(axis=1)

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


def _best_neighbor(ahead: Ints, cells: Ints, gain: Floats) -> Floats:
    """(k,) largest gain among neighbours (k, d+1); `cells` (increasing) with these gains are all that gain."""
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
