"""The order of the sons: which facets a node crosses first, as one byte per simplex.

3D: a node entered through a facet can cross the three others, each opposite one vertex of the entry facet. The
barycentre of the facet opposite vertex v is (sum of the vertices - v) / 3, so the facet with the smallest z is
the one opposite the vertex with the largest z: vertices are compared, no barycentre is computed, ties are exact.
First comes the facet with the smallest z; if exactly two tie for it, the remaining one; if all three tie, x and
then y decide in the same way, and if all coordinates tie (vertices that coincide) the vertex listed first. The
others follow counter-clockwise as seen from the entry facet, looking in.
2D: the left edge, then the right one, as seen from the entry edge.

What the order depends on, orientation and first facet for each of the d+1 entries, is a small number per simplex;
`CROSSINGS[dim][code, entry]` are the local indices of the vertices opposite the facets to cross, in order.
"""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.predicates import orientation_signs, signs_and_doubts

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Codes = NDArray[np.uint8]


def crossing_codes(mesh: Triangulation, tick: Tick = silent) -> Codes:
    """(m,) code of each simplex: twice its first-facet code, plus 1 where its vertices are negatively ordered.

    Strategy: signs and comparisons are taken on coordinates rounded to single precision, gathered one point at a
    time as one wide number; the few simplices this cannot decide are looked at again in full.
    """
    coordinates, dim = mesh.coordinates, mesh.dim
    table = _single_precision_rows(coordinates)
    codes = np.empty(len(mesh), np.uint8)

    def encode(piece: slice) -> None:
        simplices = mesh.simplices[piece]
        rows = np.take(table, simplices, mode="clip").view(np.float32).reshape(len(simplices), dim + 1, -1)
        by_axis = list(np.ascontiguousarray(rows.transpose(2, 1, 0)))[:dim]
        signs, doubts = signs_and_doubts(by_axis)
        if len(doubts):
            signs[doubts] = orientation_signs(coordinates[simplices[doubts]])
        codes[piece] = signs < 0
        if dim == 3:
            firsts, ties = first_facets(by_axis[2])
            if len(ties):
                firsts[ties] = tied_first_facets(coordinates[simplices[ties]])
            codes[piece] += 2 * firsts

    for_chunks(encode, len(mesh), tick)
    return codes


def _single_precision_rows(coordinates: Floats) -> NDArray[np.inexact]:
    """The points scaled into the unit cube in single precision, (x, y) or (x, y, z, 0) packed as one number each."""
    dim = coordinates.shape[1]
    low = coordinates.min(axis=0, initial=np.inf)
    extent = float((coordinates - low).max(initial=0.0)) or 1.0
    rows = np.zeros((len(coordinates), 2 if dim == 2 else 4), np.float32)
    rows[:, :dim] = (coordinates - low) / extent
    return rows.view(np.float64 if dim == 2 else np.complex128).ravel()


def first_facets(z: Singles) -> tuple[Codes, NDArray[np.intp]]:
    """(m,) base-3 number whose digits, entry 0 first, say which of the three facets ahead comes first.

    Also the indices of the simplices with two vertices at the same z, for which the number is not valid.
    """
    above = {pair: z[pair[0]] > z[pair[1]] for pair in combinations(range(4), 2)}
    number = np.zeros(z.shape[1], np.uint8)
    for a, b, c in AHEAD[3]:
        not_first = ~(above[a, b] & above[a, c])
        number *= np.uint8(3)
        number += not_first.view(np.uint8)
        number += (not_first & ~above[b, c]).view(np.uint8)
    tied = np.logical_or.reduce([z[i] == z[j] for i, j in above])
    return number, np.flatnonzero(tied)


def tied_first_facets(corners: Floats) -> Codes:
    """The number of `first_facets` by all the rules, from (m, 4, 3) corners."""
    x, y, z = corners.T
    number = np.zeros(len(corners), np.uint8)
    for ahead in AHEAD[3]:
        number = 3 * number + _first_of_three([axis[ahead] for axis in (z, x, y)])
    return number


def _first_of_three(keys: list[Floats]) -> Codes:
    """Index 0, 1 or 2 of the facet ahead that comes first, from (3, m) keys in the order they are compared."""
    choice = np.zeros(keys[0].shape[1], np.intp)
    for key in reversed(keys):
        largest = key == key.max(axis=0)
        count = largest.sum(axis=0)
        alone = np.where(count == 1, largest.argmax(axis=0), largest.argmin(axis=0))
        choice = np.where(count == 3, choice, alone)
    return choice.astype(np.uint8)


def _ahead(dim: int) -> list[list[int]]:
    """For each entry (the vertex opposite the entry facet) the vertices opposite the facets ahead."""
    return [[v for v in range(dim + 1) if v != entry] for entry in range(dim + 1)]


def _turned(ahead: list[int], entry: int, negative: int) -> list[int]:
    """The facets ahead counter-clockwise as seen through the entry facet.

    Moving vertex `entry` to the end takes d - entry swaps, each of which flips the orientation. With the apex last
    and positive orientation, the entry facet's vertices run clockwise for who looks in through it.
    """
    dim = len(ahead)
    clockwise = (dim - entry + negative) % 2 == 0
    return ahead[::-1] if clockwise else ahead


def _crossings(dim: int) -> Codes:
    table = np.zeros((2 * 3 ** (dim + 1) if dim == 3 else 2, dim + 1, dim), np.uint8)
    for code, entry in product(range(len(table)), range(dim + 1)):
        ahead = _turned(AHEAD[dim][entry], entry, code % 2)
        if dim == 3:
            first = AHEAD[3][entry][code // 2 // 3 ** (3 - entry) % 3]
            at = ahead.index(first)
            ahead = ahead[at:] + ahead[:at]
        table[code, entry] = ahead
    return table


AHEAD = {2: _ahead(2), 3: _ahead(3)}
CROSSINGS = {2: _crossings(2), 3: _crossings(3)}
