"""A graph whose points carry balls: what a skeleton is to those who rebuild or smooth it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chains import trace_chains
from tetraskel.kernels.curve_skeleton import Skeleton, line_edges
from tetraskel.kernels.extent import expect_extent

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class BallGraph:
    """Points with radii, joined by polylines.

    Attributes
    ----------
    points : (p, e) float
    radius : (p,) float
        Finite and not negative.
    offsets : (b+1,) int
        Where each polyline begins in `connectivity`.
    connectivity : (total,) int
        Points along each polyline.
    """

    points: Floats
    radius: Floats
    offsets: Ints
    connectivity: Ints

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def edges(self) -> Ints:
        """(s, 2) pairs of points that are joined, each once, the smaller first, none with itself; ascending."""
        pairs = np.sort(line_edges(self.offsets, self.connectivity), axis=1)
        return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)

    @cached_property
    def degree(self) -> Ints:
        """(p,) number of edges at each point."""
        return np.bincount(self.edges.ravel(), minlength=len(self.points))

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the box around all balls."""
        low, high = self.box
        return float(np.sqrt(((high - low) ** 2).sum()))

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates of all balls."""
        reach = self.radius[:, None]
        return (self.points - reach).min(axis=0), (self.points + reach).max(axis=0)


SkeletonLike = Skeleton | BallGraph | tuple[ArrayLike, ArrayLike, ArrayLike]


def ball_graph(skeleton: SkeletonLike) -> BallGraph:
    """The balls of a skeleton, or of arrays (points, edges, radius), checked.

    Parameters
    ----------
    skeleton : Skeleton, BallGraph, or tuple
        The tuple has (p, 2) or (p, 3) points, (s, 2) pairs of points, and (p,) radii.

    Raises
    ------
    InputError
        For coordinates or radii that are not finite, negative radii, shapes that do not fit, or edges between points
        that are not there.
    """
    if isinstance(skeleton, (Skeleton, BallGraph)):
        graph = BallGraph(
            np.asarray(skeleton.points, dtype=float),
            np.asarray(skeleton.radius, dtype=float),
            np.asarray(skeleton.offsets, dtype=np.int64),
            np.asarray(skeleton.connectivity, dtype=np.int64),
        )
    else:
        graph = _from_edges(*skeleton)
    _check(graph)
    return graph


def _from_edges(points: ArrayLike, edges: ArrayLike, radius: ArrayLike) -> BallGraph:
    pairs = _pairs(edges)
    places = np.asarray(points, dtype=float)
    if places.size == 0:
        places = places.reshape(0, places.shape[1] if places.ndim == 2 else 3)
    return BallGraph(places, np.asarray(radius, dtype=float), np.arange(0, 2 * len(pairs) + 1, 2), pairs.ravel())


def _pairs(edges: ArrayLike) -> Ints:
    try:
        pairs = np.asarray(edges)
    except ValueError as error:
        raise InputError(f"expected edges as an array of shape (s, 2), got {error}.") from error
    if pairs.size == 0:
        return np.empty((0, 2), np.int64)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or pairs.dtype.kind not in "iu":
        raise InputError(
            f"expected edges as pairs of point ids of shape (s, 2), got shape {pairs.shape} of type {pairs.dtype}."
        )
    return pairs.astype(np.int64)


def _check(graph: BallGraph) -> None:
    points, radius, ids = graph.points, graph.radius, graph.connectivity
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise InputError(f"expected skeleton points of shape (p, 2) or (p, 3), got {points.shape}.")
    if radius.shape != (len(points),):
        raise InputError(f"expected a radius for each of {len(points)} skeleton points, got shape {radius.shape}.")
    astray = int((~np.isfinite(points).all(axis=1)).sum())
    if astray:
        raise InputError(f"expected finite coordinates, got {astray} of {len(points)} skeleton points with NaN or inf.")
    wrong = int((~(np.isfinite(radius) & (radius >= 0))).sum())
    if wrong:
        raise InputError(
            f"expected radii that are finite and not negative, got {wrong} of {len(points)} that are not; "
            "remove these points or name another radius array."
        )
    if len(ids) and not 0 <= ids.min() <= ids.max() < len(points):
        raise InputError(f"expected edges between points 0 to {len(points) - 1}, got {ids.min()} to {ids.max()}.")
    if len(graph):
        expect_extent(np.stack(graph.box))


def branches_of(graph: BallGraph) -> BallGraph:
    """The same graph with one polyline from junction or end to the next; lines that are so already stay in order.

    A closed line without a junction begins and ends at its point with the smallest number. Points alone have no line.
    """
    if _are_branches(graph):
        return graph
    paths = trace_chains(np.arange(len(graph)), graph.edges).paths
    offsets = np.concatenate([[0], np.cumsum([len(path) for path in paths], dtype=np.int64)])
    return BallGraph(graph.points, graph.radius, offsets, np.concatenate([np.empty(0, np.int64), *paths]))


def _are_branches(graph: BallGraph) -> bool:
    if (np.diff(graph.offsets) < 2).any() or len(line_edges(graph.offsets, graph.connectivity)) != len(graph.edges):
        return False
    inner = np.ones(len(graph.connectivity), bool)
    inner[graph.offsets[:-1]] = inner[graph.offsets[1:] - 1] = False
    first, last = graph.connectivity[graph.offsets[:-1]], graph.connectivity[graph.offsets[1:] - 1]
    through = (graph.degree[first] == 2) | (graph.degree[last] == 2)
    return bool((graph.degree[graph.connectivity[inner]] == 2).all() and (~through | (first == last)).all())
