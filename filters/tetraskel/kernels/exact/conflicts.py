"""Which points forbid which cells: exact, and quick where boxes around the points say that none can.

A cell is asked about as its four corners and the slot opposite its hull facet, -1 for a finite cell; with a slot the
infinite cell behind that facet is meant. Points are sorted along a curve and boxed in a binary tree: node i holds the
boxes of nodes 2i+1 and 2i+2, leaf j the items `starts[j]` to `starts[j+1]`.

A box is passed over by the *form* of a cell, a lower bound of what has a negative sign in a conflict. With the corners
relative to the first one, divided by their largest coordinate, a point q is in the ball through 0, b, c and d where

    V |q|^2 - w . q < 0,   V = b . (c x d),   w = |b|^2 (c x d) + |c|^2 (d x b) + |d|^2 (b x c),

which is a sum over the axes of parabolas, so that its least value over a box is known. V and w come with bounds of
their roundings (every monomial passes through fewer than 30 roundings, so 32 u times the sum of their sizes is enough;
Higham 2002, section 3.1). There is no division by V: flat cells only pass over fewer boxes.
"""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import compiled_without_arrays, inlined
from tetraskel.kernels.exact.predicates import in_sphere, orient3

SHARE = 32 * 2.0**-53  # of the sum of the monomials' sizes, for their roundings
# a form: corner, scale, V, w and its error, normal of the hull facet and its error, a corner of that; room for a box
CORNER, SCALE, VOLUME, WEIGHT, WEIGHT_ERROR, NORMAL, NORMAL_ERROR, ORIGIN, SPOT, FORM = (
    0,
    3,
    4,
    5,
    8,
    11,
    14,
    17,
    20,
    26,
)
STACK = 128
NEVER = (np.inf, np.inf)  # bounds of the static filters that certify nothing


@inlined
def _cross(form, place, error, ux, uy, uz, vx, vy, vz, factor):
    """Add the cross product of u and v times a positive factor to a form, and the sizes of its monomials."""
    form[place] += factor * (uy * vz - uz * vy)
    form[place + 1] += factor * (uz * vx - ux * vz)
    form[place + 2] += factor * (ux * vy - uy * vx)
    form[error] += factor * (abs(uy * vz) + abs(uz * vy))
    form[error + 1] += factor * (abs(uz * vx) + abs(ux * vz))
    form[error + 2] += factor * (abs(ux * vy) + abs(uy * vx))


@inlined
def _set_form(corners, base, slot, form):
    """Fill the form of a cell."""
    for i in range(FORM):
        form[i] = 0.0
    ax, ay, az = corners[base], corners[base + 1], corners[base + 2]
    bx, by, bz = corners[base + 3] - ax, corners[base + 4] - ay, corners[base + 5] - az
    cx, cy, cz = corners[base + 6] - ax, corners[base + 7] - ay, corners[base + 8] - az
    dx, dy, dz = corners[base + 9] - ax, corners[base + 10] - ay, corners[base + 11] - az
    size = max(max(abs(bx), abs(by), abs(bz)), max(abs(cx), abs(cy), abs(cz)), max(abs(dx), abs(dy), abs(dz)))
    scale = 1.0 / size
    bx, by, bz = bx * scale, by * scale, bz * scale
    cx, cy, cz = cx * scale, cy * scale, cz * scale
    dx, dy, dz = dx * scale, dy * scale, dz * scale
    form[0], form[1], form[2], form[SCALE] = ax, ay, az, scale
    _cross(form, WEIGHT, WEIGHT_ERROR, cx, cy, cz, dx, dy, dz, 1.0)
    volume = bx * form[WEIGHT] + by * form[WEIGHT + 1] + bz * form[WEIGHT + 2]
    sizes = abs(bx) * form[WEIGHT_ERROR] + abs(by) * form[WEIGHT_ERROR + 1] + abs(bz) * form[WEIGHT_ERROR + 2]
    form[VOLUME] = max(volume - SHARE * sizes, 0.0)
    for i in range(WEIGHT, WEIGHT + 6):
        form[i] = 0.0
    _cross(form, WEIGHT, WEIGHT_ERROR, cx, cy, cz, dx, dy, dz, bx * bx + by * by + bz * bz)
    _cross(form, WEIGHT, WEIGHT_ERROR, dx, dy, dz, bx, by, bz, cx * cx + cy * cy + cz * cz)
    _cross(form, WEIGHT, WEIGHT_ERROR, bx, by, bz, cx, cy, cz, dx * dx + dy * dy + dz * dz)
    if slot >= 0:
        x, y, z = base + 3 * (slot ^ 1), base + 3 * (slot ^ 2), base + 3 * (slot ^ 3)
        ox, oy, oz = corners[x], corners[x + 1], corners[x + 2]
        ux, uy, uz = (corners[y] - ox) * scale, (corners[y + 1] - oy) * scale, (corners[y + 2] - oz) * scale
        vx, vy, vz = (corners[z] - ox) * scale, (corners[z + 1] - oy) * scale, (corners[z + 2] - oz) * scale
        form[ORIGIN], form[ORIGIN + 1], form[ORIGIN + 2] = ox, oy, oz
        _cross(form, NORMAL, NORMAL_ERROR, ux, uy, uz, vx, vy, vz, 1.0)


@inlined
def _ball_bound(form, boxes, box):
    """Lower bound over a box (lowest corner, highest corner) of the form of the ball."""
    total = 0.0
    for axis in range(3):
        low = (boxes[box + axis] - form[axis]) * form[SCALE]
        high = (boxes[box + axis + 3] - form[axis]) * form[SCALE]
        volume, weight = form[VOLUME], form[WEIGHT + axis]
        least = min(volume * low * low - weight * low, volume * high * high - weight * high)
        if volume > 0.0:
            bottom = weight / (2.0 * volume)
            if low < bottom < high:
                least = min(least, volume * bottom * bottom - weight * bottom)
        far = max(abs(low), abs(high))
        total += least - SHARE * (form[WEIGHT_ERROR + axis] * far + volume * far * far)
    return total


@inlined
def _plane_bound(form, boxes, box):
    """Minus the upper bound over a box of the height over a hull facet; exactly 0 where an axis decides and it is."""
    total = 0.0
    for axis in range(3):
        low = (boxes[box + axis] - form[ORIGIN + axis]) * form[SCALE]
        high = (boxes[box + axis + 3] - form[ORIGIN + axis]) * form[SCALE]
        normal, error = form[NORMAL + axis], SHARE * form[NORMAL_ERROR + axis]
        total += max(normal * low + error * abs(low), normal * high + error * abs(high))
    return -total


@inlined
def _bound(form, slot, boxes, box):
    """A number that is above 0 only where no point of a box forbids a cell."""
    if slot < 0:
        return _ball_bound(form, boxes, box)
    bound = _plane_bound(form, boxes, box)
    if bound == 0.0:  # at most in the plane of the facet, where the ball of the finite cell decides
        return max(_ball_bound(form, boxes, box), 0.0)
    return bound


@inlined
def _forbids(corners, base, slot, points, p):
    """Whether a point forbids a cell; see `in_conflict` in `tetrahedra`. The cell's own corners do not."""
    px, py, pz = points[3 * p], points[3 * p + 1], points[3 * p + 2]
    for corner in range(base, base + 12, 3):
        if corners[corner] == px and corners[corner + 1] == py and corners[corner + 2] == pz:
            return False
    if slot >= 0:
        x, y, z = base + 3 * (slot ^ 1), base + 3 * (slot ^ 2), base + 3 * (slot ^ 3)
        side = orient3(
            px, py, pz, corners[x], corners[x + 1], corners[x + 2], corners[y], corners[y + 1], corners[y + 2],
            corners[z], corners[z + 1], corners[z + 2], np.inf,
        )  # fmt: skip
        if side != 0:
            return side < 0
    return in_sphere(
        corners[base], corners[base + 1], corners[base + 2], corners[base + 3], corners[base + 4], corners[base + 5],
        corners[base + 6], corners[base + 7], corners[base + 8], corners[base + 9], corners[base + 10],
        corners[base + 11], px, py, pz, NEVER,
    )  # fmt: skip


def scratch() -> tuple[np.ndarray, np.ndarray]:
    """Arrays the functions below use."""
    return np.empty(FORM), np.empty(STACK, np.int64)


@compiled_without_arrays
def labels_in_conflict(corners, slots, boxes, labels, found, form, stack):
    """Set `found[cell, label]` where a box with that label may hold a point that forbids the cell.

    `boxes` (2 k - 1 times 6, flat) is a tree with k leaves, a power of two; leaf j has `labels[j]`.
    """
    first_leaf = len(boxes) // 12
    for cell in range(len(slots)):
        slot = np.int64(slots[cell])
        _set_form(corners, 12 * cell, slot, form)
        stack[0], depth = 0, 1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if boxes[6 * node] > boxes[6 * node + 3] or _bound(form, slot, boxes, 6 * node) > 0.0:
                continue
            if node >= first_leaf:
                found[cell, labels[node - first_leaf]] = True
            else:
                stack[depth], stack[depth + 1] = 2 * node + 1, 2 * node + 2
                depth += 2


@compiled_without_arrays
def deepest_conflicts(corners, slots, boxes, starts, points, answers, form, stack):
    """Set `answers[cell]` to a point that forbids each cell, of these one of the deepest, or to -1."""
    first_leaf = len(boxes) // 12
    for cell in range(len(slots)):
        slot = np.int64(slots[cell])
        _set_form(corners, 12 * cell, slot, form)
        answers[cell], deepest = -1, 0.0
        stack[0], depth = 0, 1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if boxes[6 * node] > boxes[6 * node + 3]:
                continue
            bound = _bound(form, slot, boxes, 6 * node)
            if bound > 0.0 or (answers[cell] >= 0 and bound >= deepest):
                continue
            if node < first_leaf:
                near, far = 2 * node + 1, 2 * node + 2
                if _bound(form, slot, boxes, 6 * far) < _bound(form, slot, boxes, 6 * near):
                    near, far = far, near
                stack[depth], stack[depth + 1] = far, near
                depth += 2
                continue
            for p in range(starts[node - first_leaf], starts[node - first_leaf + 1]):
                for axis in range(3):
                    form[SPOT + axis], form[SPOT + axis + 3] = points[3 * p + axis], points[3 * p + axis]
                bound = _bound(form, slot, form, SPOT)
                if bound > 0.0 or (answers[cell] >= 0 and bound >= deepest):
                    continue
                if _forbids(corners, 12 * cell, slot, points, p):
                    answers[cell], deepest = p, bound


@compiled_without_arrays
def cells_in_boxes(simplices, points, boxes, cells, met, stack):
    """Set `met[i]` where the box around `simplices[cells[i]]` (flat) meets a leaf's box."""
    first_leaf = len(boxes) // 12
    for i in range(len(cells)):
        a, b = 3 * np.int64(simplices[4 * cells[i]]), 3 * np.int64(simplices[4 * cells[i] + 1])
        c, d = 3 * np.int64(simplices[4 * cells[i] + 2]), 3 * np.int64(simplices[4 * cells[i] + 3])
        stack[0], depth = 0, 1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            apart = False
            for axis in range(3):
                e, f, g, h = points[a + axis], points[b + axis], points[c + axis], points[d + axis]
                low, high = boxes[6 * node + axis], boxes[6 * node + axis + 3]
                apart = apart or low > max(max(e, f), max(g, h)) or high < min(min(e, f), min(g, h))
            if apart:
                continue
            if node >= first_leaf:
                met[i] = True
                break
            stack[depth], stack[depth + 1] = 2 * node + 1, 2 * node + 2
            depth += 2
