"""Insertion of points into a Delaunay triangulation of the plane.

As in `tetrahedra`: edge k of triangle c, opposite its vertex k, has the number 3 c + k; its mate is the same edge seen
from the other side. Behind every hull edge is a triangle with the vertex at infinity. Vertices run counter-clockwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.compilation import compiled_without_arrays, inlined
from tetraskel.kernels.exact.predicates import in_circle, orient2
from tetraskel.kernels.exact.state import DONE, FREE, LAST, STAMP, USED


def scratch(n_points: int) -> tuple[NDArray[np.int32], ...]:
    """Arrays that `insert` uses: when and where each vertex was met last."""
    return (np.zeros(2 * n_points + 2, np.int32),)


@inlined
def after(k):
    """The next slot of a triangle."""
    return k + 1 if k < 2 else 0


@inlined
def _side(points, a, b, c, bound):
    """Orientation of three finite vertices."""
    a, b, c = 2 * np.int64(a), 2 * np.int64(b), 2 * np.int64(c)
    return orient2(points[a], points[a + 1], points[b], points[b + 1], points[c], points[c + 1], bound)


@inlined
def infinite_slot(vertices, cell, far):
    """Slot of the vertex at infinity, or -1."""
    for k in range(3):
        if vertices[3 * cell + k] == far:
            return k
    return -1


@inlined
def in_conflict(points, vertices, mates, cell, p, far, bounds):
    """Whether a point forbids a triangle; see `tetrahedra.in_conflict`."""
    k = infinite_slot(vertices, cell, far)
    if k >= 0:
        j = after(k)
        side = _side(points, p, vertices[3 * cell + j], vertices[3 * cell + after(j)], bounds[0])
        if side != 0:
            return side > 0
        cell = np.int64(mates[3 * cell + k]) // 3
    a, b = 2 * np.int64(vertices[3 * cell]), 2 * np.int64(vertices[3 * cell + 1])
    c, p = 2 * np.int64(vertices[3 * cell + 2]), 2 * p
    return in_circle(
        points[a], points[a + 1], points[b], points[b + 1], points[c], points[c + 1], points[p], points[p + 1], bounds
    )


@inlined
def locate(points, vertices, mates, cell, p, far, bound):
    """A triangle that holds a point, or an infinite one whose edge sees it, by a visibility walk."""
    k = infinite_slot(vertices, cell, far)
    if k >= 0:
        cell = np.int64(mates[3 * cell + k]) // 3
    entry = -1
    while True:
        base, crossed = 3 * cell, -1
        for k in range(3):
            j = after(k)
            if k != entry and _side(points, p, vertices[base + j], vertices[base + after(j)], bound) < 0:
                crossed = k
                break
        if crossed < 0:
            return cell
        mate = np.int64(mates[base + crossed])
        cell = mate // 3
        entry = mate - 3 * cell
        if infinite_slot(vertices, cell, far) >= 0:
            return cell


@inlined
def equal_vertex(points, vertices, cell, p, far):
    """The vertex of a cell that lies where a point lies, or -1; of the cells that hold the point every one has it."""
    for k in range(3):
        v = np.int64(vertices[3 * cell + k])
        if v != far and points[2 * v] == points[2 * p] and points[2 * v + 1] == points[2 * p + 1]:
            return v
    return -1


@inlined
def find_cavity(points, vertices, mates, marks, cell, p, far, bounds, stamp, cavity, border):
    """All triangles in conflict with a point, from one of them on; see `tetrahedra.find_cavity`."""
    inside, outside = 2 * stamp, 2 * stamp + 1
    marks[cell] = inside
    cavity[0] = cell
    n_cells, n_edges, done = 1, 0, 0
    while done < n_cells:
        if n_cells + 3 > len(cavity) or n_edges + 3 > len(border):
            return -1, -1
        base = 3 * np.int64(cavity[done])
        done += 1
        for k in range(3):
            other = np.int64(mates[base + k]) // 3
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
            border[n_edges] = base + k
            n_edges += 1
    return n_cells, n_edges


@inlined
def _join(mates, seen, vertex, edge, stamp):
    """Join the two new triangles at a vertex of the border: the first to come waits for the second."""
    if seen[2 * vertex] == stamp:
        other = np.int64(seen[2 * vertex + 1])
        mates[edge] = other
        mates[other] = edge
    else:
        seen[2 * vertex] = stamp
        seen[2 * vertex + 1] = edge


@inlined
def build_star(vertices, mates, border, n_edges, p, stamp, seen, free, state):
    """Join a point to all edges of its cavity and the new triangles to each other."""
    cell = np.int64(0)
    for i in range(n_edges):
        edge = np.int64(border[i])
        k = edge % 3
        if state[FREE] > 0:
            state[FREE] -= 1
            cell = np.int64(free[state[FREE]])
        else:
            cell = state[USED]
            state[USED] += 1
        j = after(k)
        i_after = after(j)
        vertices[3 * cell + k] = p
        vertices[3 * cell + j] = vertices[edge - k + j]
        vertices[3 * cell + i_after] = vertices[edge - k + i_after]
        outer = np.int64(mates[edge])
        mates[3 * cell + k] = outer
        mates[outer] = 3 * cell + k
        _join(mates, seen, np.int64(vertices[3 * cell + j]), 3 * cell + i_after, stamp)
        _join(mates, seen, np.int64(vertices[3 * cell + i_after]), 3 * cell + j, stamp)
    state[LAST] = cell


@compiled_without_arrays
def insert(points, order, stop, far, bounds, vertices, mates, marks, cavity, border, free, state, stands_for, seen):
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
        n_cells, n_edges = find_cavity(points, vertices, mates, marks, cell, p, far, bounds, stamp, cavity, border)
        if n_cells < 0 or state[USED] + n_edges > len(marks) or n_cells + state[FREE] > len(free):
            return
        build_star(vertices, mates, border, n_edges, p, stamp, seen, free, state)
        for i in range(n_cells):
            free[state[FREE]] = cavity[i]
            state[FREE] += 1
            vertices[3 * np.int64(cavity[i])] = -1
        state[DONE] += 1
