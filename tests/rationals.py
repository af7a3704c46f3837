"""Delaunay triangulations in exact arithmetic, from the definitions: slow, and nothing to get wrong."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Whole = NDArray[np.object_]


def whole_numbers(points: Floats) -> Whole:
    """Doubles of any size times one common factor, as Python integers."""
    fractions = [[Fraction(float(x)) for x in row] for row in points]
    factor = max(x.denominator for row in fractions for x in row)
    return np.array([[int(x * factor) for x in row] for row in fractions], dtype=object)


def sign(value: Any) -> int:
    return (value > 0) - (value < 0)


def det(rows: list[list[Any]]) -> Any:
    """Determinant by the first row; entries may be numbers or arrays of them."""
    if len(rows) == 1:
        return rows[0][0]
    rest = rows[1:]
    return sum((-1) ** j * rows[0][j] * det([row[:j] + row[j + 1 :] for row in rest]) for j in range(len(rows)))


def orientation(corners: Whole) -> Any:
    """Signed volume (times d!) of the simplex with these (d+1, d) corners; more axes behind are computed at once."""
    return det([list(row) for row in corners[1:] - corners[0]])


def inside(corners: Whole, point: Whole, heights: Any = None) -> Any:
    """Positive inside the sphere of a positively oriented simplex: the determinant of the lifted differences.

    `heights` are the d+2 points' distances above the paraboloid.
    """
    extra = heights if heights is not None else [0] * (len(corners) + 1)
    differences = corners - point
    lifted = [
        [*row, sum(x * x for x in row) + h - extra[-1]] for row, h in zip(list(differences), extra[:-1], strict=True)
    ]
    return det(lifted) * (1 if len(point) == 2 else -1)


def raised(points: Whole) -> list[Fraction]:
    """Heights of the symbolic perturbation as real, tiny ones: the larger point gets very much more."""
    size = max(int(abs(x)) for x in points.ravel()) + 1
    step = Fraction(1, 10**6 * size**8)
    order = sorted(range(len(points)), key=lambda i: tuple(points[i]), reverse=True)
    heights = [Fraction(0)] * len(points)
    for rank, i in enumerate(order):
        heights[i] = step ** (rank + 1)
    return heights


def triangulation_by_definition(points: Floats) -> set[frozenset[int]]:
    """All simplices whose perturbed sphere holds no point."""
    whole = whole_numbers(points)
    heights, dim = raised(whole), points.shape[1]
    found = set()
    for chosen in combinations(range(len(points)), dim + 1):
        ids = list(chosen)
        volume = orientation(whole[ids])
        if volume < 0:
            ids[0], ids[1] = ids[1], ids[0]
        if volume != 0 and all(
            inside(whole[ids], whole[other], [heights[i] for i in (*ids, other)]) < 0
            for other in range(len(points))
            if other not in chosen
        ):
            found.add(frozenset(chosen))
    return found


def assert_delaunay(points: Floats, simplices: Ints, neighbors: Ints) -> None:
    """Positive volumes, empty spheres, mutual neighbours, and the convex hull filled exactly."""
    whole, dim = whole_numbers(points), points.shape[1]
    corners = np.moveaxis(whole[simplices], 0, -1)  # (d+1, d, m)
    volumes = orientation(corners)
    assert (volumes > 0).all()
    columns = corners[:, :, :, None]
    assert (inside(columns, whole.T[:, None, :]) <= 0).all()
    assert set(simplices.ravel().tolist()) == set(range(len(points)))
    hull_volume = 0
    for cell, row in enumerate(neighbors.tolist()):
        for k, other in enumerate(row):
            facet = np.delete(simplices[cell], k)
            if other >= 0:
                assert cell in neighbors[other]
                assert set(facet.tolist()) < set(simplices[other].tolist())
                assert simplices[cell, k] not in simplices[other]
                continue
            outward = facet if (k + dim) % 2 else facet[[1, 0, *range(2, dim)]]
            rows = [list(row) for row in whole[outward]]
            hull_volume += det(rows)
            sides = det([[*(x - y for x, y in zip(whole[v], whole[outward[0]], strict=True))] for v in outward[1:]]
                        + [list((whole - whole[outward[0]]).T)])  # fmt: skip
            assert (sides <= 0).all() or (sides >= 0).all()
    assert abs(hull_volume) == volumes.sum()
