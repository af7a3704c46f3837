"""The walls of one Voronoi face in its plane, and what of them is in a slab, for numba to compile.

The same as array operations is in `voronoi_clip` and `polygon_slabs`. Imported only where numba is.
"""

from __future__ import annotations

import math

import numpy as np

from tetraskel.kernels.compilation import called, inlined
from tetraskel.kernels.polygon_slabs import BOTTOM, ENTER, LEAVE, THIN, TOP
from tetraskel.kernels.vector_loops import cross, dot, place_of
from tetraskel.kernels.voronoi_clip import COSINE, SINE
from tetraskel.kernels.voronoi_faces import AHEAD, BEHIND, WEDGE_BITS

# columns of what is known of a wall: left and right end, then the places of both on the Voronoi edge
LEFT_U, LEFT_V, RIGHT_U, RIGHT_V, LEFT_PLACE, RIGHT_PLACE = 0, 1, 2, 3, 4, 5
# and the numbers that go with it
KIND, EDGE, FIRST_LINE, LAST_LINE = 0, 1, 2, 3
NO_EDGE = np.int64(0)


@inlined
def _scaled(u, factor):
    return u[0] / factor, u[1] / factor, u[2] / factor


@inlined
def _turned(u, v, cosine, sine):
    return cosine * u[0] + sine * v[0], cosine * u[1] + sine * v[1], cosine * u[2] + sine * v[2]


@called
def frame_between(points, low, high):
    """The middle between two points and two axes across; see `voronoi_faces.frames`."""
    a, b = place_of(points, low), place_of(points, high)
    origin = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2)
    way = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    w = _scaled(way, math.sqrt(dot(way, way)))
    x, y, z = abs(w[0]), abs(w[1]), abs(w[2])
    if x <= y and x <= z:
        helper = (1.0, 0.0, 0.0)
    elif y <= z:
        helper = (0.0, 1.0, 0.0)
    else:
        helper = (0.0, 0.0, 1.0)
    u = cross(helper, w)
    u = _scaled(u, math.sqrt(dot(u, u)))
    v = cross(w, u)
    return origin, _turned(u, v, COSINE, SINE), _turned(v, u, COSINE, -SINE)


@inlined
def _flat(frame, spot):
    """The two coordinates of a place in the plane of a frame."""
    origin, across, up = frame
    away = (spot[0] - origin[0], spot[1] - origin[1], spot[2] - origin[2])
    return dot(away, across), dot(away, up)


@inlined
def _between(positions, ends, edge, place):
    """The place at a share of the way along a Voronoi edge."""
    a, b = place_of(positions, ends[edge, 0]), place_of(positions, ends[edge, 1])
    return a[0] + place * (b[0] - a[0]), a[1] + place * (b[1] - a[1]), a[2] + place * (b[2] - a[2])


@called
def _within_ball(positions, ends, edge, ball):
    """Least and largest place of a Voronoi edge in a ball (middle, radius); see `voronoi_clip`."""
    a, b = place_of(positions, ends[edge, 0]), place_of(positions, ends[edge, 1])
    start = (a[0] - ball[0], a[1] - ball[1], a[2] - ball[2])
    way = (b[0] - ball[0] - start[0], b[1] - ball[1] - start[1], b[2] - ball[2] - start[2])
    square = dot(way, way)
    if square == 0:
        square = 1.0
    nearest = -dot(start, way) / square
    off = (start[0] + nearest * way[0], start[1] + nearest * way[1], start[2] + nearest * way[2])
    half = math.sqrt(max(ball[3] * ball[3] - dot(off, off), 0.0) / square)
    return min(max(nearest - half, 0.0), 1.0), min(max(nearest + half, 0.0), 1.0)


@inlined
def _set_wall(walls, numbers, n, start, stop, kind, edge, first_place, last_place):
    """Write a wall with its left end first; whether it is one: those straight up are none."""
    if start[0] == stop[0]:
        return False
    if start[0] < stop[0]:
        walls[n, LEFT_U], walls[n, LEFT_V], walls[n, RIGHT_U], walls[n, RIGHT_V] = start[0], start[1], stop[0], stop[1]
        walls[n, LEFT_PLACE], walls[n, RIGHT_PLACE] = first_place, last_place
    else:
        walls[n, LEFT_U], walls[n, LEFT_V], walls[n, RIGHT_U], walls[n, RIGHT_V] = stop[0], stop[1], start[0], start[1]
        walls[n, LEFT_PLACE], walls[n, RIGHT_PLACE] = last_place, first_place
    numbers[n, KIND], numbers[n, EDGE] = kind, edge
    return True


@inlined
def _edge_of(neighbors, edge_of_first_half, half):
    """The Voronoi edge of a facet of a simplex, simplex * 4 + opposite vertex."""
    cell, beyond = half >> 2, neighbors[half >> 2, half & 3]
    if beyond > cell:
        for k in range(4):
            if neighbors[beyond, k] == cell:
                return np.int64(edge_of_first_half[4 * np.int64(beyond) + k])
    return np.int64(edge_of_first_half[half])


@called
def own_walls(diagram, wedges, frame, ball, walls, numbers):
    """The walls of a face's own edges; how many. See `voronoi_clip`."""
    positions, ends, neighbors, edge_of_first_half = diagram
    n, m, k = 0, len(neighbors), len(wedges)
    for turn in range(2):  # the rays that open faces come last
        for i in range(k):
            cell, corner = wedges[i] >> WEDGE_BITS, wedges[i] & ((1 << WEDGE_BITS) - 1)
            half = 4 * cell + (AHEAD[corner] if turn == 0 else BEHIND[corner])
            if turn == 1 and neighbors[cell, half & 3] >= 0:
                continue
            edge = _edge_of(neighbors, edge_of_first_half, half)
            forward = (ends[edge, 0] == cell or ends[edge, 1] >= m) != (turn == 1)
            least, most = _within_ball(positions, ends, edge, ball)
            if least == most:
                continue
            first, last = (least, most) if forward else (most, least)
            start = _flat(frame, _between(positions, ends, edge, first))
            stop = _flat(frame, _between(positions, ends, edge, last))
            kind = BOTTOM if stop[0] > start[0] else TOP
            n += _set_wall(walls, numbers, n, start, stop, kind, edge, first, last)
    return n


@called
def boundary_walls(segments, outward, bounds, frame, walls, numbers, n):
    """The walls of the boundary's segments on a face, after n others; how many there are then."""
    up = frame[2]
    for i in range(bounds[0], bounds[1]):
        start = _flat(frame, (segments[i, 0, 0], segments[i, 0, 1], segments[i, 0, 2]))
        stop = _flat(frame, (segments[i, 1, 0], segments[i, 1, 1], segments[i, 1, 2]))
        kind = ENTER if dot(place_of(outward, i), up) < 0 else LEAVE
        n += _set_wall(walls, numbers, n, start, stop, kind, NO_EDGE, stop[0], stop[0])
    return n


@called
def slab_lines(walls, numbers, n, lines, order):
    """The lines' u, ascending, and the line at each wall's ends; how many. See `polygon_slabs.slab_lines`."""
    for i in range(2 * n):
        value, j = walls[i >> 1, RIGHT_U if i & 1 else LEFT_U], i
        while j > 0 and lines[j - 1] > value:
            lines[j], order[j] = lines[j - 1], order[j - 1]
            j -= 1
        lines[j], order[j] = value, i
    size, count, before = lines[2 * n - 1] - lines[0], 0, lines[0]
    for i in range(2 * n):
        value = lines[i]
        if i == 0 or value - before > THIN * size:
            lines[count] = value
            count += 1
        before = value
        numbers[order[i] >> 1, LAST_LINE if order[i] & 1 else FIRST_LINE] = count - 1
    return count


@inlined
def _height(walls, wall, u):
    """v of a wall at the side of a slab; see `polygon_slabs`."""
    share = (u - walls[wall, LEFT_U]) / (walls[wall, RIGHT_U] - walls[wall, LEFT_U])
    share = min(max(share, 0.0), 1.0)
    if share == 1:
        return walls[wall, RIGHT_V]
    return walls[wall, LEFT_V] + share * (walls[wall, RIGHT_V] - walls[wall, LEFT_V])


@called
def walls_of_slab(walls, numbers, n, slab, lines, here, heights):
    """Walls in a slab from below, with their heights left and right; how many. See `polygon_slabs.cut_into_slabs`."""
    count = 0
    for wall in range(n):
        if numbers[wall, FIRST_LINE] > slab or numbers[wall, LAST_LINE] <= slab:
            continue
        left, right, j = _height(walls, wall, lines[slab]), _height(walls, wall, lines[slab + 1]), count
        while j > 0:
            other = heights[j - 1, 0] + heights[j - 1, 1]
            kind = numbers[here[j - 1], KIND]
            if other < left + right or (other == left + right and kind <= numbers[wall, KIND]):
                break
            here[j], heights[j, 0], heights[j, 1] = here[j - 1], heights[j - 1, 0], heights[j - 1, 1]
            j -= 1
        here[j], heights[j, 0], heights[j, 1] = wall, left, right
        count += 1
    return count
