"""How good a skeleton is, in numbers, against the true surface of its object."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.ball_graph import BallGraph
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.surface_rays import (
    Surface,
    first_hits,
    inside_surface,
    nearest_on_surface,
    surface_of,
    surface_samples,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

SAMPLES = 2000  # along the skeleton, about
SURFACE_SAMPLES = 20_000
BALL_STEP = 0.1  # distance between balls, in radii


def measure(skeleton: Skeleton, surface: tuple[ArrayLike, ArrayLike], *, tick: Tick = silent) -> dict[str, float]:
    """Judge a curve skeleton.

    Parameters
    ----------
    skeleton : Skeleton
        In space.
    surface : (vertices, triangles)
        (n, 3) coordinates and (t, 3) point ids of the closed surface of the object.
    tick : callable, optional
        Called with the share of the work done.

    Returns
    -------
    dict
        `components`, `loops` (of the drawn graph), `ends`, `junctions`, `branches`, `length`;
        `inside`: share of the length inside the surface;
        `centredness`: mean over the length of 2a/(a+b), a the distance to the nearest surface point and b the
        distance to the surface the other way;
        `reconstruction_mean`, `reconstruction_max`: distance from the surface to the union of the skeleton's balls,
        in percent of the diagonal of the surface's bounding box;
        `short_branches`: share of the length in end branches shorter than the radius where they begin.

    Raises
    ------
    InputError
        For a skeleton without points or not in space, or a surface without triangles.
    """
    vertices, triangles = np.asarray(surface[0], dtype=float), np.asarray(surface[1])
    if len(skeleton) == 0 or skeleton.points.shape[1] != 3:
        raise InputError(f"expected a skeleton in space, got points of shape {skeleton.points.shape}.")
    if triangles.ndim != 2 or triangles.shape[1] != 3 or len(triangles) == 0:
        raise InputError(f"expected triangles of shape (t, 3), got {triangles.shape}.")
    expect_extent(vertices)
    target = surface_of(vertices, triangles)
    diagonal = float(np.sqrt((np.ptp(vertices, axis=0) ** 2).sum()))
    inside, centredness = inside_and_centredness(skeleton, target, part(tick, 0.0, 0.9))
    distance = 100 / diagonal * distances_to_balls(skeleton, surface_samples(target, SURFACE_SAMPLES))
    tick(1.0)
    return {
        **graph_numbers(skeleton),
        "inside": inside,
        "centredness": centredness,
        "reconstruction_mean": float(distance.mean()),
        "reconstruction_max": float(distance.max()),
        "short_branches": short_share(skeleton),
    }


def graph_numbers(skeleton: Skeleton) -> dict[str, float]:
    """Components, loops, ends, junctions and branches of the drawn graph, and its length."""
    edges, n = skeleton.edges, len(skeleton)
    components = count_components(edges, n)
    return {
        "components": components,
        "loops": len(edges) - n + components,
        "ends": int((skeleton.node_degree == 1).sum()),
        "junctions": int((skeleton.node_degree > 2).sum()),
        "branches": skeleton.n_branches,
        "length": float(skeleton.branch_length.sum()),
    }


def count_components(edges: Ints, n: int) -> int:
    """Connected pieces of n points with these edges."""
    label = list(range(n))

    def find(point: int) -> int:
        while label[point] != point:
            label[point] = label[label[point]]
            point = label[point]
        return point

    for a, b in edges.tolist():
        label[find(a)] = find(b)
    return sum(find(point) == point for point in range(n))


def inside_and_centredness(skeleton: Skeleton, surface: Surface, tick: Tick = silent) -> tuple[float, float]:
    """Share of the length inside, and mean centredness of that share."""
    places, weights = samples_along(skeleton, SAMPLES)
    inside = inside_surface(surface, places)
    tick(0.4)
    share = float((weights * inside).sum() / weights.sum())
    if not inside.any():
        return share, 0.0
    places, weights = places[inside], weights[inside]
    away = places - nearest_on_surface(surface, places)
    tick(0.8)
    near = np.sqrt((away**2).sum(axis=1))
    ways = away / np.maximum(near, 1e-300)[:, None]
    far, _ = first_hits(surface, places, ways, 1e-9 * near)
    tick(1.0)
    value = np.where(np.isfinite(far), 2 * near / (near + np.minimum(far, 1e300)), 0.0)
    return share, float((weights * value).sum() / weights.sum())


def samples_along(skeleton: Skeleton | BallGraph, n: int) -> tuple[Floats, Floats]:
    """About n places evenly along the skeleton, and the length each stands for; its points where it has no length."""
    a, b = skeleton.points[skeleton.edges.T]
    long = np.sqrt(((b - a) ** 2).sum(axis=1))
    if long.sum() == 0:
        return skeleton.points, np.ones(len(skeleton))
    pieces = np.maximum(np.ceil(long / long.sum() * n), 1).astype(int)
    edge = np.repeat(np.arange(len(long)), pieces)
    rank = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    share = ((rank + 0.5) / pieces[edge])[:, None]
    return (1 - share) * a[edge] + share * b[edge], long[edge] / pieces[edge]


def distances_to_balls(skeleton: Skeleton, places: Floats) -> Floats:
    """(k,) distance from each place to the union of the balls along the skeleton, 0 inside it."""
    centres, radii = balls_along(skeleton)
    nearest = np.full(len(places), np.inf)
    for start in range(0, len(centres), 64):
        some = slice(start, start + 64)
        away = np.sqrt(((places[:, None] - centres[None, some]) ** 2).sum(axis=2)) - radii[some]
        np.minimum(nearest, away.min(axis=1), out=nearest)
    return np.maximum(nearest, 0)


def balls_along(skeleton: Skeleton | BallGraph) -> tuple[Floats, Floats]:
    """Centres and radii of the balls of the points and, interpolated, between them."""
    points, radius = skeleton.points, skeleton.radius
    first, second = skeleton.edges.T
    a, b = points[first], points[second]
    smaller = np.maximum(np.minimum(radius[first], radius[second]), 1e-300)
    pieces = np.minimum(np.ceil(np.sqrt(((b - a) ** 2).sum(axis=1)) / (BALL_STEP * smaller)), 20).astype(int)
    edge = np.repeat(np.arange(len(first)), pieces)
    share = (np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[edge]
    between = (1 - share)[:, None] * a[edge] + share[:, None] * b[edge]
    radii = (1 - share) * radius[first[edge]] + share * radius[second[edge]]
    return np.concatenate([points, between]), np.concatenate([radius, radii])


def short_share(skeleton: Skeleton) -> float:
    """Share of the length in end branches shorter than the radius where they begin."""
    short = 0.0
    for number in range(skeleton.n_branches):
        row = skeleton.branch(number)
        degrees = skeleton.node_degree[[row[0], row[-1]]]
        inner = row[0] if degrees[0] > 2 else row[-1]
        if degrees.min() == 1 and degrees.max() > 2 and skeleton.branch_length[number] < skeleton.radius[inner]:
            short += float(skeleton.branch_length[number])
    total = float(skeleton.branch_length.sum())
    return short / total if total > 0 else 0.0
