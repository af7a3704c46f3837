"""Lines through Voronoi cells: between which places of a line a generator is the nearest.

On a line the squared distances to two generators differ by a linear function of the place, so each neighbour of a
generator bounds its interval from one side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import for_chunks

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# A place within this share of a line's length from where it ends may be that end, up to rounding.
ON_BORDER = 1e-9
LINES = 1 << 12  # lines at a time: some ten neighbours each


class Neighbours:
    """The Delaunay neighbours of the generators that are asked for; found when they are needed.

    Of a volume of points only those near its surface are asked for, so most of the mesh is never sorted.
    """

    def __init__(self, coordinates: Floats, simplices: Ints, asked: Bools) -> None:
        """Prepare for the generators where (n,) `asked` holds and those beside them."""
        self.coordinates, self._simplices = coordinates, simplices
        self._known = np.zeros(len(coordinates), bool)
        self._extend(asked)

    def _extend(self, asked: Bools) -> None:
        cells = self._simplices[asked[self._simplices].any(axis=1)]
        self._known |= asked
        self._known[cells] = True
        cells = self._simplices[self._known[self._simplices].any(axis=1)]
        self.keys = unique_edges(cells)
        low, high = split_keys(self.keys)
        ends = np.concatenate([low, high])
        others = np.concatenate([high, low])
        order = np.argsort(ends, kind="stable")
        self.targets = others[order]
        self._starts = np.searchsorted(ends[order], np.arange(len(self.coordinates) + 1))
        ways = self.coordinates[self.targets] - self.coordinates[ends[order]]
        self.ways = np.ascontiguousarray(ways.T)  # (d, total) to each neighbour: long rows are what NumPy is fast on
        self.squares = np.einsum("ka,ka->k", ways, ways)

    def of(self, generators: Ints) -> tuple[Ints, Ints]:
        """Rows of the neighbours of each generator in `targets`, one after another, and how many each has."""
        counts = self._starts[generators + 1] - self._starts[generators]
        offsets = np.cumsum(counts) - counts
        return np.arange(counts.sum()) + np.repeat(self._starts[generators] - offsets, counts), counts

    def prepare(self, generators: Ints) -> None:
        """Make sure that the neighbours of these generators are known."""
        if not self._known[generators].all():
            asked = self._known.copy()
            asked[generators] = True
            self._extend(asked)

    def joined(self, first: Ints, second: Ints) -> Bools:
        """Whether pairs are Delaunay edges; one of each pair must be prepared."""
        keys = edge_keys_of(first, second)
        place = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        return np.asarray(self.keys[place] == keys)


def unique_edges(simplices: Ints) -> Ints:
    """Keys of the edges of some simplices, ascending."""
    width = simplices.shape[1]
    pairs = [(i, j) for i in range(width) for j in range(i)]
    keys = np.concatenate([edge_keys_of(simplices[:, i], simplices[:, j]) for i, j in pairs])
    keys.sort()  # several times faster than np.unique, which hashes
    first = np.ones(len(keys), bool)
    first[1:] = keys[1:] != keys[:-1]
    return keys[first]


def found_in(values: NDArray, among: NDArray) -> Bools:
    """Which values are among others; by sorting, where `np.isin` would hash and be several times slower."""
    ranked = np.sort(among)
    place = np.searchsorted(ranked, values)
    found = np.zeros(len(values), bool)
    within = place < len(ranked)
    found[within] = ranked[place[within]] == values[within]
    return found


def edge_keys_of(first: Ints, second: Ints) -> NDArray[np.int64]:
    """One number per pair of points, whatever their order."""
    low, high = np.minimum(first, second).astype(np.int64), np.maximum(first, second).astype(np.int64)
    return (low << 32) | high


def split_keys(keys: Ints) -> tuple[Ints, Ints]:
    """The smaller and the larger point of each key."""
    return keys >> 32, keys & 0xFFFFFFFF


@dataclass(frozen=True)
class Intervals:
    """Where on a line a generator is the nearest.

    Attributes
    ----------
    low, high : (k,) float
        Empty where low >= high.
    before, after : (k,) int
        Generators that are nearer beyond the ends; -1 where the line itself ends first.
    """

    low: Floats
    high: Floats
    before: Ints
    after: Ints


def nearest_on_lines(
    neighbours: Neighbours, cells: Ints, beside: Ints, origins: Floats, ways: Floats, spans: Floats
) -> Intervals:
    """The part of each line on which a generator is the nearest one.

    Parameters
    ----------
    cells : (k,) int
        The generators.
    beside : (k,) int
        A neighbour that is not looked at (the line runs where both are equally near), -1 for none.
    origins, ways : (k, d) float
        The line is `origin + t * way`.
    spans : (k, 2) float
        Least and largest t.
    """
    k = len(cells)
    result = Intervals(np.empty(k), np.empty(k), np.empty(k, np.int64), np.empty(k, np.int64))
    neighbours.prepare(cells)

    def work(piece: slice) -> None:
        given = (cells[piece], beside[piece], origins[piece], ways[piece])
        candidates, counts, lower, upper = _bounds(neighbours, *given)
        offsets = np.cumsum(counts) - counts
        low, high = np.maximum.reduceat(lower, offsets), np.minimum.reduceat(upper, offsets)
        least, largest = spans[piece].T
        near = ON_BORDER * (largest - least)
        ended = _who(candidates, counts, lower == np.repeat(low, counts))
        result.before[piece] = np.where(low >= least - near, ended, -1)
        ended = _who(candidates, counts, upper == np.repeat(high, counts))
        result.after[piece] = np.where(high <= largest + near, ended, -1)
        result.low[piece], result.high[piece] = np.maximum(low, least), np.minimum(high, largest)

    for_chunks(work, k, chunk=LINES)
    return result


def _bounds(
    neighbours: Neighbours, cells: Ints, beside: Ints, origins: Floats, ways: Floats
) -> tuple[Ints, Ints, Floats, Floats]:
    """Neighbours of each cell, how many, and where each begins or ceases to be farther."""
    rows, counts = neighbours.of(cells)
    candidates = neighbours.targets[rows]
    own = 2 * (neighbours.coordinates[cells] - origins)
    gap, slope = neighbours.squares[rows], np.zeros(len(rows))  # how much farther the neighbour is at t = 0, squared
    for way, offset, step in zip(neighbours.ways, own.T, -2 * ways.T, strict=True):
        along = way[rows]
        gap += along * np.repeat(offset, counts)
        slope += along * np.repeat(step, counts)
    slope[candidates == np.repeat(beside, counts)] = np.nan  # neither greater nor less
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        place = -gap / slope
    lower, upper = np.where(slope > 0, place, -np.inf), np.where(slope < 0, place, np.inf)
    upper[(slope == 0) & (gap < 0)] = -np.inf
    return candidates, counts, lower, upper


def _who(candidates: Ints, counts: Ints, chosen: Bools) -> Ints:
    """The first chosen candidate of each line."""
    places = np.flatnonzero(chosen)
    line = np.repeat(np.arange(len(counts)), counts)[places]
    found = np.full(len(counts), -1, np.int64)
    found[line[::-1]] = candidates[places[::-1]]
    return found
