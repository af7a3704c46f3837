"""Which simplices, facets and edges of tetrahedra lie at each other, for numba to compile.

The same as array operations is in `dual_complex` and `inner_mesh`, for the plane and for where there is no numba: those
sort the whole, these one list per point, and the results are equal. Imported only where numba is.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import inner


def facets_of(simplices, neighbors):
    """See `dual_complex.facets_of`."""
    n_inner, n_outer = 0, 0
    for i in range(len(simplices)):
        for k in range(4):
            n_inner += neighbors[i, k] > i
            n_outer += neighbors[i, k] < 0
    facets, corners = np.empty((n_inner, 2), np.int32), np.empty((n_inner, 3), np.int32)
    outer = np.empty((n_outer, 3), np.int32)
    n_inner, n_outer = 0, 0
    for i in range(len(simplices)):
        for k in range(4):
            a, b, c = simplices[i, 1 if k == 0 else 0], simplices[i, 2 if k < 2 else 1], simplices[i, 3 if k < 3 else 2]
            if neighbors[i, k] > i:
                facets[n_inner, 0], facets[n_inner, 1] = i, neighbors[i, k]
                corners[n_inner, 0], corners[n_inner, 1], corners[n_inner, 2] = a, b, c
                n_inner += 1
            elif neighbors[i, k] < 0:
                outer[n_outer, 0], outer[n_outer, 1], outer[n_outer, 2] = a, b, c
                n_outer += 1
    return facets, corners, outer


@inner
def _sort(values, start, stop):
    """Sort a part of an array (Shell 1959, with the gaps of Ciura 2001: the parts are short, save for a few)."""
    gap = 1
    while 2.25 * gap < stop - start:
        gap = int(2.25 * gap) + 1
    while gap > 0:
        for i in range(start + gap, stop):
            value, j = values[i], i
            while j >= start + gap and values[j - gap] > value:
                values[j] = values[j - gap]
                j -= gap
            values[j] = value
        gap = int(gap / 2.25)


OUTER = 0xFFFFFFFF  # the mark of an edge on the boundary: it comes behind all facets


@inner
def _count_edges(triangles, start):
    for i in range(len(triangles)):
        start[triangles[i, 0]] += 2
        start[triangles[i, 1]] += 1


@inner
def _list_edges(triangles, step, first_mark, ends, edges):
    """Write each edge to the end of its smaller point's list: the larger point, and below it a mark."""
    for i in range(len(triangles)):
        a, b, c = np.int64(triangles[i, 0]), np.int64(triangles[i, 1]), np.int64(triangles[i, 2])
        mark = first_mark + 3 * step * i
        edges[ends[a]] = (b << 32) | mark
        edges[ends[a] + 1] = (c << 32) | (mark + step)
        edges[ends[b]] = (c << 32) | (mark + 2 * step)
        ends[a] += 2
        ends[b] += 1


def rings(corners, outer, n_points):
    """See `dual_complex._rings`; the keys as pairs of points.

    Strategy: the edges of all facets in one list per smaller point, each list sorted by the larger one, brings the
    facets around one edge together; the facets on the boundary leave their mark at the end of them.
    """
    start = np.zeros(n_points + 2, np.int64)
    _count_edges(corners, start[1:])
    _count_edges(outer, start[1:])
    for point in range(n_points + 1):
        start[point + 1] += start[point]
    edges, ends = np.empty(start[n_points], np.int64), start.copy()
    _list_edges(corners, 1, 0, ends, edges)
    _list_edges(outer, 0, OUTER, ends, edges)
    facet_ridges = np.full((len(corners), 3), -1, np.int32)
    most = 3 * len(corners) // 2  # a ring has two facets at least
    ring_start, ring_facets = np.zeros(most + 1, np.int64), np.empty(3 * len(corners), np.int32)
    ridge_points = np.empty((most, 2), np.int32)
    flat_ridges, ridge, n_in_rings = facet_ridges.ravel(), 0, 0
    for point in range(n_points):
        _sort(edges, start[point], start[point + 1])
        first = start[point]
        while first < start[point + 1]:
            last = first
            while last + 1 < start[point + 1] and edges[last + 1] >> 32 == edges[first] >> 32:
                last += 1
            if edges[last] & OUTER != OUTER:
                for k in range(first, last + 1):
                    flat_ridges[edges[k] & OUTER] = ridge
                    ring_facets[n_in_rings] = (edges[k] & OUTER) // 3
                    n_in_rings += 1
                ridge_points[ridge, 0], ridge_points[ridge, 1] = point, edges[first] >> 32
                ridge += 1
                ring_start[ridge] = n_in_rings
            first = last + 1
    return facet_ridges, ring_start[: ridge + 1].copy(), ring_facets[:n_in_rings].copy(), ridge_points[:ridge].copy()


@inner
def _sort_by_columns(keys, last, cells, start, stop):
    """Sort a part of three arrays by the first, then by the second; see `_sort`."""
    gap = 1
    while 2.25 * gap < stop - start:
        gap = int(2.25 * gap) + 1
    while gap > 0:
        for i in range(start + gap, stop):
            key, tail, cell, j = keys[i], last[i], cells[i], i
            while j >= start + gap and (keys[j - gap] > key or (keys[j - gap] == key and last[j - gap] > tail)):
                keys[j], last[j], cells[j] = keys[j - gap], last[j - gap], cells[j - gap]
                j -= gap
            keys[j], last[j], cells[j] = key, tail, cell
        gap = int(gap / 2.25)


@inner
def _ranked(simplices, cell, number, row, slots):
    """The new numbers of a simplex' points in ascending order, and where in it they are."""
    for k in range(4):
        value, j = number[simplices[cell, k]], k
        while j > 0 and row[j - 1] > value:
            row[j], slots[j] = row[j - 1], slots[j - 1]
            j -= 1
        row[j], slots[j] = value, k


def chosen_simplices(simplices, neighbors, cells, number, n_points):
    """See `inner_mesh.chosen_simplices`."""
    row, slots = np.empty(4, np.int64), np.empty(4, np.int64)
    start = np.zeros(n_points + 2, np.int64)
    for cell in cells:
        _ranked(simplices, cell, number, row, slots)
        start[row[0] + 2] += 1
    for point in range(n_points):
        start[point + 2] += start[point + 1]
    keys, last, order = np.empty(len(cells), np.int64), np.empty(len(cells), np.int32), np.empty(len(cells), np.int32)
    for cell in cells:
        _ranked(simplices, cell, number, row, slots)
        place = start[row[0] + 1]
        start[row[0] + 1] += 1
        keys[place], last[place], order[place] = (row[1] << 32) | row[2], row[3], cell
    for point in range(n_points):
        _sort_by_columns(keys, last, order, start[point], start[point + 1])
    new_id = np.full(len(simplices) + 1, -1, np.int32)  # the last for "no neighbour"
    for i in range(len(order)):
        new_id[order[i]] = i
    new_simplices, new_neighbors = np.empty((len(cells), 4), np.int32), np.empty((len(cells), 4), np.int32)
    for i in range(len(order)):
        _ranked(simplices, order[i], number, row, slots)
        for k in range(4):
            new_simplices[i, k], new_neighbors[i, k] = row[k], new_id[neighbors[order[i], slots[k]]]
    return new_simplices, new_neighbors
