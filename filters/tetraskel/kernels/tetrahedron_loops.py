"""Measures of tetrahedra, one after another, for numba to compile.

The same formulas as array operations are in `passage_widths`, `medial_nodes` and `smoothing`, for the plane and for
where there is no numba. An array operation goes through memory for each sum and product, a compiled loop once for all
of them; the order of the operations is the same, and so are the results, to the last bit. Imported only where numba is.
"""

from __future__ import annotations

import math

import numpy as np

from tetraskel.kernels.barycentric import EMPTY
from tetraskel.kernels.compilation import inner
from tetraskel.kernels.passage_widths import ON_FACET


@inner
def _between(points, a, b):
    return points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]


@inner
def _dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@inner
def _cross(u, v):
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


@inner
def _square(points, a, b):
    side = _between(points, a, b)
    return _dot(side, side)


@inner
def _width(first, second, third):
    """See `passage_widths.triangle_widths`."""
    small, large = min(first, second), max(first, second)
    high = max(large, third)
    middle = max(small, min(large, third))
    low = min(small, third)
    bend = low + middle - high
    if bend <= 0:
        lever = high + middle - low
        top, bottom = middle, lever * lever
    else:
        top, bottom = low, 4 * low * middle - bend * bend
    return math.sqrt(top * middle * high / bottom) if bottom > 0 else 0.0


@inner
def _centre_of_ball(u, v, w):
    """Circumcentre from the first corner times 2 volume, the volume, and the normals."""
    n, m, k = _cross(v, w), _cross(w, u), _cross(u, v)
    a, b, c = _dot(u, u), _dot(v, v), _dot(w, w)
    centre = (
        a * n[0] + b * m[0] + c * k[0],
        a * n[1] + b * m[1] + c * k[1],
        a * n[2] + b * m[2] + c * k[2],
    )
    return centre, _dot(u, n), n, m, k


@inner
def _room(points, a, b, c, d):
    centre, volume, n, m, k = _centre_of_ball(_between(points, a, b), _between(points, a, c), _between(points, a, d))
    first, second, third = _dot(centre, n), _dot(centre, m), _dot(centre, k)
    whole = 2 * volume * volume
    lowest = min(min(first, second, third), whole - (first + second + third))
    if whole > 0 and lowest >= -ON_FACET * whole:
        return math.sqrt(_dot(centre, centre)) / (2 * abs(volume))
    return 0.0


def widths_and_rooms(points, simplices, widths, rooms):
    """See `passage_widths.widths_and_rooms`."""
    for i in range(len(simplices)):
        a, b, c, d = simplices[i, 0], simplices[i, 1], simplices[i, 2], simplices[i, 3]
        ab, ac, ad = _square(points, a, b), _square(points, a, c), _square(points, a, d)
        bc, bd, cd = _square(points, b, c), _square(points, b, d), _square(points, c, d)
        widths[i, 0] = _width(bc, bd, cd)
        widths[i, 1] = _width(ac, ad, cd)
        widths[i, 2] = _width(ab, ad, bd)
        widths[i, 3] = _width(ab, ac, bc)
        rooms[i] = _room(points, a, b, c, d)


def widths_of_triangles(points, triangles, widths):
    """(k,) passage widths of (k, 3) triangles."""
    for i in range(len(triangles)):
        a, b, c = triangles[i, 0], triangles[i, 1], triangles[i, 2]
        widths[i] = _width(_square(points, a, b), _square(points, a, c), _square(points, b, c))


def circumcentres(points, flat_share, simplices, centres, radii, flat):
    """See `medial_nodes.circumcentres`."""
    for i in range(len(simplices)):
        a, b, c, d = simplices[i, 0], simplices[i, 1], simplices[i, 2], simplices[i, 3]
        u, v, w = _between(points, a, b), _between(points, a, c), _between(points, a, d)
        centre, volume, _, _, _ = _centre_of_ball(u, v, w)
        squares = _dot(u, u) + _dot(v, v) + _dot(w, w)
        flat[i] = abs(volume) <= flat_share * squares * math.sqrt(squares)
        if volume * volume > EMPTY * (_dot(u, u) * _dot(v, v) * _dot(w, w)):
            twice = 2 * volume
            x, y, z = centre[0] / twice, centre[1] / twice, centre[2] / twice
            centres[i, 0], centres[i, 1], centres[i, 2] = points[a, 0] + x, points[a, 1] + y, points[a, 2] + z
            radii[i] = math.sqrt(x * x + y * y + z * z)
        else:
            for axis in range(3):
                total = points[a, axis] + points[b, axis] + points[c, axis] + points[d, axis]
                centres[i, axis] = total / 4
            radii[i] = np.nan


@inner
def _towards(points, corner, places, i):
    u = (points[corner, 0] - places[i, 0], points[corner, 1] - places[i, 1], points[corner, 2] - places[i, 2])
    length = max(math.sqrt(_dot(u, u)), 1e-300)
    return u[0] / length, u[1] / length, u[2] / length


def facing(points, simplices, places, result):
    """See `medial_nodes.facing`."""
    for i in range(len(simplices)):
        p = _towards(points, simplices[i, 0], places, i)
        q = _towards(points, simplices[i, 1], places, i)
        r = _towards(points, simplices[i, 2], places, i)
        s = _towards(points, simplices[i, 3], places, i)
        pq, pr, ps = _dot(p, q), _dot(p, r), _dot(p, s)
        qr, qs, rs = _dot(q, r), _dot(q, s), _dot(r, s)
        worst = max(min(pq, pr, ps), min(pq, qr, qs), min(pr, qr, rs), min(ps, qs, rs))
        result[i] = (1 - min(worst, 1.0)) / 2


@inner
def _area(points, a, b, c):
    normal = _cross(_between(points, a, b), _between(points, a, c))
    return 0.5 * math.sqrt(_dot(normal, normal))


def gains(points, simplices, neighbors, side, cells, gain):
    """See `smoothing.smaller_surface`."""
    for i in range(len(cells)):
        cell = cells[i]
        a, b, c, d = simplices[cell, 0], simplices[cell, 1], simplices[cell, 2], simplices[cell, 3]
        areas = _area(points, b, c, d), _area(points, a, c, d), _area(points, a, b, d), _area(points, a, b, c)
        total = 0.0
        for k in range(4):
            total += areas[k] if side[cell] != side[neighbors[cell, k]] else -areas[k]
        gain[i] = total


def facets_of(simplices, neighbors):
    """See `dual_complex.facets_and_boundary`."""
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
