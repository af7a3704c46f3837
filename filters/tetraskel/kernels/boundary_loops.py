"""The boundary's triangles divided among the Voronoi cells, one triangle after another, for numba to compile.

The same as array operations is in `boundary_division` and `voronoi_lines`, for where there is no numba: those go a step
along all lines at once, these along one line to its end; the formulas and the order of their operations are the same,
and so are the numbers, to the last bit. Imported only where numba is.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import called, inlined, inner
from tetraskel.kernels.vector_loops import between, cross, dot, minus, place_of
from tetraskel.kernels.voronoi_lines import ON_BORDER

EPSILON = np.finfo(np.float64).eps
NONE = np.int64(-1)
TARGETS, PLACES, SEGMENTS = 0, 1, 2  # what is counted: neighbours that are known, places, segments
BELOW = np.int64(0xFFFFFFFF)
ROUNDING = 1e-12  # relative, of a sum of products: well above what is lost


@inlined
def _along(origin, way, place):
    return origin[0] + place * way[0], origin[1] + place * way[1], origin[2] + place * way[2]


@inlined
def _turn(n_points, point, other):
    """How far it is from a point to another, upwards and on from the first."""
    return other - point if other > point else other - point + n_points


@called
def _learn(star, known, used, cell):
    """Append the Delaunay neighbours of a point to those known, if they are not; False where there is no room.

    Those above the point come first, then those below it, as in `voronoi_lines.Neighbours`: the first of equals counts.
    """
    simplices, starts, cells = star
    begins, seen, targets = known
    if begins[cell, 0] >= 0:
        return True
    n_points, size = len(starts) - 1, used[TARGETS]
    if size + simplices.shape[1] * (starts[cell + 1] - starts[cell]) > len(targets):
        return False
    begins[cell, 0] = size
    for place in range(starts[cell], starts[cell + 1]):
        for k in range(simplices.shape[1]):
            other = simplices[cells[place], k]
            if other != cell and seen[other] != cell:
                seen[other] = cell
                j = size
                while j > begins[cell, 0] and _turn(n_points, cell, targets[j - 1]) > _turn(n_points, cell, other):
                    targets[j] = targets[j - 1]
                    j -= 1
                targets[j] = other
                size += 1
    begins[cell, 1] = used[TARGETS] = size
    return True


@called
def _interval(points, known, cell, beside, line, span):
    """See `voronoi_lines.nearest_on_lines`: where in a span of a line a generator is the nearest, and who is beyond.

    Most neighbours are farther at both ends of what is left of the span, by more than rounding, and so between them:
    of these nothing more is asked.
    """
    begins, _, targets = known
    (origin, way), (least, largest) = line, span
    near = ON_BORDER * (largest - least)
    here = place_of(points, cell)
    own = (2 * (here[0] - origin[0]), 2 * (here[1] - origin[1]), 2 * (here[2] - origin[2]))
    step = (-2 * way[0], -2 * way[1], -2 * way[2])
    low, high, before, after = least - near, largest + near, NONE, NONE
    for place in range(begins[cell, 0], begins[cell, 1]):
        other = targets[place]
        side = between(points, cell, other)
        gap = dot(side, side) + side[0] * own[0] + side[1] * own[1] + side[2] * own[2]
        slope = dot(side, step)
        rounding = ROUNDING * abs(gap)
        if (gap + low * slope > rounding and gap + high * slope > rounding) or other == beside:
            continue
        if slope > 0:
            bound = -gap / slope
            if bound > low or (bound == low and before < 0):
                low, before = bound, np.int64(other)
        elif slope < 0:
            bound = -gap / slope
            if bound < high or (bound == high and after < 0):
                high, after = bound, np.int64(other)
        elif gap < 0 and high > -np.inf:
            high, after = -np.inf, np.int64(other)
    return max(low, least), min(high, largest), before, after


@called
def _common_line(points, triangle, normal, low, high):
    """See `boundary_division._common_lines`; with the side of the triangle on which each end lies."""
    corner = place_of(points, triangle[0])
    across = between(points, low, high)
    upright = dot(across, normal)
    in_plane = (
        across[0] - normal[0] * upright,
        across[1] - normal[1] * upright,
        across[2] - normal[2] * upright,
    )
    way, square = cross(normal, in_plane), dot(in_plane, in_plane)
    middle = (
        (points[high, 0] + points[low, 0]) / 2 - corner[0],
        (points[high, 1] + points[low, 1]) / 2 - corner[1],
        (points[high, 2] + points[low, 2]) / 2 - corner[2],
    )
    if square <= EPSILON * dot(across, across):
        return corner, way, 0.0, 0.0, 0, 0
    origin = _along(corner, in_plane, dot(middle, across) / square)
    least, largest, first_side, last_side = -np.inf, np.inf, 0, 0
    for k in range(3):
        i, j, opposite = triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]
        inward = cross(normal, between(points, i, j))
        sign = np.sign(dot(inward, between(points, i, opposite)))
        inward = (inward[0] * sign, inward[1] * sign, inward[2] * sign)
        gap, slope = dot(inward, minus(origin, place_of(points, i))), dot(inward, way)
        if slope > 0:
            if -gap / slope > least:
                least, first_side = -gap / slope, k
        elif slope < 0:
            if -gap / slope < largest:
                largest, last_side = -gap / slope, k
        elif gap < 0:
            largest = -np.inf
    if not (np.isfinite(least) and np.isfinite(largest)):
        return origin, way, 0.0, 0.0, 0, 0
    return origin, way, least, largest, first_side, last_side


@called
def _joined(known, one, other):
    """Whether a point, the neighbours of which are known, has another among them."""
    begins, _, targets = known
    least, most, n_points = begins[one, 0], begins[one, 1], len(begins)
    while least < most:
        middle = (least + most) // 2
        if _turn(n_points, one, targets[middle]) < _turn(n_points, one, other):
            least = middle + 1
        else:
            most = middle
    return least < begins[one, 1] and targets[least] == other


@inlined
def _pair(one, other):
    """Two cells as one number."""
    return (np.int64(min(one, other)) << 32) | np.int64(max(one, other))


@inlined
def _is_new(pairs, n_pairs, one, other):
    """Whether a pair of cells is not among the first ones of these."""
    pair = _pair(one, other)
    for k in range(n_pairs):  # noqa: SIM110 (numba has no generators here)
        if pairs[k, 0] == pair:
            return False
    return True


@inner
def _nothing_known(n_points):
    """Where the neighbours of each point begin and end, of whom a point was last seen as one, and room for some."""
    return np.full((n_points, 2), -1), np.full(n_points, -1, np.int32), np.empty(1 << 12, np.int32)


@inner
def _doubled(values):
    """The rows in an array with room for twice as many."""
    larger = np.empty((2 * len(values), values.shape[1]), values.dtype)
    for i in range(len(values)):
        for k in range(values.shape[1]):
            larger[i, k] = values[i, k]
    return larger


@inner
def _with_more(known):
    """The same with room for twice as many neighbours."""
    begins, seen, targets = known
    more = np.empty(2 * len(targets), np.int32)
    for k in range(len(targets)):
        more[k] = targets[k]
    return begins, seen, more


@called
def _along_edge(points, star, known, used, edge, ends, found, places):
    """Write where the cells along an edge meet; False where there is no room, with what is used not told."""
    cell, goal = ends
    line, n = (place_of(points, cell), between(points, cell, goal)), used[PLACES]
    while cell != goal:
        if n == len(found) or not _learn(star, known, used, cell):
            return False
        _, high, _, after = _interval(points, known, cell, NONE, line, (0.0, 1.0))
        if after < 0:
            break
        found[n, 0], found[n, 1], places[n, 0] = edge, _pair(cell, after), max(high, 0.0)
        n += 1
        cell = after
    used[PLACES] = n
    return True


def on_edges(points, simplices, starts, cells, first, ends):
    """See `boundary_division.on_edges`: edges, numbered from `first` on, pairs of cells, and places, edge by edge.

    Parameters
    ----------
    ends : (k, 2) int
        Points of each edge; points of the plane have a third coordinate 0.
    """
    found, places = np.empty((len(ends) + 64, 2), np.int64), np.empty((len(ends) + 64, 1))
    star, known, used = (simplices, starts, cells), _nothing_known(len(points)), np.zeros(3, np.int64)
    for edge in range(len(ends)):
        while not _along_edge(points, star, known, used, first + edge, (ends[edge, 0], ends[edge, 1]), found, places):
            known, found, places = _with_more(known), _doubled(found), _doubled(places)
    return found[: used[PLACES]], places[: used[PLACES]]


@inlined
def _on_side(triangle, side):
    """What an end on a side of a triangle is; see `boundary_division.Segments`."""
    return -1 - _pair(triangle[side], triangle[(side + 1) % 3])


@inlined
def _row_of_place(owners, places, first, last, same):
    """The row, the last or one before it, in which the cells of the last meet there; it is sure if either is, and of
    places that differ by rounding it has the first.
    """
    spot = place_of(places, last)
    for k in range(first, last):
        away = minus(spot, place_of(places, k))
        if (
            owners[k, 0] == owners[last, 0]
            and owners[k, 1] == owners[last, 1]
            and owners[k, 2] == owners[last, 2]
            and dot(away, away) <= same * same
        ):
            owners[k, 4] |= owners[last, 4]
            if spot < place_of(places, k):
                places[k, 0], places[k, 1], places[k, 2] = spot
            return k
    return last


@called
def _on_sides(points, star, known, used, triangle, jobs):
    """Pairs of cells that meet on the sides of a triangle, see `boundary_division.on_edges`: how many, -1 where there
    is no room.
    """
    n_jobs = 0
    for k in range(3):
        cell, goal = min(triangle[k], triangle[(k + 1) % 3]), max(triangle[k], triangle[(k + 1) % 3])
        line = place_of(points, cell), between(points, cell, goal)
        while cell != goal:
            if n_jobs == len(jobs) or not _learn(star, known, used, cell):
                return -1
            _, _, _, after = _interval(points, known, cell, NONE, line, (0.0, 1.0))
            if after < 0:
                break
            if _is_new(jobs, n_jobs, cell, after):
                jobs[n_jobs, 0] = _pair(cell, after)
                n_jobs += 1
            cell = after
    return n_jobs


@called
def _on_triangle(points, star, known, used, triangle, normal, number, same, room):
    """Write what there is on a triangle; False where there is no room, with what is used not told."""
    owners, places, keys, segments, jobs = room
    n_places, n_segments = used[PLACES], used[SEGMENTS]
    done, n_jobs = 0, _on_sides(points, star, known, used, triangle, jobs)
    while done < n_jobs:
        pair = jobs[done, 0]
        done += 1
        one, other = pair >> 32, pair & BELOW
        if not (_learn(star, known, used, one) and _learn(star, known, used, other)):
            return False
        if n_segments + 1 >= len(keys) or n_places + 2 >= len(owners) or n_jobs + 4 >= len(jobs):
            return False
        origin, way, least, largest, first_side, last_side = _common_line(points, triangle, normal, one, other)
        low, high, before, after = _interval(points, known, one, other, (origin, way), (least, largest))
        near = ON_BORDER * (largest - least)
        if high > low:
            start, stop = _along(origin, way, high), _along(origin, way, low)
            keys[n_segments, 0], keys[n_segments, 1] = pair, number
            keys[n_segments, 2], keys[n_segments, 3] = _on_side(triangle, last_side), _on_side(triangle, first_side)
            for axis in range(3):
                segments[n_segments, axis], segments[n_segments, 3 + axis] = start[axis], stop[axis]
            n_segments += 1
        for end, beyond, place in ((3, before, low), (2, after, high)):
            if beyond < 0:
                continue
            if high > low:
                owners[n_places, 0], owners[n_places, 2] = min(one, beyond), max(other, beyond)
                owners[n_places, 1], owners[n_places, 3] = max(one, min(other, beyond)), number
                owners[n_places, 4] = min(place - least, largest - place) > near
                spot = _along(origin, way, place)
                places[n_places, 0], places[n_places, 1], places[n_places, 2] = spot
                found = _row_of_place(owners, places, used[PLACES], n_places, same)
                keys[n_segments - 1, end] = found - used[PLACES]
                n_places += found == n_places
            if high - low > -near:
                for side in (one, other):
                    if _is_new(jobs, n_jobs, side, beyond) and _joined(known, side, beyond):
                        jobs[n_jobs, 0] = _pair(side, beyond)
                        n_jobs += 1
    if n_jobs >= 0:
        used[PLACES], used[SEGMENTS] = n_places, n_segments
    return n_jobs >= 0


def on_triangles(points, simplices, starts, cells, same, first, facets, outward):
    """See `boundary_division.on_triangles`, by triangles, whose numbers begin with `first`.

    Places closer than `same` where the same cells meet on a triangle are one.

    Returns
    -------
    owners, places : (k, 5) int, (k, 3) float
        Where cells meet: three generators, the triangle, and whether it is sure.
    pairs, segments : (s, 4) int, (s, 6) float
        Key of two cells, the triangle, and what each end of what they have in common there is: the number of a place
        among those of the triangle, or -1 - the key of a side of the triangle; and the two ends.
    """
    owners, places, jobs = np.empty((1 << 10, 5), np.int64), np.empty((1 << 10, 3)), np.empty((1 << 8, 1), np.int64)
    keys, segments = np.empty((1 << 10, 4), np.int64), np.empty((1 << 10, 6))
    star, known, used = (simplices, starts, cells), _nothing_known(len(points)), np.zeros(3, np.int64)
    for facet in range(len(facets)):
        triangle = (facets[facet, 0], facets[facet, 1], facets[facet, 2])
        normal, number = place_of(outward, facet), first + facet
        room = (owners, places, keys, segments, jobs)
        while not _on_triangle(points, star, known, used, triangle, normal, number, same, room):
            owners, places = _doubled(owners), _doubled(places)
            keys, segments = _doubled(keys), _doubled(segments)
            known, jobs = _with_more(known), _doubled(jobs)
            room = (owners, places, keys, segments, jobs)
    return owners[: used[PLACES]], places[: used[PLACES]], keys[: used[SEGMENTS]], segments[: used[SEGMENTS]]
