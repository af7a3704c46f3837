"""Clouds of a few points, every answer found by trying all candidates in exact integer arithmetic."""

from __future__ import annotations

from itertools import combinations, pairwise
from math import factorial

import numpy as np

from answers import Answers, Floats, Ints, Sample, listed, rounded

UNITS_PER_LENGTH = 1000  # coordinates of the small clouds have three decimals: exact as integers


def rectangle8() -> Sample:
    """Rectangle [0, 4] x [0, 2]: its corners and two more points on each long side, along the boundary."""
    height = 2.0
    bottom, top = np.array([0, 1, 2.5, 4]), np.array([0, 1.5, 3, 4])
    points = np.r_[np.c_[bottom, np.zeros(4)], np.c_[top, np.full(4, height)][::-1]]
    centres, radii = strip_circles(bottom, top, height)
    voronoi = {"voronoi_axis": listed(padded(centres)), "voronoi_radii": listed(radii)}
    tree = {"tree_nodes": len(centres), "tree_leaves": 1, "tree_max_depth": len(centres) - 1}
    return padded(points), {**delaunay_answers(points, ring_edges(len(points))), **voronoi, **tree}


def strip_circles(bottom: Floats, top: Floats, height: float) -> tuple[Floats, Floats]:
    """Centres (m, 2) and radii (m,) of the Delaunay circles of points on two parallel lines, from left to right.

    A circle through two neighbours of one line is empty when it meets the other line in that line's point nearest to
    its centre; one such circle per pair of neighbours makes the whole triangulation, a row of triangles.
    """
    circles = []
    for own, other, from_top in ((bottom, top, False), (top, bottom, True)):
        for left, right in pairwise(own):
            x, half = (left + right) / 2, (right - left) / 2
            reach = np.abs(other - x).min()
            y = (height**2 + reach**2 - half**2) / (2 * height)  # half^2 + y^2 = reach^2 + (height - y)^2
            circles.append((x, height - y if from_top else y, np.hypot(half, y)))
    ordered = np.array(sorted(circles))
    return ordered[:, :2], ordered[:, 2]


def polygon(n_corners: int = 9, n_inner: int = 6, seed: int = 11) -> Sample:
    """Vertices of a convex polygon, in order along an ellipse of semi-axes 3 and 2, then points inside it."""
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(n_corners) + 0.4 * rng.random(n_corners)) / n_corners
    inner_angles = 2 * np.pi * (np.arange(n_inner) + rng.random(n_inner)) / n_inner
    scale = np.r_[np.ones(n_corners), 0.75 * np.sqrt(rng.random(n_inner))]
    angles = np.r_[angles, inner_angles]
    points = on_grid(scale[:, None] * np.c_[3 * np.cos(angles), 2 * np.sin(angles)])
    return padded(points), {"n_corners": n_corners, **delaunay_answers(points, ring_edges(n_corners))}


def cloud20(n_points: int = 20, seed: int = 20) -> Sample:
    """Random points in the box [0, 2] x [0, 1.5] x [0, 1]."""
    points = on_grid(np.random.default_rng(seed).random((n_points, 3)) * [2, 1.5, 1])
    hull, _ = extreme_facets(as_integers(points))
    return points, delaunay_answers(points, hull)


def box8() -> Sample:
    """Box of 3 x 2 x 1 by its 8 corners, all on one sphere.

    A tetrahedron of box corners is flat, a sixth of the box, or a third of it (four corners no two of which share an
    edge). Two thirds overlap, so 6 sixths or 4 sixths and a third fill the box.
    """
    sides = np.array([3.0, 2.0, 1.0])
    corners = np.array(list(np.ndindex(2, 2, 2))) * sides
    volume = float(sides.prod())
    return corners, {
        "dimension": 3,
        "volume": volume,
        "area": float(2 * (volume / sides).sum()),
        "n_hull_vertices": 8,
        "circumcentre": listed(sides / 2),
        "circumradius": rounded(np.linalg.norm(sides) / 2),
        "n_simplices_without_flat": [5, 6],
        "tetrahedron_volumes": [0.0, volume / 6, volume / 3],
    }


def delaunay_answers(points: Floats, hull: Ints) -> Answers:
    """Delaunay triangulation of points (n, d) with three decimals and known hull facets (h, d), all of it counted."""
    whole = as_integers(points)
    dim = whole.shape[1]
    simplices = delaunay_simplices(whole)
    check_triangulation(len(whole), simplices, hull)
    corners = whole[simplices]
    content = np.abs(determinants(corners[:, 1:] - corners[:, :1])).sum() / factorial(dim) / UNITS_PER_LENGTH**dim
    return {
        "dimension": dim,
        {2: "area", 3: "volume"}[dim]: rounded(content),
        "n_simplices": len(simplices),
        "n_edges": len(faces(simplices, 2)[0]),
        "n_hull_facets": len(hull),
        "n_hull_vertices": len(np.unique(hull)),
        "simplices": simplices.tolist(),
        "hull_facets": hull.tolist(),
    }


def delaunay_simplices(points: Ints) -> Ints:
    """Simplices (m, d+1) with no other point on or in their circumscribed ball, by trying all.

    Lifted to the paraboloid, these are the facets of the hull that all other points lie above.
    """
    lifted = np.c_[points, (points**2).sum(axis=1)]
    facets, sides = extreme_facets(lifted)
    upward = -determinants(np.concatenate([points[facets], np.ones_like(facets)[..., None]], axis=2))
    return facets[sides * upward > 0]


def extreme_facets(points: Ints) -> tuple[Ints, Ints]:
    """Facets (f, d) of the convex hull of points (n, d), by trying all, and the sign of the side the others are on.

    The side of a point q is the sign of det(facet - q), exact in integers.
    """
    n_points, dim = points.shape
    candidates = np.array(list(combinations(range(n_points), dim)))
    # (c, 1, d, d) corners - (n, 1, d) points: one matrix for each candidate and point
    sides = np.sign(determinants(points[candidates][:, None] - points[:, None]))  # (c, n), 0 for the facet's own
    balance = sides.sum(axis=1)
    extreme = np.abs(balance) == n_points - dim
    return candidates[extreme], np.sign(balance[extreme])


def determinants(matrices: Ints) -> Ints:
    """Exact determinants (...) of integer matrices (..., d, d), expanded along the first row."""
    size = matrices.shape[-1]
    if size == 1:
        return matrices[..., 0, 0]
    minors = [determinants(np.delete(matrices[..., 1:, :], k, axis=-1)) for k in range(size)]
    return sum((-1) ** k * matrices[..., 0, k] * minor for k, minor in enumerate(minors))


def check_triangulation(n_points: int, simplices: Ints, hull: Ints) -> None:
    """Raise ValueError unless simplices fill the hull: each facet in two or on the hull, Euler's relation, all points.

    Points on a common empty circle or ball leave a hole, since no simplex of theirs is empty.
    """
    dim = simplices.shape[1] - 1
    euler = sum((-1) ** k * len(faces(simplices, k + 1)[0]) for k in range(dim + 1))
    facets, uses = faces(simplices, dim)
    filled = uses.max() <= 2 and np.array_equal(facets[uses == 1], hull)
    if not filled or euler != 1 or len(np.unique(simplices)) != n_points:
        raise ValueError("expected points in general position, got some that no single triangulation fits")


def faces(simplices: Ints, size: int) -> tuple[Ints, Ints]:
    """Distinct faces of `size` points in canonical order, and how many simplices have each."""
    columns = combinations(range(simplices.shape[1]), size)
    return np.unique(np.concatenate([simplices[:, c] for c in columns]), axis=0, return_counts=True)


def ring_edges(n_points: int) -> Ints:
    """Edges of a closed ring of points, each sorted, in canonical order."""
    ids = np.arange(n_points)
    return np.unique(np.sort(np.c_[ids, np.roll(ids, -1)], axis=1), axis=0)


def on_grid(points: Floats) -> Floats:
    """Points rounded to the decimals that their file holds."""
    return np.round(points * UNITS_PER_LENGTH) / UNITS_PER_LENGTH


def as_integers(points: Floats) -> Ints:
    """Points in thousandths."""
    return np.round(points * UNITS_PER_LENGTH).astype(np.int64)


def padded(points: Floats) -> Floats:
    """Points (n, 2) in the plane z = 0."""
    return np.c_[points, np.zeros(len(points))]
