"""The order of insertion: biased randomised rounds, along a Hilbert curve inside each.

Amenta, Choi and Rote 2003: each point goes to the last round with a fixed probability, to the one before with the same
probability of what is left, and so on. The expected work is that of a random order, and because points of a round come
in an order that is coherent in space, the search for each starts near it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.compilation import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST_ROUND = 100  # points; fewer rounds do not pay
BITS = {2: 20, 3: 13}  # of each coordinate along the Hilbert curve
SHARE_BITS = 2  # a point stays for the last round with probability 1 - 2**-SHARE_BITS


def insertion_order(points: Floats, seed: int) -> Ints:
    """Indices of (n, d) points in the order of insertion.

    A function of the points' order and the seed; the points come sorted by their coordinates, so of these alone.
    """
    low, dim = points.min(axis=0), points.shape[1]
    extent = float((points - low).max()) or 1.0
    codes = hilbert_codes(points.ravel(), low, float((1 << BITS[dim]) / extent), BITS[dim])
    rounds = _rounds(len(points), seed)
    codes |= rounds << np.uint64(BITS[dim] * dim)
    return np.argsort(codes, kind="stable")


def _rounds(n: int, seed: int) -> NDArray[np.uint64]:
    """(n,) round of each point: the last one is the largest."""
    last = max(int(np.log2(max(n, FIRST_ROUND) / FIRST_ROUND)) // SHARE_BITS, 0)
    bits = np.random.Generator(np.random.PCG64(seed)).integers(0, 1 << 62, n, dtype=np.int64)
    rounds = np.full(n, last, np.uint64)
    for back in range(1, last + 1):
        rounds[(bits & ((1 << (SHARE_BITS * back)) - 1)) == 0] = last - back
    return rounds


@compiled
def hilbert_codes(points, low, scale, bits):
    """Places of points (flat) along a Hilbert curve of 2**bits cells per axis.

    From the most significant bit down, the cell's corner is turned into its place among the 2**d corners, and the rest
    of the coordinates is reflected and exchanged as the curve turns there (Skilling 2004, "Programming the Hilbert
    curve"; his bits are interleaved here while they are made).
    """
    dim = len(low)
    n = len(points) // dim
    codes = np.zeros(n, np.uint64)
    cell = np.zeros(dim, np.int64)
    top = (1 << bits) - 1
    for i in range(n):
        for axis in range(dim):
            cell[axis] = min(top, np.int64((points[dim * i + axis] - low[axis]) * scale))
        codes[i] = _code(cell, dim, bits)
    return codes


@compiled
def _code(cell, dim, bits):
    for level in range(bits - 1, 0, -1):
        mask = (1 << level) - 1
        for axis in range(dim):
            if (cell[axis] >> level) & 1:
                cell[0] ^= mask
            else:
                changed = (cell[0] ^ cell[axis]) & mask
                cell[0] ^= changed
                cell[axis] ^= changed
    for axis in range(1, dim):
        cell[axis] ^= cell[axis - 1]
    flips = 0
    for level in range(bits - 1, 0, -1):
        if (cell[dim - 1] >> level) & 1:
            flips ^= (1 << level) - 1
    code = 0
    for level in range(bits - 1, -1, -1):
        for axis in range(dim):
            code = (code << 1) | (((cell[axis] ^ flips) >> level) & 1)
    return np.uint64(code)
