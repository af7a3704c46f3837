"""Noisy points back onto the surface they were taken from; points without noise are left as they are.

A surface is locally a quadratic height over its tangent plane. What is left of the nearest points after the best
such fit is noise: nothing on a smooth surface, the same at every scale under noise. A noisy point is moved onto the
fit of its surroundings (moving least squares; Levin 1998; Alexa et al. 2003), and of points closer to one another
than the noise one is kept: between points that scatter, triangulations find rooms and passages that are not there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.kernels.chunks import Tick, for_chunks, part, silent
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.points import finite_points, morton_order

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAMPLES = 500  # places where the noise is estimated
FEWEST = 12  # nearest points of the smallest fit
# Share of the fit's extent that is left on average after it: below the first by bends alone (random points and the
# vertices of meshes of smooth shapes 0.01 to 0.02, noise of half a spacing 0.2), below the second a surface is
# recognised, above the third the points fill a volume at every scale.
CLEAN, RECOGNISED, NO_SURFACE = 0.04, 0.2, 0.23
REACH = 8.0  # a point is fitted to those within this many standard deviations of the noise
MOST = 256  # and to no more than these
APART = 1.5  # standard deviations between the points that are kept
AGAIN, ROUNDS = 100, 3  # nearest points of the fits that follow among those kept, and how often
BENT = 1.2  # what is left grows by more than this in fits to twice the points where bends make it; noise does not grow
LEAST_POINTS = 100  # fewer say nothing about noise
MOST_CELLS = 1e18  # of a grid whose cells have numbers; an outlier far away asks for more
RIDGE = 1e-9  # of the trace: keeps the fit of points on one line solvable


@dataclass(frozen=True)
class Denoised:
    """Points on the surface.

    Attributes
    ----------
    points : (k, d) float
        In the order of `ids`.
    ids : (k,) int
        Point of the cloud that each was, ascending.
    stands_for : (n,) int
        Row in `points` nearest to each point of the cloud.
    noise : float
        Standard deviation across the surface, in the unit of the points; 0 when nothing was moved.
    """

    points: Floats
    ids: Ints
    stands_for: Ints
    noise: float


def denoised(points: ArrayLike, tick: Tick = silent) -> Denoised:
    """Points of a surface without their noise.

    Parameters
    ----------
    points : (n, d) array, d = 2 or 3
        Any unit.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    Denoised
        All points as they are when they show no noise. Does not depend on the order of the points, ids aside.

    Raises
    ------
    InputError
        For points that are not finite, or not points.
    EngineError
        When SciPy is missing.

    Examples
    --------
    >>> import numpy as np
    >>> rng = np.random.default_rng(0)
    >>> angles = rng.uniform(0, 2 * np.pi, 1000)
    >>> circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    >>> denoised(circle).noise
    0.0
    >>> round(denoised(circle + rng.normal(0, 0.02, circle.shape)).noise, 2)
    0.02
    """
    points = finite_points(points)
    order = morton_order(points)
    ranked = points[order]
    cloud = Cloud(ranked)
    noise = estimated_noise(cloud)
    if noise == 0:
        everything = np.arange(len(points))
        return Denoised(points, everything, everything, 0.0)
    kept = _apart(ranked, APART * noise)
    moved = _onto_fits(ranked, ranked[kept], noise, part(tick, 0.0, 0.6))
    for round_ in range(ROUNDS):
        share = part(tick, 0.6 + 0.4 * round_ / ROUNDS, 0.6 + 0.4 * (round_ + 1) / ROUNDS)
        moved = _refitted(Cloud(moved), moved, AGAIN, np.inf, share)
    ids = order[kept]
    rows = np.argsort(ids)
    return Denoised(moved[rows], ids[rows], np.asarray(Cloud(moved[rows]).query(points)[1]), noise)


def estimated_noise(cloud: Cloud) -> float:
    """Standard deviation of a cloud across the surface it was taken from; 0 where it is not told from bends.

    The fits grow until the noise is small against their extent; the residuals' median over many places is the answer.
    """
    if cloud.n < LEAST_POINTS:
        return 0.0
    places = cloud.points[_evenly(cloud.n, SAMPLES)]
    share, left = _left_after_fits(cloud, places, FEWEST)
    if share < CLEAN or _left_after_fits(cloud, places, 2 * FEWEST)[0] > BENT * share:
        return 0.0
    best, k = (share, left), FEWEST
    while share >= RECOGNISED and 8 * k < cloud.n and k < 8 * MOST:
        k *= 2
        share, left = _left_after_fits(cloud, places, k)
        best = min(best, (share, left))
    return best[1] if best[0] < NO_SURFACE else 0.0


def lies_on_surface(points: Floats) -> bool:
    """Whether (n, d) points lie on a surface (3D) or a curve (2D), with or without noise; False for few points."""
    places = places_to_look_at(len(points))
    if len(places) == 0:
        return False
    cloud = Cloud(points[morton_order(points)])
    return _left_after_fits(cloud, cloud.points[places], FEWEST)[0] < NO_SURFACE


def places_to_look_at(n: int) -> Ints:
    """Where `lies_on_surface` looks among n points in the order of the Morton curve; nowhere for few points."""
    return _evenly(n, SAMPLES if n >= 4 * FEWEST else 0)


def is_surface_around(places: Floats, away: Floats, around: Floats) -> bool:
    """What `lies_on_surface` says of (m, d) places, from their nearest points (m, FEWEST, d) and how far these are."""
    return _left(places, away, around)[0] < NO_SURFACE


def _evenly(n: int, some: int) -> Ints:
    """At most `some` of n indices, evenly apart."""
    return np.linspace(0, n - 1, min(some, n)).astype(np.int64)


def _left_after_fits(cloud: Cloud, places: Floats, k: int) -> tuple[float, float]:
    """Median residual of the fits to the k nearest points, in their extents and in the unit of the points."""
    away, near = cloud.query(places, k)
    return _left(places, away, cloud.points[near])


def _left(places: Floats, away: Floats, around: Floats) -> tuple[float, float]:
    """`_left_after_fits` to points (m, k, d) around the places, and their distances (m, k)."""
    spread = away[:, -1] > 0  # else all in one place: nothing to fit
    if not spread.any():
        return 0.0, 0.0
    away, around, places = away[spread], around[spread], places[spread]
    left = _fit(around, np.ones(away.shape), places, away[:, -1]).residual
    return float(np.median(left / away[:, -1])), float(np.median(left))


def _apart(ranked: Floats, distance: float) -> Ints:
    """The first point in each cell of a grid of this width, ascending."""
    cells = np.floor((ranked - ranked.min(axis=0)) / distance)
    if np.prod(cells.max(axis=0) + 1) > MOST_CELLS:
        return np.sort(np.unique(cells, axis=0, return_index=True)[1])
    key = np.zeros(len(ranked), np.int64)
    for column in cells.astype(np.int64).T:
        key = key * (int(column.max()) + 1) + column
    return np.sort(np.unique(key, return_index=True)[1])


def _onto_fits(points: Floats, places: Floats, noise: float, tick: Tick) -> Floats:
    """Places moved onto the fits of the points around them, each of the same extent."""
    cloud = Cloud(points)
    near = cloud.count_within(places[_evenly(len(places), SAMPLES)], REACH * noise)
    k = max(float(np.median(near)), AGAIN)
    if k > MOST:  # fewer points, evenly along the curve, say as much about the surface
        cloud, k = Cloud(points[_evenly(len(points), int(len(points) * MOST / k))]), MOST
    return _refitted(cloud, places, int(k), REACH * noise, tick)


def _refitted(cloud: Cloud, places: Floats, k: int, reach: float, tick: Tick) -> Floats:
    """Places moved onto the fits of their k nearest points, those within `reach` where that leaves enough."""
    k = min(k, cloud.n)
    moved = np.empty_like(places)

    def work(piece: slice) -> None:
        away, near = cloud.query(places[piece], k)
        extent = np.clip(reach, away[:, min(k, FEWEST) - 1], away[:, -1]) * (1 + 1e-3)
        extent[extent == 0] = 1.0  # all in one place: it stays there
        weights = np.maximum(1 - (away / extent[:, None]) ** 2, 0) ** 2
        moved[piece] = _fit(cloud.points[near], weights, places[piece], extent).places

    for_chunks(work, len(places), tick, chunk=2048)
    return moved


@dataclass(frozen=True)
class Fits:
    """Quadratic fits: places moved onto them (m, d), and the standard deviations (m,) of what is left."""

    places: Floats
    residual: Floats


def _fit(around: Floats, weights: Floats, places: Floats, extent: Floats) -> Fits:
    """Quadratic heights over the planes that fit best.

    Least squares in the frame of the weighted covariance's axes, the first of which is the normal. The residual's
    degrees of freedom are those of a weighted linear smoother.

    Parameters
    ----------
    around : (m, k, d) float
    weights : (m, k) float
    places : (m, d) float
    extent : (m,) float
        Length by which heights and positions are divided.
    """
    total = weights.sum(axis=1)
    centre = np.einsum("mk,mka->ma", weights, around) / total[:, None]
    offset = (around - centre[:, None]) / extent[:, None, None]
    weighted = offset * weights[..., None]
    axes = np.linalg.eigh(weighted.swapaxes(1, 2) @ offset)[1]  # (m, d, d), the normal first
    local = offset @ axes
    basis = _quadratics(local[..., 1:])  # (m, k, b)
    weighted = basis * weights[..., None]
    normal = weighted.swapaxes(1, 2) @ basis
    trace = np.trace(normal, axis1=1, axis2=2)
    normal += RIDGE * trace[:, None, None] * np.eye(basis.shape[2])
    right = np.concatenate([weighted.swapaxes(1, 2) @ local[..., :1], weighted.swapaxes(1, 2) @ weighted], axis=2)
    solved = np.linalg.solve(normal, right)
    coefficients = solved[..., :1]
    freedom = np.maximum(total - np.trace(solved[..., 1:], axis1=1, axis2=2), 1e-9)
    left = (weights * (local[..., 0] - (basis @ coefficients)[..., 0]) ** 2).sum(axis=1)
    here = ((places - centre) / extent[:, None])[:, None] @ axes  # (m, 1, d)
    rise = (_quadratics(here[..., 1:]) @ coefficients)[:, 0, 0] - here[:, 0, 0]
    return Fits(places + (rise * extent)[:, None] * axes[..., 0], np.sqrt(left / freedom) * extent)


def _quadratics(local: Floats) -> Floats:
    """(..., b) all products of at most two of the (..., d-1) coordinates: 3 in the plane, 6 in space."""
    n = local.shape[-1]
    terms = [np.ones(local.shape[:-1]), *(local[..., i] for i in range(n))]
    terms += [local[..., i] * local[..., j] for i in range(n) for j in range(i, n)]
    return np.stack(terms, axis=-1)
