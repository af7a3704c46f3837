"""A skeleton whose branches are smooth curves: cubic Bezier pieces, with radius, curvature and torsion."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.ball_graph import BallGraph, SkeletonLike, ball_graph, branches_of
from tetraskel.kernels.bezier_fit import Line, fit_line
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.cubic_spline import bezier_at
from tetraskel.kernels.curve_arrays import assemble, walk_from
from tetraskel.kernels.curve_lines import Lines
from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.options import BezierOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

LEAST = 1e-6  # of the skeleton's size: the tolerance where the radius is 0
STANDING = 1e-60  # sizes of the skeleton per piece: below it a curve stands still
STRAIGHT = 1e-9  # curvature times size below which a line is straight and has no torsion


@dataclass(frozen=True)
class BezierSkeleton:
    """Cubic pieces, branch after branch, and the lines sampled from them.

    Along a branch the pieces have tangent and curvature in common (where an edge of the skeleton had to become a piece
    of its own, the tangent); a closed branch without a junction also where it closes.

    Attributes
    ----------
    control : (s, 4, e) float
        Bezier points of the pieces, in the direction of their branch.
    control_radius : (s, 4) float
        The radius as Bezier coefficients.
    branch : (s,) int
        Branch of each piece.
    skeleton : Skeleton
        Sampled, with every array of a curve skeleton.
    curvature : (p,) float
        At the samples, per length. Where branches meet it is that of the branch the point belongs to.
    torsion : (p,) float
        At the samples, per length, with its sign; 0 on straight lines and in the plane.
    """

    control: Floats
    control_radius: Floats
    branch: Ints
    skeleton: Skeleton
    curvature: Floats
    torsion: Floats

    def __len__(self) -> int:
        return len(self.control)


def bezier_skeleton(
    skeleton: SkeletonLike,
    *,
    tolerance: float = BezierOptions.tolerance,
    samples: int = BezierOptions.samples,
    roots: Ints | None = None,
    tick: Tick = silent,
) -> BezierSkeleton:
    """Fit a smooth curve to every branch of a skeleton, radii included.

    Ends and junctions stay where they are. Every point of a branch is within `tolerance` times its radius of the
    curve, in place and in radius. Between points the curve is as near to the edge, or farther by no more than the
    bulge of an arc that turns as the edges do; in any case inside the balls of the branch.

    Parameters
    ----------
    skeleton : Skeleton, or (points, edges, radius)
        See `tetraskel.kernels.ball_graph.ball_graph`. Lines are cut at ends and junctions.
    tolerance, samples
        See `tetraskel.options.BezierOptions`.
    roots : (c,) int, optional
        Points at which the components are rooted; by default those of the `Skeleton`, else in each component the end
        with the smallest number, or its first point.
    tick : callable, optional
        Told the share of branches done.

    Raises
    ------
    InputError
        For arrays that are no skeleton with radii.

    Examples
    --------
    >>> curve = bezier_skeleton(([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1], [1, 2]], [1, 1, 1]))
    >>> len(curve), curve.control[0, :, 0].round(6).tolist()
    (1, [0.0, 0.666667, 1.333333, 2.0])
    """
    BezierOptions(tolerance=tolerance, samples=samples)
    graph = branches_of(ball_graph(skeleton))
    if roots is None and isinstance(skeleton, Skeleton):
        roots = np.flatnonzero(skeleton.parent < 0) if len(skeleton.parent) == len(graph) else None
    fitted = []
    for number, row in enumerate(_rows(graph)):
        fitted.append(fit_line(_line(graph, row, tolerance)))
        tick((number + 1) / max(len(graph.offsets) - 1, 1))
    return _sampled(graph, fitted, samples, np.empty(0, np.int64) if roots is None else np.asarray(roots))


def _rows(graph: BallGraph) -> list[Ints]:
    return [graph.connectivity[start:stop] for start, stop in pairwise(graph.offsets.tolist())]


def _line(graph: BallGraph, row: Ints, tolerance: float) -> Line:
    """One branch, without points in the place of the one before."""
    balls = np.column_stack([graph.points, graph.radius])[row]
    closed = bool(row[0] == row[-1] and graph.degree[row[0]] == 2)
    apart = np.append(True, (np.diff(balls, axis=0) ** 2).sum(axis=1) > 0)
    if not apart[1:].any():
        balls, apart = balls[[0, -1]], np.array([True, True])  # all in one place: a piece of no length
    elif not apart[-1]:
        apart[np.flatnonzero(apart)[-1]], apart[-1] = False, True  # the last point is an end and stays
    balls = balls[apart]
    least = LEAST * max(graph.diagonal, 1e-300)
    return Line(balls, np.maximum(tolerance * balls[:, -1], least), closed and len(balls) > 3)


def _sampled(graph: BallGraph, fitted: list[Floats], samples: int, roots: Ints) -> BezierSkeleton:
    """Sample the pieces and number everything as in a skeleton of its own."""
    ends = np.unique(np.concatenate([np.flatnonzero(graph.degree == 0), *(row[[0, -1]] for row in _rows(graph))]))
    ends = ends.astype(np.int64)
    at = np.searchsorted(ends, [row[[0, -1]] for row in _rows(graph)]).reshape(-1, 2)
    inner = [_along(pieces, samples) for pieces in fitted]
    sizes = np.array([part.shape[1] for part in inner], dtype=np.int64)
    begins = len(ends) + np.cumsum(sizes) - sizes
    rows = [
        np.concatenate([[a], np.arange(begin, begin + size), [b]])
        for (a, b), begin, size in zip(at.tolist(), begins.tolist(), sizes.tolist(), strict=True)
    ]
    balls = np.concatenate([np.column_stack([graph.points, graph.radius])[ends], *(part[0] for part in inner)])
    offsets = np.concatenate([[0], np.cumsum([len(row) for row in rows], dtype=np.int64)])
    lines = Lines(balls[:, :-1], offsets, np.concatenate([np.empty(0, np.int64), *rows]), np.empty(0, np.int64))
    edges = np.concatenate([np.empty((0, 2), np.int64), *(np.stack([row[:-1], row[1:]], axis=1) for row in rows)])
    component, root_points = _rooted(lines, edges, _near(lines, graph.points[roots]))
    found, number = assemble(lines, component, root_points, balls[:, -1])
    return _described(found, number, rows, fitted, samples)


def _along(pieces: Floats, samples: int) -> Floats:
    """(4, k, D) place and derivatives at the inner samples of a branch."""
    share = np.tile(np.arange(samples) / samples, len(pieces))[1:]
    return bezier_at(np.repeat(pieces, samples, axis=0)[1:], share)


def _near(lines: Lines, places: Floats) -> Ints:
    return np.array([((lines.positions - place) ** 2).sum(axis=1).argmin() for place in places], dtype=np.int64)


def _rooted(lines: Lines, edges: Ints, wanted: Ints) -> tuple[Ints, Ints]:
    """Component of every point, and the root of each: the wanted one, an end, or the first point."""
    n = len(lines.positions)
    degree = np.bincount(edges.ravel(), minlength=n)
    order = np.concatenate([wanted, np.flatnonzero(degree < 2), np.arange(n)]).astype(np.int64)
    component = np.full(n, -1, np.int64)
    roots: list[int] = []
    for point in order.tolist():
        if component[point] < 0:
            reached = walk_from(np.array([point]), edges, n).sequence
            component[reached] = len(roots)
            roots.append(point)
    return component, np.array(roots, dtype=np.int64)


def _described(
    skeleton: Skeleton, number: Ints, rows: list[Ints], fitted: list[Floats], samples: int
) -> BezierSkeleton:
    """Pieces in the order and direction of the skeleton's branches; curvature and torsion at its points."""
    dim = skeleton.points.shape[1]
    curvature, torsion = np.zeros(len(skeleton)), np.zeros(len(skeleton))
    pieces: list[Floats] = [np.empty((0, 4, dim + 1))] * len(rows)
    size = float(np.sqrt((np.ptp(skeleton.points, axis=0) ** 2).sum())) if len(skeleton) else 0.0
    size = size or 1.0  # all in one place
    for row, some in zip(rows, fitted, strict=True):
        ids = number[row]
        branch = int(skeleton.branch_id[ids[1]])
        turned = skeleton.branch(branch)[1] != ids[1]
        pieces[branch] = some[::-1, ::-1] if turned else some
        values = _bending(np.concatenate([_along(some, samples), bezier_at(some[-1:], np.ones(1))], axis=1), size)
        first = _bending(bezier_at(some[:1], np.zeros(1)), size)
        mine = skeleton.branch_id[ids] == branch
        for array, begin, rest in zip((curvature, torsion), first, values, strict=True):
            array[ids[mine]] = np.concatenate([begin, rest])[mine]
    counts = [len(some) for some in pieces]
    control = np.concatenate([np.empty((0, 4, dim + 1)), *pieces])
    owner = np.repeat(np.arange(len(rows)), counts)
    return BezierSkeleton(control[..., :-1], control[..., -1], owner, skeleton, curvature, torsion)


def _bending(found: Floats, size: float) -> tuple[Floats, Floats]:
    """Curvature |C' x C''| / |C'|^3 and torsion det(C', C'', C''') / |C' x C''|^2 from (4, k, D) derivatives."""
    space = np.zeros((*found.shape[:2], 3))
    space[..., : found.shape[2] - 1] = found[..., :-1] / size  # in any unit; what comes back is per length
    _, first, second, third = space
    normal = np.cross(first, second)
    across, speed = np.sqrt((normal**2).sum(axis=1)), np.sqrt((first**2).sum(axis=1))
    moving = speed > STANDING
    curvature = np.where(moving, across / np.where(moving, speed, 1.0) ** 3, 0.0)
    bent = (curvature > STRAIGHT) & (across > STANDING)
    torsion = (normal * third).sum(axis=1) / np.where(bent, across, 1.0) ** 2
    return curvature / size, np.where(bent, torsion, 0.0) / size
