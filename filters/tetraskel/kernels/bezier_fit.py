"""One line of balls as a smooth piecewise cubic curve: least squares, with the samples' parameters among the unknowns.

The fit of Schneider (1990), alternating between control points and parameters, for splines instead of single pieces:
they share tangents and curvature without anyone having to guess them from noisy samples. Its slow end is cut short by
counting, at every sample, mostly what is normal to the curve (Wang, Pottmann and Liu 2006, tangent distances).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.cubic_spline import SplineSpace, bezier_at

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

ROUNDS = 40  # of fitting with the same pieces at most
FULL_ROUNDS = 2  # of them, the first, where every direction of a deviation counts alike
FARTHEST = 0.1  # of all parameters: how far one may move in a round
PATIENCE = 4  # rounds without a gain before pieces are halved
GAIN = 0.95  # a round that leaves more of the largest deviation than this has gained nothing
MOST_PIECES = 0.6  # per sample; with more, edges are as good
STILL = 1e-11  # of the line's length: control points that move less have arrived
FITTING, FAIR, EXACT = 0.03, 0.1, 1e-3  # what a deviation along the curve counts beside one normal to it
FOUND = 1e-3  # of the tolerance: samples this near are those of such a curve
ANCHOR = 1e-10  # what staying in place counts beside the samples: pieces that no sample settles keep still
CHECKS = 8  # places on each piece that are compared with the line
CLOSED_PIECES = 6  # a closed curve begins with that many
HANDLE = 1 / 3
GENTLE = 0.6  # radians from edge to edge: less is taken for a curve, more for a corner
BULGE = 0.25  # of length times turning: what a curve may bulge over an edge, twice the height of an arc
INSIDE = 0.9  # of the radius: how far from the line a curve may be at most


@dataclass(frozen=True)
class Line:
    """What is fitted.

    Attributes
    ----------
    balls : (n, D) float
        Centres with their radius as last coordinate; the first again at the end of a closed line; no two in a row
        in the same place.
    tolerance : (n,) float
        How far the curve may be from the line, in place and in radius.
    closed : bool
        Smooth where it closes; else the ends stay.
    """

    balls: Floats
    tolerance: Floats
    closed: bool

    @cached_property
    def slack(self) -> Floats:
        """(n-1,) how far the curve may be from an edge beyond the tolerance, because the line itself is a curve."""
        way = np.diff(self.balls[:, :-1], axis=0)
        long = np.sqrt((way**2).sum(axis=1))
        unit = way / np.maximum(long, 1e-300)[:, None]
        around = np.concatenate([unit[-1:] if self.closed else unit[:1], unit, unit[:1] if self.closed else unit[-1:]])
        turning = np.arccos(np.clip((around[:-1] * around[1:]).sum(axis=1), -1, 1))
        most = np.maximum(turning[:-1], turning[1:])
        room = np.minimum(
            *(INSIDE * self.balls[part, -1] - self.tolerance[part] for part in (slice(-1), slice(1, None)))
        )
        return np.where(most < GENTLE, np.clip(BULGE * long * most, 0, np.maximum(room, 0)), 0.0)

    @property
    def steps(self) -> Floats:
        """(n-1,) distance from ball to ball, their radii counted as a coordinate."""
        return np.sqrt((np.diff(self.balls, axis=0) ** 2).sum(axis=1))


def fit_line(line: Line) -> Floats:
    """(s, 4, D) Bezier points of cubic pieces that keep the line's tolerance.

    Pieces that are, are halved. Where that ends, at pieces without a sample inside or with hardly fewer pieces than
    edges, every edge becomes a piece that hugs it.
    """
    along = np.concatenate([[0], np.cumsum(line.steps)])
    if along[-1] == 0:
        return line.balls[[0, 0, -1, -1]][None]
    start = along / along[-1]
    breaks = np.linspace(0, 1, (CLOSED_PIECES if line.closed else 1) + 1)
    while True:
        space = SplineSpace(breaks, line.closed)
        control, at = _within(line, space, _on_line(line, start, space.middles), start)
        bad = _excess(line, space, control, at) > 1
        if not bad.any():
            return space.pieces(_polished(line, space, control, at))
        halved = _halved(breaks, bad, start)
        if len(halved) == len(breaks) or len(halved) > MOST_PIECES * len(start) + 2:
            return hugging(line)
        breaks = halved


def _on_line(line: Line, at: Floats, wanted: Floats) -> Floats:
    return np.stack([np.interp(wanted, at, column) for column in line.balls.T], axis=1)


def _within(line: Line, space: SplineSpace, control: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Control points and parameters after rounds of fitting, as soon as the tolerance is kept or no round helps."""
    best, idle = np.inf, 0
    for number in range(ROUNDS):
        control = _least_squares(line, space, control, at, 1.0 if number < FULL_ROUNDS else FITTING)
        at = _feet(line, space, control, at)
        worst = _excess(line, space, control, at).max()
        idle = 0 if worst < GAIN * best else idle + 1
        best = min(best, worst)
        if worst <= 1 or idle == PATIENCE:
            break
    return control, at


def _polished(line: Line, space: SplineSpace, control: Floats, at: Floats) -> Floats:
    """Control points of the best fit with these pieces, unless it leaves the tolerance that the given ones keep.

    Samples of such a curve lead back to it, when little holds them along it; others then leave its speed undecided,
    to the point of cusps, and are fitted with a firmer hold.
    """
    for along, enough in ((EXACT, FOUND), (FAIR, 1.0)):
        better, feet = _converged(line, space, control, at, along)
        near = _apart(_at(space, better, feet)[0] - line.balls, line.tolerance).max() <= enough
        if near and _excess(line, space, better, feet).max() <= 1:
            return better
    return control


def _converged(line: Line, space: SplineSpace, control: Floats, at: Floats, along: float) -> tuple[Floats, Floats]:
    still = STILL * line.steps.sum()
    for _ in range(ROUNDS):
        before = control
        control = _least_squares(line, space, control, at, along)
        at = _feet(line, space, control, at)
        if np.abs(control - before).max() <= still:
            break
    return control, at


def _least_squares(line: Line, space: SplineSpace, control: Floats, at: Floats, along: float) -> Floats:
    """Control points nearest to the samples; what is along the curve counts `along` times what is normal to it.

    Normal equations: each sample meets four control points; the matrix that weighs the directions of its deviation
    is the identity less most of the tangent's.
    """
    samples = line.balls[:-1] if line.closed else line.balls
    at = at[: len(samples)]
    piece = space.piece_of(at)
    columns, weights = space.columns(piece), space.weights(at, piece)
    dim, size = samples.shape[1], space.size
    metric = np.tile(np.eye(dim), (len(samples), 1, 1))
    if along < 1:
        tangent = _at(space, control, at)[1]
        tangent[:, -1] = 0  # the radius follows the place: it moves no sample along the curve
        tangent /= np.maximum(np.sqrt((tangent**2).sum(axis=1)), 1e-300)[:, None]
        metric -= (1 - along) * tangent[:, :, None] * tangent[:, None, :]
    metric /= (line.tolerance[: len(samples)] / line.tolerance.max())[:, None, None] ** 2
    blocks = weights[:, :, None, None, None] * weights[:, None, :, None, None] * metric[:, None, None]
    matrix = np.zeros((size, size, dim, dim))
    np.add.at(matrix, (columns[:, :, None], columns[:, None, :]), blocks)
    residual = samples - (weights[:, :, None] * control[columns]).sum(axis=1)
    right = np.zeros((size, dim))
    np.add.at(right, columns, weights[:, :, None] * np.einsum("nij,nj->ni", metric, residual)[:, None])
    free = np.arange(size) if space.closed else np.arange(1, size - 1)
    square = matrix[np.ix_(free, free)].transpose(0, 2, 1, 3).reshape(len(free) * dim, -1)
    square[np.diag_indices(len(square))] += ANCHOR * (1 + np.trace(square) / len(square))
    moved = control.copy()
    moved[free] += np.linalg.solve(square, right[free].ravel()).reshape(-1, dim)
    return moved


def _at(space: SplineSpace, control: Floats, at: Floats) -> Floats:
    """(4, n, D) place and derivatives of the spline with respect to the parameter of the whole curve."""
    piece = space.piece_of(at)
    width = np.diff(space.breaks)[piece]
    found = bezier_at(space.pieces(control)[piece], (at - space.breaks[piece]) / width)
    return found / width[None, :, None] ** np.arange(4)[:, None, None]


def _feet(line: Line, space: SplineSpace, control: Floats, at: Floats) -> Floats:
    """Parameters moved by a step of Newton's method to where each sample is nearest in space, in the same order."""
    place, first, second, _ = _at(space, control, at)
    away, first, second = (place - line.balls)[:, :-1], first[:, :-1], second[:, :-1]
    slope, bend = (away * first).sum(axis=1), (first**2).sum(axis=1)
    curved = bend + (away * second).sum(axis=1)
    step = -slope / np.maximum(np.where(curved > 0.1 * bend, curved, bend), 1e-300)
    step[[0, -1]] = 0
    moved = np.clip(at + np.clip(step, -FARTHEST, FARTHEST), 0, 1)
    return np.maximum.accumulate(moved)


def _excess(line: Line, space: SplineSpace, control: Floats, at: Floats) -> Floats:
    """(m,) largest distance of each piece from the line, in tolerances: at the samples and at places between."""
    worst = np.zeros(space.n_pieces)
    away = _at(space, control, at)[0] - line.balls
    np.maximum.at(worst, space.piece_of(at), _apart(away, line.tolerance))
    share = (np.arange(CHECKS) + 0.5) / CHECKS
    wanted = (space.breaks[:-1, None] + np.diff(space.breaks)[:, None] * share).ravel()
    place = _at(space, control, wanted)[0]
    edge = np.searchsorted(at, wanted, side="right") - 1
    near = [_from_edge(line, np.clip(edge + shift, 0, len(at) - 2), place) for shift in (-1, 0, 1)]
    return np.maximum(worst, np.min(near, axis=0).reshape(-1, CHECKS).max(axis=1))


def _from_edge(line: Line, edge: Ints, places: Floats) -> Floats:
    """Distance to the nearest place of an edge of the line, in what is allowed there."""
    start, way = line.balls[edge], line.balls[edge + 1] - line.balls[edge]
    square = np.maximum((way[:, :-1] ** 2).sum(axis=1), 1e-300)
    share = np.clip(((places - start) * way)[:, :-1].sum(axis=1) / square, 0, 1)
    tolerance = (1 - share) * line.tolerance[edge] + share * line.tolerance[edge + 1] + line.slack[edge]
    return _apart(places - start - share[:, None] * way, tolerance)


def _apart(away: Floats, tolerance: Floats) -> Floats:
    """The larger of a deviation's size in space and in radius, in tolerances; what is not a number is far."""
    size = np.maximum(np.sqrt((away[:, :-1] ** 2).sum(axis=1)), np.abs(away[:, -1])) / tolerance
    return np.where(np.isfinite(size), size, 1e300)


def _halved(breaks: Floats, bad: Bools, at: Floats) -> Floats:
    """Breaks with one more in each bad piece, at the middle one of the samples inside it; unchanged if none has one."""
    low, high = np.searchsorted(at, breaks[:-1], side="right"), np.searchsorted(at, breaks[1:], side="left")
    splits = bad & (high > low)
    return np.unique(np.concatenate([breaks, at[((low + high) // 2)[splits]]]))


def hugging(line: Line) -> Floats:
    """(n-1, 4, D) a piece per edge, with one direction where two meet, and handles too short to leave the tolerance."""
    way = np.diff(line.balls, axis=0)
    long = np.sqrt((way**2).sum(axis=1))[:, None]
    unit = way / np.maximum(long, 1e-300)
    before = np.concatenate([unit[-1:] if line.closed else unit[:1], unit])
    after = np.concatenate([unit, unit[:1] if line.closed else unit[-1:]])
    direction = before + after
    direction /= np.maximum(np.sqrt((direction**2).sum(axis=1)), 1e-300)[:, None]
    reach = HANDLE * np.minimum(long, np.minimum(line.tolerance[:-1], line.tolerance[1:])[:, None])
    first, last = line.balls[:-1], line.balls[1:]
    return np.stack([first, first + reach * direction[:-1], last - reach * direction[1:], last], axis=1)
