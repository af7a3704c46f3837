"""What lies around points and edges of a Voronoi diagram, one after another, for numba to compile.

The same as array operations is in `voronoi_faces`, `voronoi_sides`, `voronoi_crossings` and `voronoi_simplification`,
for the plane and for where there is no numba: those sort the whole, these one list per point, and the results are
equal. Imported only where numba is.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import called, inlined
from tetraskel.kernels.voronoi_faces import AHEAD, BEHIND, EDGES, LONGEST_RING, WEDGE_BITS

# the row of EDGES that two corners of a tetrahedron have
SLOTS = np.array(
    [
        [max(slot for slot, edge in enumerate(EDGES) if i == j or {i, j} == set(edge[:2])) for j in range(4)]
        for i in range(4)
    ]
)
SLOT_BITS = (1 << WEDGE_BITS) - 1


def stars(simplices, n_points):
    """Simplices around each point, ascending, one point after another, and where each begins."""
    starts = np.zeros(n_points + 2, np.int64)
    for i in range(simplices.shape[0]):
        for k in range(simplices.shape[1]):
            starts[simplices[i, k] + 2] += 1
    for point in range(n_points):
        starts[point + 2] += starts[point + 1]
    cells = np.empty(simplices.size, np.int32)
    for i in range(simplices.shape[0]):
        for k in range(simplices.shape[1]):
            corner = simplices[i, k] + 1
            cells[starts[corner]] = i
            starts[corner] += 1
    return starts[: n_points + 1], cells


def pieces(neighbors, joined):
    """Connected piece of each simplex across the facets that join, numbered by the first simplex in it."""
    label, stack, n_pieces = np.full(len(neighbors), -1, np.int32), np.empty(len(neighbors), np.int32), 0
    for first in range(len(neighbors)):
        if label[first] >= 0:
            continue
        label[first], stack[0], n = n_pieces, first, 1
        while n > 0:
            n -= 1
            cell = stack[n]
            for k in range(neighbors.shape[1]):
                other = neighbors[cell, k]
                if joined[cell, k] and label[other] < 0:
                    label[other], stack[n] = n_pieces, other
                    n += 1
        n_pieces += 1
    return label


def facets_between(triples, simplices, starts, cells):
    """A facet of each three points, as simplex * 4 + opposite vertex; -1 where no simplex has all of them."""
    result = np.full(len(triples), -1, np.int64)
    for i in range(len(triples)):
        a, b, c = triples[i, 0], triples[i, 1], triples[i, 2]
        for place in range(starts[a], starts[a + 1]):
            cell, others, apart = np.int64(cells[place]), 0, 0
            for k in range(4):
                corner = simplices[cell, k]
                if corner in (b, c):
                    others += 1
                elif corner != a:
                    apart = k
            if others == 2:
                result[i] = 4 * cell + apart
                break
    return result


def ranked(groups, values, last, n_groups):
    """Order of rows by group, then value, then a last flag, then place; see `np.lexsort`."""
    starts = np.zeros(n_groups + 2, np.int64)
    for i in range(len(groups)):
        starts[groups[i] + 2] += 1
    for group in range(n_groups):
        starts[group + 2] += starts[group + 1]
    order, first = np.empty(len(groups), np.int64), starts.copy()
    for i in range(len(groups)):
        place = starts[groups[i] + 1]
        starts[groups[i] + 1] += 1
        while place > first[groups[i] + 1]:
            other = order[place - 1]
            if values[other] < values[i] or (values[other] == values[i] and last[other] <= last[i]):
                break
            order[place] = other
            place -= 1
        order[place] = i
    return order


@inlined
def _corner(simplices, cell, point):
    """Which corner of a tetrahedron a point is; without a branch, which no processor could foresee."""
    return (simplices[cell, 1] == point) + 2 * (simplices[cell, 2] == point) + 3 * (simplices[cell, 3] == point)


@called
def _edges_at(simplices, stars, point, wanted, number, first, edges):
    """Write the edges from a point to larger ones, ascending: other end, tetrahedra, how many of these are wanted, and
    where their wedges begin. How many edges; `number` is theirs by other ends, below `first` of another point.
    """
    starts, cells = stars
    n = 0
    for place in range(starts[point], starts[point + 1]):
        cell, here = cells[place], _corner(simplices, cells[place], point)
        for k in range(4):
            other = simplices[cell, k]
            if other <= point:
                continue
            if number[other] < first:
                number[other] = first + n
                edges[n, 0], edges[n, 1], edges[n, 2] = other, 0, 0
                n += 1
            edge = number[other] - first
            edges[edge, 1] += 1
            edges[edge, 2] += wanted[cell, SLOTS[here, k]]
    for i in range(n):
        other, count, chosen, j = edges[i, 0], edges[i, 1], edges[i, 2], i
        while j > 0 and edges[j - 1, 0] > other:
            for column in range(3):
                edges[j, column] = edges[j - 1, column]
            j -= 1
        edges[j, 0], edges[j, 1], edges[j, 2] = other, count, chosen
    begin = 0
    for i in range(n):
        number[edges[i, 0]] = first + i
        edges[i, 3], begin = begin, begin + edges[i, 1]
    return n


@called
def _wedges_at(mesh, stars, point, number, first, edges, wedges):
    """Write the wedges at a point's edges, edge by edge, and the tetrahedra ahead; `edges` tell where each ends."""
    simplices, neighbors, signs = mesh
    starts, cells = stars
    for place in range(starts[point], starts[point + 1]):
        cell, here = np.int64(cells[place]), _corner(simplices, cells[place], point)
        for k in range(4):
            other = simplices[cell, k]
            if other <= point:
                continue
            edge = number[other] - first
            turned = 2 * SLOTS[here, k] + ((here > k) != (signs[cell] < 0))
            row = edges[edge, 3]
            wedges[row, 0], wedges[row, 1] = (cell << WEDGE_BITS) | turned, neighbors[cell, AHEAD[turned]]
            edges[edge, 3] += 1


@called
def _place_in(wedges, first, last, cell):
    """Where in a ring a tetrahedron is, -1 where it is not."""
    for place in range(first, last):
        if wedges[place, 0] >> WEDGE_BITS == cell:
            return place
    return -1


@called
def _follow(wedges, first, last, ring, n):
    """Write the wedges of a ring, each before the one ahead of it, or as they are; whether it ends, and is misled."""
    count, at = last - first, first
    closes = 2 < count <= LONGEST_RING  # a flat one turned the wrong way, and two look at each other
    for k in range(count if closes else 0):
        ring[n + k] = wedges[at, 0]
        at = _place_in(wedges, first, last, wedges[at, 1])
        if at < 0 or (at == first) != (k == count - 1):
            closes = False
            break
    if closes:
        return False, False
    ended = False
    for place in range(first, last):
        ring[n + place - first] = wedges[place, 0]
        ended |= count <= LONGEST_RING and _place_in(wedges, first, last, wedges[place, 1]) < 0
    return ended, not ended


def rings(simplices, neighbors, signs, starts, cells, wanted, also, every, first_point, last_point):
    """Voronoi faces of some points' edges to larger ones; see `voronoi_faces.closed_faces` and `ordered_faces`.

    Parameters
    ----------
    wanted : (m, 6) bool
    also : (k,) int
        Keys of edges, ascending.
    every : bool
        Faces are asked for all of whose wedges are wanted; else those with one, and those of the keys.

    Returns
    -------
    keys, counts : (q,) int
    wedges : (total,) int
        In order where the ring closes, else ascending.
    ended, misled : (q,) bool
        As in `voronoi_faces._walked`.
    """
    mesh, stars, most = (simplices, neighbors, signs), (starts, cells), 0
    for point in range(first_point, last_point):
        most = max(most, 3 * (starts[point + 1] - starts[point]))
    room = 3 * (starts[last_point] - starts[first_point])
    keys, counts, ring = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room, np.int64)
    ended, misled = np.zeros(room, np.bool_), np.zeros(room, np.bool_)
    number, edges = np.full(len(starts) - 1, -1, np.int64), np.empty((most, 4), np.int64)
    wedges = np.empty((most, 2), np.int64)
    first, n_faces, n_wedges, n_also = 0, 0, 0, 0
    for point in range(first_point, last_point):
        n = _edges_at(simplices, stars, point, wanted, number, first, edges)
        _wedges_at(mesh, stars, point, number, first, edges, wedges)
        first += n
        for i in range(n):
            key, count = (np.int64(point) << 32) | edges[i, 0], edges[i, 1]
            while n_also < len(also) and also[n_also] < key:
                n_also += 1
            chosen = edges[i, 2] == count if every else edges[i, 2] > 0 or (n_also < len(also) and also[n_also] == key)
            if not chosen:
                continue
            last = edges[i, 3]
            ended[n_faces], misled[n_faces] = _follow(wedges, last - count, last, ring, n_wedges)
            keys[n_faces], counts[n_faces] = key, count
            n_faces, n_wedges = n_faces + 1, n_wedges + count
    return keys[:n_faces], counts[:n_faces], ring[:n_wedges], ended[:n_faces], misled[:n_faces]


def facets_beside(wedges, n_simplices):
    """(m, 4) facets of tetrahedra that lie at one of their edges in some wedges."""
    result = np.zeros((n_simplices, 4), np.bool_)
    for i in range(len(wedges)):
        cell, slot = wedges[i] >> WEDGE_BITS, wedges[i] & SLOT_BITS
        result[cell, AHEAD[slot]] = result[cell, BEHIND[slot]] = True
    return result


def first_of_each(names):
    """See `voronoi_simplification._first_of_each`; names are random-looking, so that their last bits are a place."""
    size = 16
    while size < 2 * len(names):
        size *= 2
    table, result = np.full(size, -1, np.int32), np.empty(len(names), np.int64)
    for i in range(len(names)):
        place = np.int64(names[i] & np.uint64(size - 1))
        while table[place] >= 0 and names[table[place]] != names[i]:
            place = (place + 1) & (size - 1)
        if table[place] < 0:
            table[place] = i
        result[i] = table[place]
    return result
