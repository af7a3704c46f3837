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
from tetraskel.kernels.vector_loops import between, cross, dot


@inner
def _square(points, a, b):
    side = between(points, a, b)
    return dot(side, side)


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
    n, m, k = cross(v, w), cross(w, u), cross(u, v)
    a, b, c = dot(u, u), dot(v, v), dot(w, w)
    centre = (
        a * n[0] + b * m[0] + c * k[0],
        a * n[1] + b * m[1] + c * k[1],
        a * n[2] + b * m[2] + c * k[2],
    )
    return centre, dot(u, n), n, m, k


@inner
def _room(points, a, b, c, d):
    centre, volume, n, m, k = _centre_of_ball(between(points, a, b), between(points, a, c), between(points, a, d))
    first, second, third = dot(centre, n), dot(centre, m), dot(centre, k)
    whole = 2 * volume * volume
    lowest = min(min(first, second, third), whole - (first + second + third))
    if whole > 0 and lowest >= -ON_FACET * whole:
        return math.sqrt(dot(centre, centre)) / (2 * abs(volume))
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
        u, v, w = between(points, a, b), between(points, a, c), between(points, a, d)
        centre, volume, _, _, _ = _centre_of_ball(u, v, w)
        squares = dot(u, u) + dot(v, v) + dot(w, w)
        flat[i] = abs(volume) <= flat_share * squares * math.sqrt(squares)
        if volume * volume > EMPTY * (dot(u, u) * dot(v, v) * dot(w, w)):
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
    length = max(math.sqrt(dot(u, u)), 1e-300)
    return u[0] / length, u[1] / length, u[2] / length


def facing(points, simplices, places, result):
    """See `medial_nodes.facing`."""
    for i in range(len(simplices)):
        p = _towards(points, simplices[i, 0], places, i)
        q = _towards(points, simplices[i, 1], places, i)
        r = _towards(points, simplices[i, 2], places, i)
        s = _towards(points, simplices[i, 3], places, i)
        pq, pr, ps = dot(p, q), dot(p, r), dot(p, s)
        qr, qs, rs = dot(q, r), dot(q, s), dot(r, s)
        worst = max(min(pq, pr, ps), min(pq, qr, qs), min(pr, qr, rs), min(ps, qs, rs))
        result[i] = (1 - min(worst, 1.0)) / 2


@inner
def _area(points, a, b, c):
    normal = cross(between(points, a, b), between(points, a, c))
    return 0.5 * math.sqrt(dot(normal, normal))


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
