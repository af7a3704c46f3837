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
from tetraskel.kernels.voronoi_loops import turn

EPSILON = np.finfo(np.float64).eps
NONE = np.int64(-1)
BELOW = np.int64(0xFFFFFFFF)


@inlined
def _along(origin, way, place):
    return origin[0] + place * way[0], origin[1] + place * way[1], origin[2] + place * way[2]


@called
def _interval(points, begins, targets, cell, beside, origin, way):
    """See `voronoi_lines.nearest_on_lines`: where on a whole line a generator is the nearest, and who is beyond."""
    here = place_of(points, cell)
    own = (2 * (here[0] - origin[0]), 2 * (here[1] - origin[1]), 2 * (here[2] - origin[2]))
    step = (-2 * way[0], -2 * way[1], -2 * way[2])
    low, high, before, after = -np.inf, np.inf, targets[begins[cell]], targets[begins[cell]]
    for place in range(begins[cell], begins[cell + 1]):
        other = targets[place]
        if other == beside:
            continue
        side = between(points, cell, other)
        gap = dot(side, side) + side[0] * own[0] + side[1] * own[1] + side[2] * own[2]
        slope = dot(side, step)
        if slope > 0:
            bound = -gap / slope
            if bound > low:
                low, before = bound, other
        elif slope < 0:
            bound = -gap / slope
            if bound < high:
                high, after = bound, other
        elif gap < 0 and high > -np.inf:
            high, after = -np.inf, other
    return low, high, before, after


@called
def _common_line(points, triangle, normal, low, high):
    """See `boundary_division._common_lines`."""
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
        return corner, way, 0.0, 0.0
    origin = _along(corner, in_plane, dot(middle, across) / square)
    least, largest = -np.inf, np.inf
    for k in range(3):
        i, j, opposite = triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]
        inward = cross(normal, between(points, i, j))
        sign = np.sign(dot(inward, between(points, i, opposite)))
        inward = (inward[0] * sign, inward[1] * sign, inward[2] * sign)
        gap, slope = dot(inward, minus(origin, place_of(points, i))), dot(inward, way)
        if slope > 0:
            least = max(least, -gap / slope)
        elif slope < 0:
            largest = min(largest, -gap / slope)
        elif gap < 0:
            largest = -np.inf
    if not (np.isfinite(least) and np.isfinite(largest)):
        return origin, way, 0.0, 0.0
    return origin, way, least, largest


@called
def _joined(begins, targets, one, other):
    """Whether two points are neighbours."""
    least, most, n_points = begins[one], begins[one + 1], len(begins) - 1
    while least < most:
        middle = (least + most) // 2
        if turn(n_points, one, targets[middle]) < turn(n_points, one, other):
            least = middle + 1
        else:
            most = middle
    return least < begins[one + 1] and targets[least] == other


@inlined
def _is_new(pairs, n_pairs, one, other):
    """Whether a pair of cells is not among the first ones of these."""
    pair = (np.int64(min(one, other)) << 32) | np.int64(max(one, other))
    for k in range(n_pairs):  # noqa: SIM110 (numba has no generators here)
        if pairs[k] == pair:
            return False
    return True


@inner
def _add_pair(pairs, n_pairs, one, other):
    """Append a pair of cells as one number; the pairs, perhaps in a larger array, and how many."""
    pair = (np.int64(min(one, other)) << 32) | np.int64(max(one, other))
    if n_pairs == len(pairs):
        larger = np.empty(2 * n_pairs, np.int64)
        for k in range(n_pairs):
            larger[k] = pairs[k]
        pairs = larger
    pairs[n_pairs] = pair
    return pairs, n_pairs + 1


def on_edges(points, begins, targets, ends):
    """See `boundary_division.on_edges`: edges, pairs of cells, and places, edge by edge.

    Parameters
    ----------
    ends : (k, 2) int
        Points of each edge; points of the plane have a third coordinate 0.
    """
    found, places, n_found = np.empty((len(ends) + 64, 2), np.int64), np.empty((len(ends) + 64, 1)), 0
    for edge in range(len(ends)):
        cell, goal = ends[edge, 0], ends[edge, 1]
        origin, way = place_of(points, cell), between(points, cell, goal)
        while cell != goal:
            _, high, _, after = _interval(points, begins, targets, cell, NONE, origin, way)
            if not high <= 1.0 + ON_BORDER:
                break
            found, places = with_room(found, n_found), with_room(places, n_found)
            found[n_found, 0] = edge
            found[n_found, 1] = (np.int64(min(cell, after)) << 32) | np.int64(max(cell, after))
            places[n_found, 0] = max(min(high, 1.0), 0.0)
            n_found += 1
            cell = after
    return found[:n_found], places[:n_found]


@inner
def _start(points, begins, targets, triangle, pairs):
    """Pairs of cells that meet on the sides of a triangle; see `boundary_division.on_edges`."""
    n_pairs = 0
    for k in range(3):
        one, other = triangle[k], triangle[(k + 1) % 3]
        cell, goal = min(one, other), max(one, other)
        origin, way = place_of(points, cell), between(points, cell, goal)
        while cell != goal:
            _, high, _, after = _interval(points, begins, targets, cell, NONE, origin, way)
            if not high <= 1.0 + ON_BORDER:
                break
            if _is_new(pairs, n_pairs, cell, after):
                pairs, n_pairs = _add_pair(pairs, n_pairs, cell, after)
            cell = after
    return pairs, n_pairs


@inner
def with_room(values, size):
    """The rows, perhaps in a larger array, which has more than `size` of them."""
    if size < len(values):
        return values
    larger = np.empty((2 * size + 1, values.shape[1]), values.dtype)
    for i in range(len(values)):
        for k in range(values.shape[1]):
            larger[i, k] = values[i, k]
    return larger


@inlined
def _is_new_place(owners, places, first, last, same):
    """Whether the cells of the last row do not meet there in a row before it; who has them is sure if either is."""
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
            return False
    return True


def on_triangles(points, begins, targets, same, first, facets, outward):
    """See `boundary_division.on_triangles`, by triangles, whose numbers begin with `first`.

    Places closer than `same` where the same cells meet on a triangle are one.

    Returns
    -------
    owners, places : (k, 5) int, (k, 3) float
        Where cells meet: three generators, the triangle, and whether it is sure.
    pairs, segments : (s, 2) int, (s, 6) float
        Key of two cells and the triangle, and the two ends of what they have in common there.
    """
    owners, places, n_places = np.empty((64, 5), np.int64), np.empty((64, 3)), 0
    keys, segments, n_segments = np.empty((64, 2), np.int64), np.empty((64, 6)), 0
    jobs = np.empty(16, np.int64)
    for facet in range(len(facets)):
        triangle = (facets[facet, 0], facets[facet, 1], facets[facet, 2])
        normal = place_of(outward, facet)
        jobs, n_jobs = _start(points, begins, targets, triangle, jobs)
        done, first_place = 0, n_places
        while done < n_jobs:
            pair = jobs[done]
            done += 1
            one, other = pair >> 32, pair & BELOW
            origin, way, least, largest = _common_line(points, triangle, normal, one, other)
            low, high, before, after = _interval(points, begins, targets, one, other, origin, way)
            near = ON_BORDER * (largest - least)
            before = before if low >= least - near else -1
            after = after if high <= largest + near else -1
            low, high = max(low, least), min(high, largest)
            if high > low:
                keys, segments = with_room(keys, n_segments), with_room(segments, n_segments)
                start, stop = _along(origin, way, low), _along(origin, way, high)
                keys[n_segments, 0], keys[n_segments, 1] = pair, first + facet
                for axis in range(3):
                    segments[n_segments, axis], segments[n_segments, 3 + axis] = start[axis], stop[axis]
                n_segments += 1
            for beyond, place in ((before, low), (after, high)):
                if beyond < 0:
                    continue
                if high > low:
                    owners, places = with_room(owners, n_places), with_room(places, n_places)
                    row = owners[n_places]
                    row[0], row[1], row[2] = min(one, beyond), max(one, min(other, beyond)), max(other, beyond)
                    row[3], row[4] = first + facet, min(place - least, largest - place) > near
                    spot = _along(origin, way, place)
                    places[n_places, 0], places[n_places, 1], places[n_places, 2] = spot
                    n_places += _is_new_place(owners, places, first_place, n_places, same)
                if high - low > -near:
                    for side in (one, other):
                        if _is_new(jobs, n_jobs, side, beyond) and _joined(begins, targets, side, beyond):
                            jobs, n_jobs = _add_pair(jobs, n_jobs, side, beyond)
    return owners[:n_places], places[:n_places], keys[:n_segments], segments[:n_segments]
