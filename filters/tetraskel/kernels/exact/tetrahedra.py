"""Insertion of points into a Delaunay triangulation of space.

A cell is four vertices, and behind each vertex the *mate* of the facet opposite it: facet k of cell c has the number
4 c + k, and its mate is the number of the same facet seen from the other side. A vertex at infinity closes the
triangulation: behind every hull facet is a cell with it. All cells are positively oriented, the infinite ones once
their vertex at infinity is a point far out.

The slots of a cell need no tables: for every k, (k, k^1, k^2, k^3) is an even permutation of the four.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.compilation import compiled_without_arrays, inlined
from tetraskel.kernels.exact.linking import link, link_by_hash
from tetraskel.kernels.exact.predicates import in_sphere, orient3
from tetraskel.kernels.exact.state import DONE, FREE, LAST, STAMP, USED

TABLE = 256  # star vertices for which pairs are looked up in a square table


def scratch(n_points: int) -> tuple[NDArray[np.int32], ...]:
    """Arrays that `insert` uses: the number of each vertex in the last star it was in, and a table of pairs of them."""
    return np.zeros(2 * n_points + 2, np.int32), np.empty(TABLE**2, np.int32)


@inlined
def _side(points, a, b, c, d, bound):
    """Orientation of four finite vertices."""
    a, b, c, d = 3 * a, 3 * b, 3 * c, 3 * d
    return orient3(
        points[a], points[a + 1], points[a + 2], points[b], points[b + 1], points[b + 2],
        points[c], points[c + 1], points[c + 2], points[d], points[d + 1], points[d + 2], bound,
    )  # fmt: skip


@inlined
def infinite_slot(vertices, cell, far):
    """Slot of the vertex at infinity, or -1."""
    for k in range(4):
        if vertices[4 * cell + k] == far:
            return k
    return -1


@inlined
def in_conflict(points, vertices, mates, cell, p, far, bounds):
    """Whether a point forbids a cell.

    An infinite cell is forbidden from beyond its hull facet. A point in the plane of that facet is in the sphere of the
    finite cell behind it exactly if it is in the facet's circle, so there that cell decides for both.
    """
    k = infinite_slot(vertices, cell, far)
    if k >= 0:
        base = 4 * cell
        side = _side(points, p, np.int64(vertices[base + (k ^ 1)]), np.int64(vertices[base + (k ^ 2)]),
                     np.int64(vertices[base + (k ^ 3)]), bounds[0])  # fmt: skip
        if side != 0:
            return side > 0
        cell = np.int64(mates[base + k]) >> 2
    a, b = 3 * np.int64(vertices[4 * cell]), 3 * np.int64(vertices[4 * cell + 1])
    c, d = 3 * np.int64(vertices[4 * cell + 2]), 3 * np.int64(vertices[4 * cell + 3])
    p = 3 * p
    return in_sphere(
        points[a], points[a + 1], points[a + 2], points[b], points[b + 1], points[b + 2],
        points[c], points[c + 1], points[c + 2], points[d], points[d + 1], points[d + 2],
        points[p], points[p + 1], points[p + 2], bounds,
    )  # fmt: skip


@inlined
def locate(points, vertices, mates, cell, p, far, bound):
    """A cell that holds a point, or an infinite one whose facet sees it, by a visibility walk.

    Every step crosses a facet that separates the cell from the point. In a Delaunay triangulation this cannot go round
    in circles (Edelsbrunner 1990; Devillers, Pion and Teillaud 2002).
    """
    k = infinite_slot(vertices, cell, far)
    if k >= 0:
        cell = np.int64(mates[4 * cell + k]) >> 2
    entry = -1
    while True:
        base, crossed = 4 * cell, -1
        for k in range(4):
            if k != entry and _side(points, p, np.int64(vertices[base + (k ^ 1)]), np.int64(vertices[base + (k ^ 2)]),
                                    np.int64(vertices[base + (k ^ 3)]), bound) < 0:  # fmt: skip
                crossed = k
                break
        if crossed < 0:
            return cell
        mate = np.int64(mates[base + crossed])
        cell, entry = mate >> 2, mate & 3
        if infinite_slot(vertices, cell, far) >= 0:
            return cell


@inlined
def equal_vertex(points, vertices, cell, p, far):
    """The vertex of a cell that lies where a point lies, or -1; of the cells that hold the point every one has it."""
    for k in range(4):
        v = np.int64(vertices[4 * cell + k])
        if (
            v != far
            and points[3 * v] == points[3 * p]
            and points[3 * v + 1] == points[3 * p + 1]
            and points[3 * v + 2] == points[3 * p + 2]
        ):
            return v
    return -1


@inlined
def find_cavity(points, vertices, mates, marks, cell, p, far, bounds, stamp, cavity, border):
    """All cells in conflict with a point, from one of them on (Bowyer 1981, Watson 1981).

    Fills `cavity` with the cells and `border` with their facets to cells that stay; returns the number of each, or -1
    when the arrays are too short.
    """
    inside, outside = 2 * stamp, 2 * stamp + 1
    marks[cell] = inside
    cavity[0] = cell
    n_cells, n_facets, done = 1, 0, 0
    while done < n_cells:
        if n_cells + 4 > len(cavity) or n_facets + 4 > len(border):
            return -1, -1
        base = 4 * np.int64(cavity[done])
        done += 1
        for k in range(4):
            other = np.int64(mates[base + k]) >> 2
            mark = marks[other]
            if mark == inside:
                continue
            if mark != outside:
                if in_conflict(points, vertices, mates, other, p, far, bounds):
                    marks[other] = inside
                    cavity[n_cells] = other
                    n_cells += 1
                    continue
                marks[other] = outside
            border[n_facets] = base + k
            n_facets += 1
    return n_cells, n_facets


@inlined
def _local(seen, vertex, stamp, count):
    """Number of a vertex among those of this star, and how many there are now."""
    if seen[2 * vertex] != stamp:
        seen[2 * vertex] = stamp
        seen[2 * vertex + 1] = count
        count += 1
    return np.int64(seen[2 * vertex + 1]), count


@inlined
def _new_cell(free, state):
    if state[FREE] > 0:
        state[FREE] -= 1
        return np.int64(free[state[FREE]])
    state[USED] += 1
    return state[USED] - 1


@inlined
def _put_cell(vertices, mates, cell, facet, p):
    """Join a point to a border facet: the cell behind the facet, with the point for the vertex opposite."""
    k = facet & 3
    for slot in range(4):
        vertices[4 * cell + slot] = vertices[(facet - k) + slot]
    vertices[4 * cell + k] = p
    outer = np.int64(mates[facet])
    mates[4 * cell + k] = outer
    mates[outer] = 4 * cell + k


@inlined
def build_star(vertices, mates, border, n_facets, p, stamp, seen, table, free, state):
    """Join a point to all facets of its cavity and the new cells to each other.

    The border is a sphere, so it has n / 2 + 2 vertices; two new cells share the facet over each of its edges. Seen
    from one cell the edge runs from a to b, seen from the other back: the pair of vertices finds the mate.
    """
    n_vertices = n_facets // 2 + 2
    hashed = n_vertices > TABLE
    if not hashed:
        table[: n_vertices * n_vertices] = -1
    count, cell = 0, np.int64(0)
    for i in range(n_facets):
        facet = np.int64(border[i])
        cell, k = _new_cell(free, state), facet & 3
        _put_cell(vertices, mates, cell, facet, p)
        border[i] = 4 * cell + k
        if not hashed:
            base = 4 * cell
            a, count = _local(seen, np.int64(vertices[base + (k ^ 1)]), stamp, count)
            b, count = _local(seen, np.int64(vertices[base + (k ^ 2)]), stamp, count)
            c, count = _local(seen, np.int64(vertices[base + (k ^ 3)]), stamp, count)
            link(mates, table, n_vertices, base + (k ^ 1), b, c)
            link(mates, table, n_vertices, base + (k ^ 2), c, a)
            link(mates, table, n_vertices, base + (k ^ 3), a, b)
    if hashed:
        link_by_hash(vertices, mates, border[:n_facets])
    state[LAST] = cell


@compiled_without_arrays
def insert(
    points, order, stop, far, bounds, vertices, mates, marks, cavity, border, free, state, stands_for, seen, table
):
    """Insert the points `order[state[DONE]:stop]`; stops early when an array is too short for the next one."""
    while state[DONE] < stop:
        p = np.int64(order[state[DONE]])
        state[STAMP] += 1
        stamp = state[STAMP]
        cell = locate(points, vertices, mates, state[LAST], p, far, bounds[0])
        same = equal_vertex(points, vertices, cell, p, far)
        if same >= 0:
            stands_for[p] = same
            state[DONE] += 1
            continue
        n_cells, n_facets = find_cavity(points, vertices, mates, marks, cell, p, far, bounds, stamp, cavity, border)
        if n_cells < 0 or state[USED] + n_facets > len(marks) or n_cells + state[FREE] > len(free):
            return
        build_star(vertices, mates, border, n_facets, p, stamp, seen, table, free, state)
        for i in range(n_cells):
            free[state[FREE]] = cavity[i]
            state[FREE] += 1
            vertices[4 * np.int64(cavity[i])] = -1
        state[DONE] += 1
