"""From smoothed lines to a `Skeleton`: rooted, numbered, measured."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.curve_lines import Lines
from tetraskel.kernels.curve_skeleton import END, JUNCTION, REGULAR, Skeleton, line_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def assemble(lines: Lines, component: Ints, root_points: Ints, radius: Floats) -> tuple[Skeleton, Ints]:
    """Root and number the lines and compute every array of the skeleton but the map from the input points.

    Parameters
    ----------
    lines : Lines
    component : (p,) int
        Of each point.
    root_points : (c,) int
        Point at which each component is rooted.
    radius : (p,) float

    Returns
    -------
    skeleton : Skeleton
    new_number : (p,) int
        Of each point of `lines` in the skeleton.
    """
    walk = walk_from(root_points, line_edges(lines.offsets, lines.connectivity), len(lines.positions))
    rows = _ordered_rows(lines, walk.depth, component)
    new_number = _numbering(rows, root_points, len(lines.positions))
    old = np.empty(len(new_number), np.int64)
    old[new_number] = np.arange(len(old))
    parent = np.where(walk.parent[old] >= 0, new_number[walk.parent[old]], -1)
    rows = [new_number[row] for row in rows]
    offsets = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    connectivity = np.concatenate([np.empty(0, np.int64), *rows])
    sequence = new_number[walk.sequence]
    shape = Shape(lines.positions[old], radius[old], offsets, connectivity, parent, sequence)
    arrays = {**_of_points(shape, walk.depth[old]), **_of_branches(shape)}
    blanking = arrays["blanking"]
    arrays["branch_strahler"] = np.array([arrays["strahler_order"][row[1:]].min() for row in rows], dtype=np.int64)
    arrays["branch_blanking"] = np.array([int(blanking[row].all()) for row in rows], dtype=np.int64)
    arrays["branch_group"] = np.arange(len(rows))
    return (
        Skeleton(shape.points, shape.radius, offsets, connectivity, parent, component=component[old], **arrays),
        new_number,
    )


class Shape:
    """What the arrays are computed from; see `Skeleton`. `sequence` has every parent before its sons."""

    def __init__(
        self, points: Floats, radius: Floats, offsets: Ints, connectivity: Ints, parent: Ints, sequence: Ints
    ) -> None:
        self.points, self.radius, self.parent, self.sequence = points, radius, parent, sequence
        self.offsets, self.connectivity = offsets, connectivity
        self.edges = line_edges(offsets, connectivity)

    @property
    def rows(self) -> list[Ints]:
        """Points of each branch."""
        return np.split(self.connectivity, self.offsets[1:-1]) if len(self.offsets) > 1 else []


class Walk:
    """A breadth-first walk over points: parents, depths, and the order of the visits."""

    def __init__(self, parent: Ints, depth: Ints, sequence: Ints) -> None:
        self.parent, self.depth, self.sequence = parent, depth, sequence


def walk_from(roots: Ints, edges: Ints, n_points: int) -> Walk:
    """Breadth-first from all roots at once; neighbours in ascending order."""
    around: list[list[int]] = [[] for _ in range(n_points)]
    for a, b in edges.tolist():
        around[a].append(b)
        around[b].append(a)
    parent, depth = [-1] * n_points, [-1] * n_points
    sequence = [int(root) for root in roots]
    for root in sequence:
        depth[root] = 0
    for point in sequence:  # grows while it is walked
        for other in sorted(around[point]):
            if depth[other] < 0:
                parent[other], depth[other] = point, depth[point] + 1
                sequence.append(other)
    return Walk(np.array(parent, np.int64), np.array(depth, np.int64), np.array(sequence, np.int64))


def _ordered_rows(lines: Lines, depth: Ints, component: Ints) -> list[Ints]:
    """Branches turned away from the root, by component, then by the depth at which they begin."""
    rows = []
    for start, stop in zip(lines.offsets[:-1], lines.offsets[1:], strict=True):
        row = lines.connectivity[start:stop]
        rows.append(row[::-1] if depth[row[-1]] < depth[row[0]] else row)
    keys = [(int(component[row[0]]), int(depth[row[0]]), i) for i, row in enumerate(rows)]
    return [rows[i] for _, _, i in sorted(keys)]


def _numbering(rows: list[Ints], roots: Ints, n_points: int) -> Ints:
    visited = np.concatenate([roots, *rows])
    _, first = np.unique(visited, return_index=True)
    order = visited[np.sort(first)]
    number = np.full(n_points, -1, np.int64)
    number[order] = np.arange(len(order))
    return number


def _of_points(shape: Shape, depth: Ints) -> dict[str, Any]:
    n = len(shape.points)
    degree = np.bincount(shape.edges.ravel(), minlength=n)
    node_type = np.where(degree > 2, JUNCTION, np.where(degree < 2, END, REGULAR))
    return {
        "depth": depth,
        "abscissa": _abscissas(shape),
        "branch_id": _branch_ids(shape),
        "node_degree": degree,
        "node_type": node_type,
        "strahler_order": _strahler(shape),
        "blanking": _inside_junctions(shape.points, shape.radius, node_type == JUNCTION),
    }


def _abscissas(shape: Shape) -> Floats:
    sons = shape.parent >= 0
    step = np.zeros(len(shape.points))
    step[sons] = np.sqrt(((shape.points[sons] - shape.points[shape.parent[sons]]) ** 2).sum(axis=1))
    length = np.zeros(len(step))
    for point in shape.sequence.tolist():
        if shape.parent[point] >= 0:
            length[point] = length[shape.parent[point]] + step[point]
    return length


def _branch_ids(shape: Shape) -> Ints:
    """Branches later in the order leave a shared point to the one that was there first."""
    branch = np.full(len(shape.points), -1, np.int64)
    for number in range(len(shape.offsets) - 2, -1, -1):
        branch[shape.connectivity[shape.offsets[number] : shape.offsets[number + 1]]] = number
    return branch


def _strahler(shape: Shape) -> Ints:
    order, ties = np.ones(len(shape.points), np.int64), np.zeros(len(shape.points), np.int64)
    for point in shape.sequence[::-1].tolist():
        if ties[point] > 1:
            order[point] += 1
        above = shape.parent[point]
        if above < 0:
            continue
        if ties[above] == 0 or order[point] > order[above]:
            order[above], ties[above] = order[point], 1
        elif order[point] == order[above]:
            ties[above] += 1
    return order


def _inside_junctions(points: Floats, radius: Floats, junction: NDArray[np.bool_]) -> Ints:
    blanked = np.zeros(len(points), np.int64)
    for node in np.flatnonzero(junction):
        blanked[((points - points[node]) ** 2).sum(axis=1) <= radius[node] ** 2] = 1
    return blanked


def _of_branches(shape: Shape) -> dict[str, Any]:
    lengths, chords, means = [], [], []
    for row in shape.rows:
        step = np.sqrt((np.diff(shape.points[row], axis=0) ** 2).sum(axis=1))
        middle = 0.5 * (shape.radius[row[1:]] + shape.radius[row[:-1]])
        lengths.append(step.sum())
        chords.append(np.sqrt(((shape.points[row[-1]] - shape.points[row[0]]) ** 2).sum()))
        means.append((step * middle).sum() / step.sum() if step.sum() > 0 else middle.mean())
    length, chord = np.array(lengths, dtype=float), np.array(chords, dtype=float)
    tortuosity = np.full(len(length), np.inf)
    np.divide(length, chord, out=tortuosity, where=chord > 0)
    return {"branch_length": length, "branch_tortuosity": tortuosity - 1, "branch_radius": np.array(means, dtype=float)}
