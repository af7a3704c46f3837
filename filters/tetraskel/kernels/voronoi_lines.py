"""Lines through Voronoi cells: between which places of a line a generator is the nearest.

On a line the squared distances to two generators differ by a linear function of the place, so each neighbour of a
generator bounds its interval from one side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.barycentric import dots
from tetraskel.kernels.chunks import for_chunks

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

# A place within this share of a line's length from where it ends may be that end, up to rounding.
ON_BORDER = 1e-9
MOST_BITS = 63
LINES = 1 << 12  # lines at a time: some ten neighbours each


class Neighbours:
    """The Delaunay neighbours of the generators that are asked for; found when they are needed.

    Of a volume of points only those near its surface are asked for, so most of the mesh is never sorted.
    """

    def __init__(self, coordinates: Floats, simplices: Ints, asked: Bools) -> None:
        """Prepare for the generators where (n,) `asked` holds and those beside them."""
        n, dim = coordinates.shape
        self.coordinates, self._simplices = coordinates, simplices
        self._known = np.zeros(n, bool)
        self._first, self._count = np.zeros(n, np.int64), np.zeros(n, np.int64)
        self._pairs = self.targets = np.empty(0, np.int64)
        self.ways = np.empty((dim, 0))  # (d, total) to each neighbour: long rows are what NumPy is fast on
        self.squares = np.empty(0)
        self._n_rows = 0
        columns = [asked[column] for column in simplices.T]
        self._extend(np.flatnonzero(np.logical_or.reduce(columns)))

    @cached_property
    def _around(self) -> tuple[Ints, Ints]:
        """Simplices around each generator, one after another, and where each begins."""
        m, width = self._simplices.shape
        if len(self._known).bit_length() + m.bit_length() > MOST_BITS:
            order = np.argsort(self._simplices, axis=None, kind="stable")
            return order // width, np.searchsorted(self._simplices.ravel()[order], np.arange(len(self._known) + 1))
        bits = m.bit_length()  # several times faster to sort one number than to find the order of another
        names = ((self._simplices.T.astype(np.int64) << bits) | np.arange(m)).ravel()
        names.sort()
        return names & ((1 << bits) - 1), np.searchsorted(names >> bits, np.arange(len(self._known) + 1))

    def _cells_around(self, generators: Ints) -> Ints:
        """Simplices that have one of the generators."""
        if 4 * len(generators) > len(self._known):
            asked = np.zeros(len(self._known), bool)
            asked[generators] = True
            return np.flatnonzero(np.logical_or.reduce([asked[column] for column in self._simplices.T]))
        cells, starts = self._around
        return _once(cells[ranges(starts[generators], starts[generators + 1] - starts[generators])])

    def _extend(self, cells: Ints) -> None:
        """Find the neighbours of all corners of some simplices."""
        new = np.zeros(len(self._known), bool)
        new[self._simplices[cells]] = True
        new &= ~self._known
        generators = np.flatnonzero(new)
        self._known |= new
        low, high = split_keys(unique_edges(self._simplices[self._cells_around(generators)]))
        pairs = np.concatenate([_directed(low, high)[new[low]], _directed(high, low)[new[high]]])
        pairs.sort()
        sources, targets = pairs >> 33, pairs & 0xFFFFFFFF
        first, last = np.searchsorted(sources, generators), np.searchsorted(sources, generators, "right")
        self._first[generators], self._count[generators] = self._n_rows + first, last - first
        ways = self.coordinates[targets] - self.coordinates[sources]
        new_rows = slice(self._n_rows, self._n_rows + len(targets))
        self._make_room(new_rows.stop)
        self.targets[new_rows], self.ways[:, new_rows] = targets, ways.T
        self.squares[new_rows] = dots(ways, ways)
        self._n_rows = new_rows.stop
        self._pairs = np.sort(np.concatenate([self._pairs, pairs]), kind="stable")  # runs in order are merged

    def _make_room(self, n_rows: int) -> None:
        """Arrays of twice that many rows where there are fewer: they grow often, and are seldom copied."""
        if n_rows > len(self.targets):
            more = 2 * n_rows - len(self.targets) if self._n_rows else n_rows
            self.targets = np.concatenate([self.targets, np.empty(more, np.int64)])
            self.ways = np.concatenate([self.ways, np.empty((len(self.ways), more))], axis=1)
            self.squares = np.concatenate([self.squares, np.empty(more)])

    def of(self, generators: Ints) -> tuple[Ints, Ints]:
        """Rows of the neighbours of each generator in `targets`, one after another, and how many each has."""
        counts = self._count[generators]
        return ranges(self._first[generators], counts), counts

    def prepare(self, generators: Ints) -> None:
        """Make sure that the neighbours of these generators are known."""
        missing = ~self._known[generators]
        if missing.any():
            cells = self._cells_around(_once(generators[missing]))
            cells = self._cells_around(_once(self._simplices[cells].ravel()))  # who goes far goes farther
            self._extend(cells)

    def joined(self, first: Ints, second: Ints) -> Bools:
        """Whether pairs are Delaunay edges; one of each pair must be prepared."""
        known = self._known[first]
        pairs = _directed(np.where(known, first, second), np.where(known, second, first))
        place = np.minimum(np.searchsorted(self._pairs, pairs), len(self._pairs) - 1)
        return np.asarray(self._pairs[place] == pairs)


def _directed(source: Ints, target: Ints) -> NDArray[np.int64]:
    """One number per pair, by its source; targets above it come first."""
    return (source << 33) | ((target < source).astype(np.int64) << 32) | target


def ranges(starts: Ints, counts: Ints) -> Ints:
    """The numbers of ranges, one range after another."""
    return np.arange(counts.sum()) + np.repeat(starts - (np.cumsum(counts) - counts), counts)


def unique_edges(simplices: Ints) -> Ints:
    """Keys of the edges of some simplices, ascending."""
    width = simplices.shape[1]
    pairs = [(i, j) for i in range(width) for j in range(i)]
    return _once(np.concatenate([edge_keys_of(simplices[:, i], simplices[:, j]) for i, j in pairs]))


def _once(values: Ints) -> Ints:
    """The values, ascending, each once; many times faster than np.unique, which hashes."""
    ranked = np.sort(values)
    first = np.ones(len(ranked), bool)
    first[1:] = ranked[1:] != ranked[:-1]
    return ranked[first]


def grid_keys(positions: Floats, step: float) -> NDArray[np.uint64]:
    """A random-looking number for each position, rounded to a grid."""
    keys = np.zeros(len(positions), np.uint64)
    places = np.clip(np.rint(positions / step), -(2.0**62), 2.0**62)  # flat simplices have centres that far away
    for column in places.astype(np.int64).view(np.uint64).T:
        keys = scramble(keys + column)
    return keys


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
