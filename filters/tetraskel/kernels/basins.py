"""Simplices gathered into basins: each joined to the one across its widest facet.

These joins are part of every maximum spanning tree of the dual graph, and one to seven per cent as many basins are
left as there are simplices, so that all that follows is cheap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import CHUNK, for_chunks
from tetraskel.kernels.spanning_tree import joined_parts

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class Basins:
    """Groups of simplices, the outside being the last group.

    Attributes
    ----------
    of_simplex : (m+1,) int
        Basin of each simplex; the last entry stands for the outside.
    count : int
        Number of basins, the outside's included; that one has the number count - 1.
    facets : (k,) int
        The facets between two basins as simplex * (d+1) + opposite vertex, each once.
    first, second : (k,) int
        The basins a facet separates.
    width : (k,) float
        Its passage width, in the unit of the points.
    """

    of_simplex: Ints
    count: int
    facets: Ints
    first: Ints
    second: Ints
    width: Floats


def gather_basins(neighbors: Ints, widths: Floats) -> Basins:
    """Basins of simplices from their (m, d+1) neighbours and passage widths."""
    widest = widest_neighbors(neighbors, widths)
    of_simplex, count = joined_parts(np.append(widest, len(neighbors)))
    facets = facets_between(neighbors, of_simplex)
    cells = facets // neighbors.shape[1]
    across = neighbors.ravel()[facets]  # -1 is the outside: the last entry of of_simplex
    return Basins(of_simplex, count, facets, of_simplex[cells], of_simplex[across], widths.ravel()[facets])


def widest_neighbors(neighbors: Ints, widths: Floats, numbers: Ints | None = None) -> NDArray[np.int32]:
    """(m,) simplex across the widest facet of each, m for the outside.

    Of equally wide ones the neighbour with the largest number: the order (width, larger simplex, smaller simplex)
    of facets is strict, as `joined_parts` needs it.

    Parameters
    ----------
    neighbors : (m, d+1) int
    widths : (m, d+1) float
    numbers : (n,) int, optional
        Of all that `neighbors` names, where more than these simplices have neighbours here; the last is the outside,
        whose index n - 1 then stands for it. By default each is its own number.
    """
    m, width = neighbors.shape
    widest = np.empty(m, np.int32)
    outside = m if numbers is None else len(numbers) - 1

    def work(piece: slice) -> None:
        ahead, wide = neighbors[piece], widths[piece]
        best, choice = wide[:, 0].copy(), np.where(ahead[:, 0] < 0, outside, ahead[:, 0])
        for k in range(1, width):
            other = np.where(ahead[:, k] < 0, outside, ahead[:, k])
            later = other > choice if numbers is None else numbers[other] > numbers[choice]
            better = (wide[:, k] > best) | ((wide[:, k] == best) & later)
            best, choice = np.where(better, wide[:, k], best), np.where(better, other, choice)
        widest[piece] = choice

    for_chunks(work, m)
    return widest


def facets_between(neighbors: Ints, of_simplex: Ints) -> Ints:
    """Facets between different basins, seen from the basin with the smaller number, in order.

    `of_simplex` holds a basin for all that `neighbors` names, and at last the outside's.
    """
    m, width = neighbors.shape
    found: list[Ints] = [np.empty(0, np.intp)] * (m // CHUNK + 1)

    def work(piece: slice) -> None:
        here = of_simplex[piece, None]
        found[piece.start // CHUNK] = np.flatnonzero(of_simplex[neighbors[piece]] > here) + piece.start * width

    for_chunks(work, m)
    return np.concatenate(found)
