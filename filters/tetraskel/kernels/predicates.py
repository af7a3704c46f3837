"""On which side: exact signs of determinants, at the speed of floating point.

A filter decides almost every case; the rest is computed again in integers of any length.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# Rounding of a d x d determinant of coordinate differences: each of its d! products carries at most d roundings of
# differences, d - 1 of multiplications and d! of additions. With unit roundoff u and M the largest difference the
# error is below d! (2d + d!) u M**d: 12 u M**2 in 2D, 72 u M**3 in 3D.
ROUNDINGS = {2: 16.0, 3: 80.0}
# Coordinates in the unit cube rounded to single precision are off by up to u, differences by 2u, the d! d factors
# by d! d 2u M**(d-1): 8 u M in 2D, 36 u M**2 in 3D; with the roundings above (M <= 1) below this times u M**(d-1).
ROUNDED_INPUT = {2: 32.0, 3: 128.0}
U64, U32 = 2.0**-53, 2.0**-24
TINY = 1e-290  # below this, products may have lost bits to underflow and the filter is not to be trusted


def determinant(rows: list[list[NDArray]]) -> NDArray:
    """Determinant of 2 x 2 or 3 x 3 matrices given entry by entry, for floats or Python integers alike."""
    if len(rows) == 2:
        (a, b), (c, d) = rows
        return a * d - b * c
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def signs_and_doubts(by_axis: list[Floats]) -> tuple[NDArray[np.int8], Ints]:
    """Orientation signs (m,) of simplices in floating point, and the indices of those that are not certain.

    Parameters
    ----------
    by_axis : d arrays (d+1, m)
        Coordinates of each vertex, axis by axis: exact in double precision, or scaled to the unit cube and
        rounded to single precision.
    """
    dim = len(by_axis)
    rows = [[axis[vertex] - axis[0] for axis in by_axis] for vertex in range(1, dim + 1)]
    volume = determinant(rows)
    size = np.maximum.reduce([np.abs(entry, out=entry) for row in rows for entry in row])
    if volume.dtype == np.float32:
        bound = size ** (dim - 1) * np.float32(ROUNDED_INPUT[dim] * U32)
    else:
        bound = np.maximum(size**dim * (ROUNDINGS[dim] * U64), TINY)
    return np.sign(volume).astype(np.int8), np.flatnonzero(~(np.abs(volume) > bound))


def orientation_signs(corners: Floats) -> NDArray[np.int8]:
    """Exact orientation signs (m,), never 0, of simplices given by their (m, d+1, d) corners."""
    signs, doubts = signs_and_doubts(list(corners.T))
    if len(doubts):
        signs[doubts] = exact_signs(corners[doubts])
    return signs


def exact_integers(values: Floats) -> NDArray[np.object_]:
    """`values` times one common power of two, as Python integers: exact."""
    mantissas, exponents = np.frexp(values)
    whole = (mantissas * 2.0**53).astype(np.int64).astype(object)
    shift = np.where(values == 0, 0, exponents - exponents[values != 0].min(initial=0))
    return np.asarray(whole << shift.astype(object), dtype=object)


def exact_signs(corners: Floats) -> NDArray[np.int8]:
    """Exact orientation signs of (m, d+1, d) simplices; where it is 0, that of the corners in coordinate order.

    A simplex without volume has no side of its own. Taking its corners sorted by coordinates as the positive
    order gives it one that neither point ids nor the order of the points can change.
    """
    whole = exact_integers(corners)
    edges = whole[:, 1:] - whole[:, :1]
    rows = [list(edges[:, i].T) for i in range(edges.shape[1])]
    signs = np.sign(determinant(rows)).astype(np.int8)
    flat = signs == 0
    signs[flat] = coordinate_parity(corners[flat])
    return signs


def coordinate_parity(corners: Floats) -> NDArray[np.int8]:
    """Parity (+1, -1) of the permutation that sorts each simplex's (m, d+1, d) corners by coordinates."""
    parity = np.ones(len(corners), np.int8)
    for i, j in combinations(range(corners.shape[1]), 2):
        parity[lexicographically_less(corners[:, j], corners[:, i])] *= -1
    return parity


def lexicographically_less(a: Floats, b: Floats) -> NDArray[np.bool_]:
    """Whether points `a` come before points `b` by first coordinate, then second, then third."""
    less = np.zeros(len(a), bool)
    for axis in reversed(range(a.shape[1])):
        less = (a[:, axis] < b[:, axis]) | ((a[:, axis] == b[:, axis]) & less)
    return less
