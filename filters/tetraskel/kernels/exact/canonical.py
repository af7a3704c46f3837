"""From the cells as they were made to simplices in an order that only the points decide.

A simplex begins with its smallest vertex, in space followed by the next smallest; orientation settles the rest.
Simplices are sorted by their first three vertices (two in the plane), which no two of them share: a facet seen from one
side belongs to one simplex.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import compiled, inner


@inner
def _turn(vertices, base, width, slots):
    """Order the slots of a cell by an even permutation."""
    least = 0
    for k in range(1, width):
        if vertices[base + k] < vertices[base + least]:
            least = k
    slots[0] = least
    if width == 3:
        slots[1], slots[2] = (least + 1) % 3, (least + 2) % 3
        return
    step = 1
    for other in (2, 3):
        if vertices[base + (least ^ other)] < vertices[base + (least ^ step)]:
            step = other
    # (k, k^1, k^2, k^3) is an even permutation for every k, and stays even when the last three take turns
    slots[1], slots[2], slots[3] = least ^ step, least ^ (step % 3 + 1), least ^ ((step + 1) % 3 + 1)


@inner
def _is_finite(vertices, base, width, far):
    finite = vertices[base] >= 0  # free cells have -1 there
    for k in range(width):
        finite = finite and vertices[base + k] != far
    return finite


@inner
def _sort(keys, cells, start, stop):
    """Sort cells by their keys (Shell 1959, with the gaps of Ciura 2001: the lists are short, save for a few)."""
    gap = 1
    while 2.25 * gap < stop - start:
        gap = int(2.25 * gap) + 1
    while gap > 0:
        for i in range(start + gap, stop):
            key, cell, j = keys[i], cells[i], i
            while j >= start + gap and keys[j - gap] > key:
                keys[j], cells[j] = keys[j - gap], cells[j - gap]
                j -= gap
            keys[j], cells[j] = key, cell
        gap = int(gap / 2.25)


@compiled
def sorted_cells(vertices, n_cells, far, width, new_id):
    """The finite cells in their final order; `new_id` of each cell is its place in it, or -1."""
    first = np.zeros(far + 2, np.int64)
    slots = np.zeros(4, np.int64)
    for cell in range(n_cells):
        base = width * cell
        new_id[cell] = -1
        if _is_finite(vertices, base, width, far):
            least = vertices[base]
            for k in range(1, width):
                least = min(least, vertices[base + k])
            first[least + 2] += 1
    for vertex in range(far):
        first[vertex + 2] += first[vertex + 1]
    keys, cells = np.empty(first[far + 1], np.int64), np.empty(first[far + 1], np.int32)
    for cell in range(n_cells):
        base = width * cell
        if _is_finite(vertices, base, width, far):
            _turn(vertices, base, width, slots)
            least = vertices[base + slots[0]]
            row = first[least + 1]
            first[least + 1] += 1
            keys[row] = (np.int64(vertices[base + slots[1]]) << 32) | np.int64(vertices[base + slots[2]])
            cells[row] = cell
    for vertex in range(far):
        _sort(keys, cells, first[vertex], first[vertex + 1])
    for row in range(len(cells)):
        new_id[cells[row]] = row
    return cells


@compiled
def simplices_and_neighbors(vertices, mates, width, cells, new_id, simplices, neighbors):
    """Fill the vertices and the neighbours (flat) of the cells in their final order, -1 for none."""
    slots = np.zeros(4, np.int64)
    for row in range(len(cells)):
        base = width * np.int64(cells[row])
        _turn(vertices, base, width, slots)
        for k in range(width):
            simplices[width * row + k] = vertices[base + slots[k]]
            mate = np.int64(mates[base + slots[k]])
            neighbors[width * row + k] = new_id[mate >> 2 if width == 4 else mate // 3]
