"""Voronoi faces cut by the object's boundary, one face after another, for numba to compile.

The same as array operations is in `voronoi_clip` and `polygon_slabs`, for where there is no numba, and for the few
faces that are in doubt: there a walk through the mesh is asked. Imported only where numba is.
"""

from __future__ import annotations

import math

import numpy as np

from tetraskel.kernels.boundary_loops import with_room
from tetraskel.kernels.compilation import called, inlined, inner
from tetraskel.kernels.polygon_slabs import BOTTOM, ENTER, INSIDE, NOTHING, OUTSIDE, THIN, TOP, UNSURE
from tetraskel.kernels.wall_loops import (
    EDGE,
    KIND,
    LEFT_PLACE,
    LEFT_U,
    RIGHT_PLACE,
    RIGHT_U,
    boundary_walls,
    frame_between,
    own_walls,
    slab_lines,
    walls_of_slab,
)

ABOVE, BELOW = np.bool_(True), np.bool_(False)


@called
def _says(known, walls, numbers, wall, middle, above):
    """What a wall says of the side above or below it; see `polygon_slabs.sides_between`."""
    ends, inside, plain, first_crossing, places, entering = known
    kind, edge = numbers[wall, KIND], numbers[wall, EDGE]
    if kind >= ENTER:
        return INSIDE if (kind == ENTER) == above else OUTSIDE
    if not plain[edge]:
        return UNSURE
    share = (middle - walls[wall, LEFT_U]) / (walls[wall, RIGHT_U] - walls[wall, LEFT_U])
    place = walls[wall, LEFT_PLACE] + share * (walls[wall, RIGHT_PLACE] - walls[wall, LEFT_PLACE])
    first, last = first_crossing[edge], first_crossing[edge + 1]
    at = first
    while at < last and places[at] < place:
        at += 1
    if at == first:
        return INSIDE if inside[ends[edge, 0]] else OUTSIDE
    if at == last:
        return INSIDE if inside[ends[edge, 1]] else OUTSIDE
    return INSIDE if entering[at - 1] and not entering[at] else OUTSIDE


@inlined
def _between_walls(known, walls, numbers, lower, upper, middle):
    """INSIDE, OUTSIDE, UNSURE or NOTHING."""
    if numbers[lower, KIND] == TOP or numbers[upper, KIND] == BOTTOM:
        return NOTHING
    above = _says(known, walls, numbers, lower, middle, ABOVE)
    return above if above == _says(known, walls, numbers, upper, middle, BELOW) else UNSURE


@inner
def _trapezoids(known, walls, numbers, n, lines, n_lines, work, parts):
    """What is inside of a face, slab after slab: how many parts, -1 where it is not known, and these."""
    here, heights = work
    count = 0
    for slab in range(n_lines - 1):
        k = walls_of_slab(walls, numbers, n, slab, lines, here, heights)
        middle = 0.5 * (lines[slab] + lines[slab + 1])
        for i in range(k - 1):
            side = _between_walls(known, walls, numbers, here[i], here[i + 1], middle)
            if side == UNSURE:
                return np.int64(-1), parts
            low, high = (heights[i, 0], heights[i, 1]), (heights[i + 1, 0], heights[i + 1, 1])
            high = (max(high[0], low[0]), max(high[1], low[1]))
            if side != INSIDE or not (high[0] - low[0]) + (high[1] - low[1]) > 0:
                continue
            if count == len(parts):
                parts = with_room(parts, count)
            parts[count, 0], parts[count, 1], parts[count, 2] = slab, lines[slab], lines[slab + 1]
            parts[count, 3], parts[count, 4], parts[count, 5], parts[count, 6] = low[0], low[1], high[0], high[1]
            count += 1
    return np.int64(count), parts


@inlined
def _goes_on(parts, count, i):
    """Whether a part belongs to the same polygon as the one before it; see `polygon_slabs.monotone_polygons`."""
    slab, before = parts[i, 0], parts[i - 1, 0]
    if slab != before + 1 or (i + 1 < count and parts[i + 1, 0] == slab) or (i > 1 and parts[i - 2, 0] == before):
        return False
    return parts[i - 1, 6] > parts[i, 3] and parts[i, 5] > parts[i - 1, 4]


@called
def _outline(parts, first, last, corners):
    """Corners of a polygon, counter-clockwise, those left out that are repeated or on straight lines; how many."""
    n, k = 0, last - first
    for i in range(k):
        for side in range(2):
            corners[n, 0], corners[n, 1] = parts[first + i, 1 + side], parts[first + i, 3 + side]
            corners[n + 2 * k, 0] = parts[last - 1 - i, 2 - side]
            corners[n + 2 * k, 1] = parts[last - 1 - i, 6 - side]
            n += 1
    n = 4 * k
    size = 0.0
    for i in range(n):
        size = max(size, abs(corners[i, 0] - corners[0, 0]), abs(corners[i, 1] - corners[0, 1]))
    before, kept = (corners[n - 1, 0], corners[n - 1, 1]), 0
    for i in range(n):
        here = (corners[i, 0], corners[i, 1])
        if max(abs(here[0] - before[0]), abs(here[1] - before[1])) > THIN * size:
            corners[kept, 0], corners[kept, 1] = here
            kept += 1
        before = here
    n, kept = kept, 0
    if n == 0:
        return 0
    opening, before = (corners[0, 0], corners[0, 1]), (corners[n - 1, 0], corners[n - 1, 1])
    for i in range(n):
        here = (corners[i, 0], corners[i, 1])
        after = (corners[i + 1, 0], corners[i + 1, 1]) if i + 1 < n else opening
        back, ahead = (here[0] - before[0], here[1] - before[1]), (after[0] - here[0], after[1] - here[1])
        turn = back[0] * ahead[1] - back[1] * ahead[0]
        lengths = (back[0] * back[0] + back[1] * back[1]) * (ahead[0] * ahead[0] + ahead[1] * ahead[1])
        if abs(turn) > THIN * math.sqrt(lengths):
            corners[kept, 0], corners[kept, 1] = here
            kept += 1
        before = here
    return kept


@inner
def _write(found, n_found, corners, n, frame):
    """Write a polygon's corners in space behind others; all of them, perhaps in a larger array."""
    if n_found + n > len(found):
        found = with_room(found, n_found + n)
    origin, across, up = frame
    for i in range(n):
        u, v = corners[i, 0], corners[i, 1]
        for axis in range(3):
            found[n_found + i, axis] = origin[axis] + (u * across[axis] + v * up[axis])
    return found


def clipped(points, diagram, known, crossed, segments, outward, ball, first_row, starts, wedges, generators, bounds):
    """See `voronoi_clip`: the parts inside of some faces, whose rows begin with `first_row`.

    Returns
    -------
    polygons : (p, 2) int
        Row of the face, and how many corners.
    corners : (total, 3) float
    unsure : (q,) bool
        Faces that are left to others.
    """
    n_faces, most = len(starts) - 1, 8
    unsure = np.zeros(n_faces, np.bool_)
    polygons, n_polygons = np.empty((n_faces + 1, 2), np.int64), 0
    found, n_found = np.empty((4 * n_faces + 1, 3)), 0
    parts = np.empty((16, 7))
    for face in range(n_faces):
        most = max(most, 2 * (starts[face + 1] - starts[face]) + bounds[face, 1] - bounds[face, 0])
    walls, numbers = np.empty((most, 6)), np.empty((most, 4), np.int64)
    lines, order = np.empty(2 * most), np.empty(2 * most, np.int64)
    work = (np.empty(most, np.int64), np.empty((most, 2)))
    corners = np.empty((64, 2))
    everything = (diagram[1], known[0], known[1], crossed[0], crossed[1], crossed[2])
    for face in range(n_faces):
        frame = frame_between(points, generators[face, 0], generators[face, 1])
        n = own_walls(diagram, wedges[starts[face] : starts[face + 1]], frame, ball, walls, numbers)
        n = boundary_walls(segments, outward, bounds[face], frame, walls, numbers, n)
        if n == 0:
            continue
        n_lines = slab_lines(walls, numbers, n, lines, order)
        n_parts, parts = _trapezoids(everything, walls, numbers, n, lines, n_lines, work, parts)
        unsure[face] = n_parts < 0
        first = 0
        for last in range(1, n_parts + 1):
            if last < n_parts and _goes_on(parts, n_parts, last):
                continue
            if 4 * (last - first) > len(corners):
                corners = np.empty((8 * (last - first), 2))
            k = _outline(parts, first, last, corners)
            first = last
            if k < 3:
                continue
            if n_polygons == len(polygons):
                polygons = with_room(polygons, n_polygons)
            polygons[n_polygons, 0], polygons[n_polygons, 1] = first_row + face, k
            n_polygons += 1
            found = _write(found, n_found, corners, k, frame)
            n_found += k
    return polygons[:n_polygons], found[:n_found], unsure
