"""Fewer points of a surface, as dense as the curve skeleton needs them: many where it is thin, few where it is wide.

The points lie in the leaves of an octree, and of each leaf the one nearest to its middle is kept. A leaf is divided
while it is wide beside the distance of its point to the medial axis, of inside or outside, as the poles of the points
kept so far tell it, or while its points are no flat piece of a surface. That is a function of the points alone, in
whatever order, on however many machines: what must be known of all points at once is the kept ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.leaf_samples import Sample, is_thick, sample_of_all
from tetraskel.kernels.octree import DEEPEST, Octree
from tetraskel.kernels.points import checked_box, finite_points
from tetraskel.kernels.poles import pole_distances
from tetraskel.kernels.triangulate import triangulate
from tetraskel.options import ThinningOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ALL_BELOW = 0.25  # every leaf is divided while no more than this share of the points that may be kept comes of it
LEAST_GAIN = 0.02  # of the points kept: fewer more are worth another look only where many points wait for it
WAITING = 0.001  # of all points
LEFT = 0.6  # share of the work that is left after each look, for the progress only
CHECKED = 0.1  # share of the work when all points have been looked at once, for the progress only
N_BITS = np.array([bin(mask).count("1") for mask in range(256)])


@dataclass(frozen=True)
class Thinned:
    """What is left of a cloud.

    Attributes
    ----------
    ids : (k,) int
        Input ids of the points that are kept, ascending.
    spacing : (k,) float
        Side of the leaf of each, 0 where no other point is in it. Every input point is within this times the square
        root of the dimension of a kept one.
    n_coarse : int
        Kept points whose leaf is wider than asked, because no more points may be kept or hardly any would be gained.
    """

    ids: Ints
    spacing: Floats
    n_coarse: int

    def __len__(self) -> int:
        return len(self.ids)


def thinned(
    points: ArrayLike,
    *,
    most_points: int = ThinningOptions.most_points,
    samples_per_radius: float = ThinningOptions.samples_per_radius,
    tick: Tick = silent,
) -> Thinned:
    """Which points of a surface to keep.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array
        May be a mapping of a file; it is read a piece at a time, some ten times.
    most_points, samples_per_radius
        See `ThinningOptions`.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        For options out of bounds, points that are not finite, or nearly all in one place beside some far away.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> ways = rng.normal(size=(20_000, 3))
    >>> sphere = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    >>> len(thinned(sphere, most_points=2000, samples_per_radius=6))
    866
    """
    options = ThinningOptions(most_points=most_points, samples_per_radius=samples_per_radius)
    given, low, high = checked(points, part(tick, 0.0, CHECKED))
    if len(given) <= most_points:
        tick(1.0)
        return Thinned(np.arange(len(given)), np.zeros(len(given)), 0)
    return divided_enough(
        octree_around(low, high, most_points),
        lambda octree, told: sample_of_all(given, 0, octree, told),
        lambda sample, octree, told: leaves_to_divide(sample, octree, options, told),
        part(tick, CHECKED, 1.0),
    )


def divided_enough(
    octree: Octree,
    sampled: Callable[[Octree, Tick], Sample],
    to_divide: Callable[[Sample, Octree, Tick], tuple[Ints, int]],
    tick: Tick,
) -> Thinned:
    """Divide leaves until none is left to divide, and take what is sampled then.

    Parameters
    ----------
    sampled : callable
        Gives one point of each leaf of an octree.
    to_divide : callable
        See `leaves_to_divide`.
    """
    left = 1.0
    while True:
        look = part(tick, 1 - left, 1 - left * LEFT)
        sample = sampled(octree, part(look, 0.0, 0.5))
        leaves, n_coarse = to_divide(sample, octree, part(look, 0.5, 1.0))
        left *= LEFT
        if len(leaves) == 0:
            order = np.argsort(sample.ids)
            spacing = np.where(sample.differ, octree.sides(sample.leaf), 0.0)
            tick(1.0)
            return Thinned(sample.ids[order], spacing[order], n_coarse)
        octree = octree.with_divided(leaves)


def checked(points: ArrayLike, tick: Tick = silent) -> tuple[NDArray, Floats, Floats]:
    """The points, not copied where they are an array of numbers, and their smallest and largest coordinates.

    Raises
    ------
    InputError
        As `finite_points` does.
    """
    given = points if isinstance(points, np.ndarray) and not np.ma.is_masked(points) else finite_points(points)
    if given.ndim != 2 or given.shape[1] not in (2, 3) or given.dtype.kind not in "fiub":
        given = finite_points(given)
    return given, *checked_box(given, tick)


def octree_around(low: Floats, high: Floats, most_points: int) -> Octree:
    """A first octree around a box: never more leaves than points may be kept."""
    base = 0
    while 1 << (len(low) * (base + 1)) <= most_points:
        base += 1
    return Octree(low, float((high - low).max()) or 1.0, base)


def leaves_to_divide(sample: Sample, octree: Octree, options: ThinningOptions, tick: Tick = silent) -> tuple[Ints, int]:
    """Leaves to divide next, and, where there are none, how many are wider than asked.

    Wide leaves come first, so that all parts of the object are equally fine when no more points may be kept; of leaves
    of one level those come first that are widest beside their distance to the medial axis.
    """
    sons, level = N_BITS[sample.octants], octree.levels(sample.leaf)
    can = sample.differ & (level < DEEPEST)
    few = len(sample) + int((sons[can] - 1).sum()) <= ALL_BELOW * options.most_points
    if not sample.differ.any() or (few and can.any()):
        return sample.leaf[can], 0
    share = _pole_shares(sample, octree, tick)
    share[is_thick(sample)] = 0
    coarse = share < options.samples_per_radius
    _expect_parts(sample, coarse & ~can)
    wanted = np.flatnonzero(coarse & can)
    wanted = wanted[np.lexsort([sample.leaf[wanted], share[wanted], level[wanted]])]
    gain = np.cumsum(sons[wanted] - 1)
    n_chosen = int(np.searchsorted(gain, options.most_points - len(sample), "right"))
    if n_chosen == 0 or _is_done(sample, gain[n_chosen - 1], wanted, options.most_points):
        return wanted[:0], len(wanted)
    return np.sort(sample.leaf[wanted[:n_chosen]]), len(wanted)


def _is_done(sample: Sample, gain: int, wanted: Ints, most_points: int) -> bool:
    """Whether another look is not worth while: little comes of it, and few wait for it or no more may be kept."""
    little = LEAST_GAIN * len(sample)
    waiting = int(sample.counts[wanted].sum())
    return bool(gain < little and (len(sample) + little > most_points or waiting < WAITING * sample.counts.sum()))


def _expect_parts(sample: Sample, coarse: Bools) -> None:
    """Raise `InputError` when most points lie in leaves that are wider than asked and cannot be divided."""
    n, n_points = int(sample.counts[coarse & sample.differ].sum()), int(sample.counts.sum())
    if 2 * n > n_points:
        raise InputError(
            f"expected points all over their box, got {n} of {n_points} points within some millionths of it; remove "
            "those that are far away first."
        )


def _pole_shares(sample: Sample, octree: Octree, tick: Tick) -> Floats:
    """(k,) distance to the nearer pole in sides of the leaf; 0 everywhere when the points kept so far have none."""
    try:
        mesh = triangulate(sample.points, tick=part(tick, 0.0, 0.7))
    except InputError:  # too few, or all on one line so far
        return np.zeros(len(sample))
    stands_for = mesh.point_map if len(mesh.point_map) else np.arange(len(sample))
    return np.asarray(pole_distances(mesh, part(tick, 0.7, 1.0))[stands_for] / octree.sides(sample.leaf))
