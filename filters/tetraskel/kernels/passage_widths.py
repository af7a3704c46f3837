"""How large a ball fits: through a facet, and inside a simplex.

Both come from the corners' differences alone, so they follow the unit, and neither rotation nor a shift matters
beyond rounding.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.loops_in_python import run_compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# A circumcentre on a facet belongs to both simplices: on a lattice rounding must not give it to neither. Barycentric
# coordinates have no unit.
ON_FACET = 1e-9


def triangle_widths(squares: Floats) -> Floats:
    """Passage widths (...) of triangles given by their (3, ...) squared edges, in the unit of the edges.

    The largest distance from a triangle's points to its corners. Acute: the circumradius. Obtuse, with edges
    lo <= mid <= hi: where the bisector of `mid` meets `hi`, at mid^2 hi / (hi^2 + mid^2 - lo^2) from a corner; the
    circumradius would make a wide door of a thin triangle in a flat patch. A triangle without area is obtuse, and
    both denominators stay well away from 0: the acute one is at least 3 lo^2 mid^2. Where that is too small for a
    double, among points nearer than 1e-80 to one another, the width is 0.
    """
    first, second, third = squares
    small, large = np.minimum(first, second), np.maximum(first, second)
    high = np.maximum(large, third)
    middle = np.maximum(small, np.minimum(large, third))
    low = np.minimum(small, third)
    bend = low + middle - high  # 2 lo mid cos(angle opposite hi)
    obtuse = bend <= 0
    lever = high + middle - low
    top = np.where(obtuse, middle, low)
    bottom = np.where(obtuse, lever * lever, 4 * low * middle - bend * bend)
    product = top * middle * high
    return np.sqrt(np.divide(product, bottom, out=np.zeros_like(product), where=bottom > 0))


def passage_widths(coordinates: Floats, simplices: Ints, tick: Tick = silent) -> Floats:
    """(m, d+1) radius of the largest ball that fits through the facet opposite each vertex.

    Parameters
    ----------
    coordinates : (n, d) float
    simplices : (m, d+1) int

    Returns
    -------
    (m, d+1) float
        Half the edge's length in 2D, `triangle_widths` in 3D, in the unit of the coordinates. Both sides of a
        facet have equal numbers, to the last bit.
    """
    widths = np.empty(simplices.shape)

    def work(piece: slice) -> None:
        widths[piece] = _facet_widths(corners_by_axis(coordinates, simplices[piece])).T

    for_chunks(work, len(simplices), tick)
    return widths


def room_radii(coordinates: Floats, simplices: Ints, tick: Tick = silent) -> Floats:
    """(m,) circumradii of the simplices that contain their own circumcentre, 0 for the others.

    Such a simplex is a *room*: its ball is the largest of its neighbourhood, and by Delaunay's property no point
    lies in it.
    """
    radii = np.empty(len(simplices))

    def work(piece: slice) -> None:
        radii[piece] = _rooms(corners_by_axis(coordinates, simplices[piece]))

    for_chunks(work, len(simplices), tick)
    return radii


def widths_and_rooms(coordinates: Floats, simplices: Ints, tick: Tick = silent) -> tuple[Floats, Floats]:
    """`passage_widths` and `room_radii` in one pass over the corners."""
    widths, radii = np.empty(simplices.shape), np.empty(len(simplices))
    if simplices.shape[1] == 4 and run_compiled(
        "widths_and_rooms", (coordinates,), (simplices,), (widths, radii), tick
    ):
        return widths, radii

    def work(piece: slice) -> None:
        corners = corners_by_axis(coordinates, simplices[piece])
        widths[piece] = _facet_widths(corners).T
        radii[piece] = _rooms(corners)

    for_chunks(work, len(simplices), tick)
    return widths, radii


def widths_of_facets(coordinates: Floats, facets: Ints, tick: Tick = silent) -> Floats:
    """(k,) passage widths of single facets, given by their (k, d) points."""
    widths = np.empty(len(facets))
    if facets.shape[1] == 3 and run_compiled("widths_of_triangles", (coordinates,), (facets,), (widths,), tick):
        return widths

    def work(piece: slice) -> None:
        corners = corners_by_axis(coordinates, facets[piece])
        pairs = combinations(range(corners.shape[1]), 2)
        squares = np.stack([np.sum((corners[:, i] - corners[:, j]) ** 2, axis=0) for i, j in pairs])
        widths[piece] = triangle_widths(squares) if len(squares) == 3 else 0.5 * np.sqrt(squares[0])

    for_chunks(work, len(facets), tick)
    return widths


def corners_by_axis(coordinates: Floats, simplices: Ints) -> Floats:
    """(d, d+1, k) coordinates of the corners of k simplices: long rows are what NumPy is fast on."""
    return np.ascontiguousarray(np.take(coordinates, simplices.T, axis=0).transpose(2, 0, 1))


def _facet_widths(corners: Floats) -> Floats:
    """(d+1, k) passage widths from (d, d+1, k) corners."""
    n_corners = corners.shape[1]
    pairs = list(combinations(range(n_corners), 2))
    squares = np.empty((len(pairs), corners.shape[2]))
    for row, (i, j) in zip(squares, pairs, strict=True):
        # squares of differences forget their sign, so that both sides of a facet compute the same number
        np.sum((corners[:, i] - corners[:, j]) ** 2, axis=0, out=row)
    if n_corners == 3:
        return 0.5 * np.sqrt(squares[::-1])  # pairs 01, 02, 12 lie opposite 2, 1, 0
    edges = [[row for row, pair in enumerate(pairs) if vertex not in pair] for vertex in range(n_corners)]
    return np.stack([triangle_widths(squares[of_facet]) for of_facet in edges])


def circumscribed(corners: Floats) -> tuple[Floats, Floats, Bools]:
    """Circumcentres relative to the first corner, from (d, d+1, k) corners, before the division.

    Returns
    -------
    centre : (d, k) float
        Times 2 volume.
    volume : (k,) float
        Signed, times d!; 0 where there is no circumcentre.
    contained : (k,) bool
        The simplex contains its circumcentre.
    """
    sides = corners[:, 1:] - corners[:, :1]
    normals, volume = _cofactors(sides)
    lengths = np.einsum("aik,aik->ik", sides, sides)
    centre = np.einsum("ik,aik->ak", lengths, normals)
    weights = np.einsum("ak,aik->ik", centre, normals)  # times 2 volume^2: its barycentric coordinates but the first
    whole = 2 * volume * volume
    lowest = np.minimum(weights.min(axis=0), whole - weights.sum(axis=0))
    return centre, volume, (lowest >= -ON_FACET * whole) & (whole > 0)


def _rooms(corners: Floats) -> Floats:
    """(k,) room radii from (d, d+1, k) corners."""
    centre, volume, is_room = circumscribed(corners)
    radii = np.zeros(corners.shape[2])
    np.divide(np.sqrt(np.einsum("ak,ak->k", centre, centre)), 2 * np.abs(volume), out=radii, where=is_room)
    return radii


def _cofactors(sides: Floats) -> tuple[Floats, Floats]:
    """Vectors (d, d, k) with side_i . vector_j = volume where i = j, else 0; and the (k,) volumes (times d!)."""
    normals = np.empty_like(sides)
    if len(sides) == 2:
        normals[0, 0], normals[1, 0] = sides[1, 1], -sides[0, 1]
        normals[0, 1], normals[1, 1] = -sides[1, 0], sides[0, 0]
    else:
        for i in range(3):
            u, v = sides[:, (i + 1) % 3], sides[:, (i + 2) % 3]
            for axis in range(3):
                p, q = (axis + 1) % 3, (axis + 2) % 3
                normals[axis, i] = u[p] * v[q] - u[q] * v[p]
    return normals, np.einsum("ak,ak->k", sides[:, 0], normals[:, 0])
