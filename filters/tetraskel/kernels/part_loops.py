"""Walks around the parts of Voronoi faces, one face after another, for numba to compile.

The same as array operations is in `voronoi_parts`, for where there is no numba, and the results are equal. Imported
only where numba is.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import called, inlined, inner
from tetraskel.kernels.voronoi_faces import AHEAD, BEHIND, WEDGE_BITS

FEW = 64  # ways of a face that are compared with one another
BEGIN, END, NODE = 0, 1, 2  # columns of ways: what they begin and end at, and the node they begin with
POLYGONS, NODES = 0, 1  # what is counted


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
def _only_touches(touching, wedges):
    """Whether all vertices of a face lie on the boundary: nothing is known of it."""
    for i in range(len(wedges)):  # noqa: SIM110 (numba has no generators here)
        if not touching[wedges[i] >> WEDGE_BITS]:
            return False
    return True


@called
def _is_whole(whole, wedges):
    """Whether all edges of a face are inside."""
    for i in range(len(wedges)):  # noqa: SIM110 (numba has no generators here)
        if not whole[wedges[i] >> WEDGE_BITS, AHEAD[wedges[i] & ((1 << WEDGE_BITS) - 1)]]:
            return False
    return True


@called
def _own_ways(mesh, known, parts, wedges, ways):
    """The ways along a face's own edges, where these are inside; how many, -1 where something is not known."""
    neighbors, ends, edge_of_first_half, whole = mesh
    first_part, nodes = parts
    n, m = 0, len(neighbors)
    for turn in range(2):  # the rays that open faces come last
        for i in range(len(wedges)):
            cell, corner = wedges[i] >> WEDGE_BITS, wedges[i] & ((1 << WEDGE_BITS) - 1)
            half = 4 * cell + (AHEAD[corner] if turn == 0 else BEHIND[corner])
            if turn == 1 and neighbors[cell, half & 3] >= 0:
                continue
            edge = _edge_of(neighbors, edge_of_first_half, half)
            if not known[edge]:
                return np.int64(-1)
            forward = (ends[edge, 0] == cell or ends[edge, 1] >= m) != (turn == 1)
            if whole[cell, half & 3]:
                ways[n, BEGIN], ways[n, END], ways[n, NODE] = cell, ends[edge, 1 if forward else 0], cell
                n += 1
                continue
            first, last = first_part[edge], first_part[edge + 1]
            for k in range(last - first):
                part = first + k if forward else last - 1 - k
                ways[n, BEGIN], ways[n, END] = nodes[part, 0 if forward else 1], nodes[part, 1 if forward else 0]
                ways[n, NODE] = ways[n, BEGIN]
                n += 1
    return np.int64(n)


@called
def _follow(ways, n, after):
    """Find the way after each; whether there is one for all, and each is after one."""
    for i in range(n):
        after[i, 1] = 0
        for j in range(i):
            if ways[j, BEGIN] == ways[i, BEGIN]:
                return False
    for i in range(n):
        found = i + 1 if i + 1 < n else 0  # the next one is the likeliest
        if ways[found, BEGIN] != ways[i, END]:
            found = 0
            while found < n and ways[found, BEGIN] != ways[i, END]:
                found += 1
        if found == n or after[found, 1] != 0:
            return False
        after[i, 0], after[found, 1] = found, 1
    return True


@inner
def _follow_many(ways, n, after):
    """The same for many ways, which are found by their order."""
    order = np.argsort(ways[:n, BEGIN])
    for i in range(n):
        after[i, 1] = 0
        if i > 0 and ways[order[i], BEGIN] == ways[order[i - 1], BEGIN]:
            return False
    for i in range(n):
        low, high = 0, n
        while low < high:
            middle = (low + high) // 2
            low, high = (middle + 1, high) if ways[order[middle], BEGIN] < ways[i, END] else (low, middle)
        if low == n or ways[order[low], BEGIN] != ways[i, END] or after[order[low], 1] != 0:
            return False
        after[i, 0], after[order[low], 1] = order[low], 1
    return True


@called
def _write(used, polygons, row, count):
    """Count a polygon whose corners are written already; those of less than three are none."""
    if count >= 3:
        polygons[used[POLYGONS], 0], polygons[used[POLYGONS], 1] = row, count
        used[POLYGONS], used[NODES] = used[POLYGONS] + 1, used[NODES] + count


@called
def _rounds(ways, n, n_own, after, row, used, polygons, nodes):
    """Write the ways around, those with a way along an own edge, as polygons; none, and False, if others are left."""
    before, left = (used[POLYGONS], used[NODES]), n
    for head in range(n_own):
        if after[head, 1] == 2:
            continue
        i, count = head, 0
        while after[i, 1] != 2:
            nodes[used[NODES] + count] = ways[i, NODE]
            after[i, 1] = 2
            i = after[i, 0]
            count += 1
        left -= count
        _write(used, polygons, row, count)
    if left:
        used[POLYGONS], used[NODES] = before
    return left == 0


def walked(mesh, known, touching, parts, most_parts, segments, first_row, starts, wedges, bounds):
    """See `voronoi_parts`: the parts inside of some faces, whose rows begin with `first_row`.

    Returns
    -------
    polygons : (p, 2) int
        Row of the face, and how many corners.
    nodes : (total,) int
    unsure : (q,) bool
        Faces of which it cannot be told.
    """
    n_faces, (by_face, ends, n_nodes) = len(starts) - 1, segments
    most, total = 0, 0
    for face in range(n_faces):
        # each wedge has an edge ahead, and where several fans of simplices lie at an edge, a ray behind
        room = 2 * (starts[face + 1] - starts[face]) * most_parts + bounds[face, 1] - bounds[face, 0]
        most, total = max(most, room), total + room
    ways, after = np.empty((most, 3), np.int64), np.empty((most, 2), np.int64)
    polygons, nodes, used = np.empty((total // 3, 2), np.int64), np.empty(total, np.int64), np.zeros(2, np.int64)
    unsure = np.zeros(n_faces, np.bool_)
    for face in range(n_faces):
        own = wedges[starts[face] : starts[face + 1]]
        if _only_touches(touching, own):
            unsure[face] = True
            continue
        if bounds[face, 0] == bounds[face, 1] and _is_whole(mesh[3], own):
            for i in range(len(own)):
                nodes[used[NODES] + i] = own[i] >> WEDGE_BITS
            _write(used, polygons, first_row + face, len(own))
            continue
        n_own = _own_ways(mesh, known, parts, own, ways)
        if n_own < 0:
            unsure[face] = True
            continue
        n = n_own
        for place in range(bounds[face, 0], bounds[face, 1]):
            i = by_face[place]
            ways[n, BEGIN], ways[n, END] = ends[i, 0], ends[i, 1]
            ways[n, NODE] = ends[i, 0] if ends[i, 0] >= 0 else n_nodes + i
            n += 1
        sure = _follow(ways, n, after) if n <= FEW else _follow_many(ways, n, after)
        unsure[face] = not (sure and _rounds(ways, n, n_own, after, first_row + face, used, polygons, nodes))
    return polygons[: used[POLYGONS]], nodes[: used[NODES]], unsure
