"""What lies around points and edges of a Voronoi diagram, one after another, for numba to compile.

The same as array operations is in `voronoi_faces`, `voronoi_lines`, `voronoi_crossings` and `voronoi_simplification`,
for the plane and for where there is no numba: those sort the whole, these one list per point, and the results are
equal. Imported only where numba is.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import inlined
from tetraskel.kernels.voronoi_faces import AHEAD, BEHIND, EDGES, WEDGE_BITS

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


@inlined
def turn(n_points, point, other):
    """How far it is from a point to another, upwards and on from the first."""
    return other - point if other > point else other - point + n_points


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


def edges_and_wedges(simplices, signs, starts, cells, wanted, also, complete, first_point, last_point):
    """See `voronoi_faces.voronoi_faces`, and, where complete, `voronoi_faces.faces_of_any`: edges from some points on.

    Strategy: the simplices around a point name its edges to larger points; each new name gets a list, and only the few
    names are sorted.

    Returns
    -------
    keys, counts : (q,) int
    wedges : (total,) int
    """
    most = 0
    for point in range(first_point, last_point):
        most = max(most, 3 * (starts[point + 1] - starts[point]))
    n_wedges = 3 * (starts[last_point] - starts[first_point])
    keys, begins, wedges = np.empty(n_wedges, np.int64), np.zeros(n_wedges + 1, np.int64), np.empty(n_wedges, np.int64)
    number = np.full(len(starts) - 1, -1, np.int32)  # of an edge, by its other end; below `first` of another point's
    others, ends = np.empty(most, np.int64), np.empty(most, np.int64)
    listed, owner = np.empty(most, np.int64), np.empty(most, np.int64)
    first, n_wedges, n_also = 0, 0, 0
    for point in range(first_point, last_point):
        n, n_edges = 0, 0
        while n_also < len(also) and also[n_also] >> 32 == point:
            other = also[n_also] & 0xFFFFFFFF
            if number[other] < first:
                n_edges = _add_edge(number, others, ends, first, n_edges, other)
            n_also += 1
        for place in range(starts[point], starts[point + 1] if complete else starts[point]):
            cell, here = cells[place], _corner(simplices, cells[place], point)
            for k in range(4):
                other = simplices[cell, k]
                if other > point and number[other] < first and wanted[cell, SLOTS[here, k]]:
                    n_edges = _add_edge(number, others, ends, first, n_edges, other)
        for place in range(starts[point], starts[point + 1]):
            cell, here = np.int64(cells[place]), _corner(simplices, cells[place], point)
            for k in range(4):
                other, slot = simplices[cell, k], SLOTS[here, k]
                if other <= point or (number[other] < first if complete else not wanted[cell, slot]):
                    continue
                if number[other] < first:
                    n_edges = _add_edge(number, others, ends, first, n_edges, other)
                owner[n] = number[other] - first
                listed[n] = (cell << WEDGE_BITS) | (2 * slot + ((here > k) != (signs[cell] < 0)))
                ends[owner[n]] += 1
                n += 1
        _ranges_by(others, ends, n_edges, keys, begins, first, n_wedges, point)
        for i in range(n):
            wedges[n_wedges + ends[owner[i]]] = listed[i]
            ends[owner[i]] += 1
        first, n_wedges = first + n_edges, n_wedges + n
    begins[first] = n_wedges
    counts = np.empty(first, np.int64)
    for edge in range(first):
        counts[edge] = begins[edge + 1] - begins[edge]
    return keys[:first], counts, wedges[:n_wedges]


@inlined
def _corner(simplices, cell, point):
    """Which corner of a tetrahedron a point is."""
    here = 0
    while simplices[cell, here] != point:
        here += 1
    return here


@inlined
def _add_edge(number, others, ends, first, n_edges, other):
    """Number an edge by its other end; how many there are."""
    number[other] = first + n_edges
    others[n_edges], ends[n_edges] = other, 0
    return n_edges + 1


@inlined
def _ranges_by(others, ends, n_edges, keys, begins, first, n_wedges, point):
    """Edges of a point by their other ends: their keys, and where their lists begin, in place of their lengths."""
    for i in range(n_edges):
        j = first + i
        while j > first and keys[j - 1] > others[i]:
            keys[j], begins[j] = keys[j - 1], begins[j - 1]
            j -= 1
        keys[j], begins[j] = others[i], i
    total = 0
    for j in range(first, first + n_edges):
        edge = begins[j]
        keys[j], begins[j] = (np.int64(point) << 32) | keys[j], n_wedges + total
        total, ends[edge] = total + ends[edge], total


def facets_beside(wedges, n_simplices):
    """(m, 4) facets of tetrahedra that lie at one of their edges in some wedges."""
    result = np.zeros((n_simplices, 4), np.bool_)
    for i in range(len(wedges)):
        cell, slot = wedges[i] >> WEDGE_BITS, wedges[i] & SLOT_BITS
        result[cell, AHEAD[slot]] = result[cell, BEHIND[slot]] = True
    return result


@inlined
def _place_in(wedges, first, last, cell):
    """Where in a ring a tetrahedron is, -1 where it is not; the last place if there are two."""
    for place in range(last - 1, first - 1, -1):
        if wedges[place] >> WEDGE_BITS == cell:
            return place
    return np.int64(-1)


def follow(neighbors, starts, wedges):
    """See `voronoi_faces._walked`."""
    n_faces = len(starts) - 1
    result, ended, misled = wedges.copy(), np.zeros(n_faces, np.bool_), np.zeros(n_faces, np.bool_)
    for face in range(n_faces):
        first, last = starts[face], starts[face + 1]
        for place in range(first, last):
            cell, slot = wedges[place] >> WEDGE_BITS, wedges[place] & SLOT_BITS
            if _place_in(wedges, first, last, neighbors[cell, AHEAD[slot]]) < 0:
                ended[face] = True
                break
        if ended[face]:
            continue
        at, closes = first, last - first > 2
        for step in range(first + 1, last + 1):
            cell, slot = wedges[at] >> WEDGE_BITS, wedges[at] & SLOT_BITS
            at = _place_in(wedges, first, last, neighbors[cell, AHEAD[slot]])
            closes &= (at == first) == (step == last)
            if step < last:
                result[step] = wedges[at]
        if not closes:
            misled[face] = True
            for place in range(first, last):
                result[place] = wedges[place]
    return result, ended, misled


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
