"""Fewer points of a surface, as dense as the curve skeleton needs them: many where it is thin, few where it is wide.

The points lie in the leaves of an octree, and of each leaf the one nearest to its middle is kept. A leaf is divided
while it is wide beside the distance of its point to the medial axis, of inside or outside, as the poles of the points
kept so far tell it. That is a function of the points alone, in whatever order, on however many machines: what must be
known of all points at once is the kept ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.octree import DEEPEST, Octree
from tetraskel.kernels.points import bad_coordinates, count_bad, finite_points
from tetraskel.kernels.poles import pole_distances
from tetraskel.kernels.triangulate import triangulate
from tetraskel.options import ThinningOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

PIECE = 1 << 18  # points looked at together
ALL_BELOW = 0.25  # every leaf is divided while no more than this share of the points that may be kept comes of it
LEAST_GAIN = 0.02  # of the points kept: for fewer more another look is not worth while
LEFT = 0.6  # share of the work that is left after each look, for the progress only
N_BITS = np.array([bin(mask).count("1") for mask in range(256)])


@dataclass(frozen=True)
class Sample:
    """One point of each leaf.

    Attributes
    ----------
    leaf : (k,) int
        Ascending.
    points : (k, d) float
    ids : (k,) int
        Which of the input each is; of equal ones the first.
    counts : (k,) int
        Points in the leaf.
    octants : (k,) int
        Bit o is set when there are points in octant o of the leaf.
    """

    leaf: Ints
    points: Floats
    ids: Ints
    counts: Ints
    octants: Ints

    def __len__(self) -> int:
        return len(self.leaf)


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
        Kept points whose leaf is wider than asked, because no more points may be kept, or hardly any would be gained.
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
        For options out of bounds, points that are not finite, or all on one line.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> ways = rng.normal(size=(20_000, 3))
    >>> sphere = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    >>> len(thinned(sphere, most_points=2000, samples_per_radius=6))
    866
    """
    options = ThinningOptions(most_points=most_points, samples_per_radius=samples_per_radius)
    given = checked(points)
    if len(given) <= most_points:
        return Thinned(np.arange(len(given)), np.zeros(len(given)), 0)
    ids = np.arange(len(given))
    return divided_enough(
        octree_around(*box_of(given), most_points),
        lambda octree, told: sample_of_all(given, ids, octree, told),
        lambda sample, octree, told: leaves_to_divide(sample, octree, options, told),
        tick,
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
            spacing = np.where(sample.counts > 1, octree.sides(sample.leaf), 0.0)
            return Thinned(sample.ids[order], spacing[order], n_coarse)
        octree = octree.with_divided(leaves)


def checked(points: ArrayLike) -> NDArray:
    """The points, not copied where they are an array of numbers.

    Raises
    ------
    InputError
        As `finite_points` does.
    """
    given = points if isinstance(points, np.ndarray) and not np.ma.is_masked(points) else finite_points(points)
    finite_points(given[:0])  # of another shape or type
    if given.ndim != 2:
        return finite_points(given)
    bad = sum(count_bad(np.asarray(given[k : k + PIECE], float)) for k in range(0, len(given), PIECE))
    if bad:
        raise InputError(bad_coordinates(bad, len(given)))
    return given


def box_of(points: NDArray) -> tuple[Floats, Floats]:
    """Smallest and largest coordinates of (n, d) points; infinite ones, the wrong way round, without points."""
    low, high = np.full(points.shape[1], np.inf), np.full(points.shape[1], -np.inf)
    for start in range(0, len(points), PIECE):
        piece = np.asarray(points[start : start + PIECE], float)
        low, high = np.minimum(low, piece.min(axis=0)), np.maximum(high, piece.max(axis=0))
    return low, high


def octree_around(low: Floats, high: Floats, most_points: int) -> Octree:
    """A first octree around a box: never more leaves than points may be kept."""
    base = 0
    while 1 << (len(low) * (base + 1)) <= most_points:
        base += 1
    return Octree(low, float((high - low).max()) or 1.0, base)


def sample_of_all(points: NDArray, ids: Ints, octree: Octree, tick: Tick = silent) -> Sample:
    """One point of each leaf, from (n, d) points that are read a piece at a time."""
    sample = no_sample(octree.dim)
    for start in range(0, len(points), PIECE):
        tick(start / len(points))
        piece = slice(start, start + PIECE)
        sample = joined([sample, _sample_of(np.asarray(points[piece], float), ids[piece], octree)], octree)
    return sample


def no_sample(dim: int) -> Sample:
    """That of no points."""
    none = np.empty(0, np.int64)
    return Sample(none, np.empty((0, dim)), none, none, none)


def joined(samples: Sequence[Sample], octree: Octree) -> Sample:
    """One point of each leaf, from those of parts of the points."""
    columns = (np.concatenate([getattr(one, field.name) for one in samples]) for field in fields(Sample))
    leaf, points, ids, counts, octants = columns
    return _best(leaf, points, ids, counts, octants, octree.leaves(points)[2])


def _sample_of(points: Floats, ids: Ints, octree: Octree) -> Sample:
    points = points + 0.0  # -0.0 and 0.0 are one place
    leaf, octant, away = octree.leaves(points)
    return _best(leaf, points, ids, np.ones(len(points), np.int64), np.left_shift(1, octant), away)


def _best(leaf: Ints, points: Floats, ids: Ints, counts: Ints, octants: Ints, away: Floats) -> Sample:
    """Of each leaf the point least `away`; ties go to the smaller coordinates, then to the smaller id."""
    if len(leaf) == 0:
        return Sample(leaf, points, ids, counts, octants)
    order = np.argsort(leaf, kind="stable")
    ranked = leaf[order]
    begins = np.flatnonzero(np.concatenate([[True], ranked[1:] != ranked[:-1]]))
    sizes = np.diff(np.append(begins, len(leaf)))
    nearest = np.repeat(np.minimum.reduceat(away[order], begins), sizes)
    rows = order[away[order] == nearest]
    rows = rows[np.lexsort([ids[rows], *points[rows].T[::-1], leaf[rows]])]
    rows = rows[np.concatenate([[True], leaf[rows[1:]] != leaf[rows[:-1]]])]
    counted, masked = np.add.reduceat(counts[order], begins), np.bitwise_or.reduceat(octants[order], begins)
    return Sample(leaf[rows], points[rows], ids[rows], counted, masked)


def leaves_to_divide(sample: Sample, octree: Octree, options: ThinningOptions, tick: Tick = silent) -> tuple[Ints, int]:
    """Leaves to divide next, and, where there are none, how many are wider than asked.

    Wide leaves come first, so that all parts of the object are equally fine when no more points may be kept; of leaves
    of one level those come first that are widest beside their distance to the medial axis.
    """
    sons, level = N_BITS[sample.octants], octree.levels(sample.leaf)
    can = (sample.counts > 1) & (level < DEEPEST)
    if not can.any() or len(sample) + int((sons[can] - 1).sum()) <= ALL_BELOW * options.most_points:
        return sample.leaf[can], 0
    mesh = triangulate(sample.points, tick=part(tick, 0.0, 0.7))
    stands_for = mesh.point_map if len(mesh.point_map) else np.arange(len(sample))
    share = pole_distances(mesh, part(tick, 0.7, 1.0))[stands_for] / octree.sides(sample.leaf)
    wanted = np.flatnonzero(can & (share < options.samples_per_radius))
    wanted = wanted[np.lexsort([sample.leaf[wanted], share[wanted], level[wanted]])]
    gain = np.cumsum(sons[wanted] - 1)
    n_chosen = int(np.searchsorted(gain, options.most_points - len(sample), "right"))
    if n_chosen == 0 or gain[n_chosen - 1] < LEAST_GAIN * len(sample):
        return wanted[:0], len(wanted)
    return np.sort(sample.leaf[wanted[:n_chosen]]), len(wanted)
