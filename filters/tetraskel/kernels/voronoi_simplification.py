"""Voronoi elements made one skeleton: points in one place merged, elements too narrow left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.adjacency import scramble
from tetraskel.kernels.voronoi_elements import Elements
from tetraskel.kernels.voronoi_lines import edge_keys_of, found_in

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class VoronoiSkeleton:
    """Vertices, lines and polygons of a Voronoi skeleton, in the order of the mesh's simplices.

    Attributes
    ----------
    points : (p, e) float
        In the input's unit and space.
    radius : (p,) float
        Distance to the nearest points of the mesh (`MaximumInscribedSphereRadius`).
    cells : (p,) int
        Simplex whose circumcentre a point is, -1 where a Voronoi element was cut (`CellId`).
    vertices : (v,) int
        Points that end no line and no polygon.
    lines : (s, 2) int
        In space those that bound no polygon.
    offsets, connectivity : (f+1,), (total,) int
        Polygons, in space: where each begins among the points of all. Corners are in order; a polygon that was cut
        need not be convex.
    separation : (v + s + f,) float
        Of each vertex, line and polygon, in this order: largest distance between two of the points it is nearest to.
    angle : (v + s + f,) float
        Angle, in degrees, at which these two are seen from the widest place of the element.
    """

    points: Floats
    radius: Floats
    cells: Ints
    vertices: Ints
    lines: Ints
    offsets: Ints
    connectivity: Ints
    separation: Floats
    angle: Floats

    def __len__(self) -> int:
        return len(self.points)

    @property
    def n_polygons(self) -> int:
        """Number of polygons."""
        return len(self.offsets) - 1


def merged(given: Elements, step: float) -> Elements:
    """Points at one place as one, the first; lines and polygons that shrink to nothing are left out."""
    if len(given.points) == 0 or step == 0:
        return given
    grid = np.rint((given.points - given.points.min(axis=0)) / step).astype(np.int64).view(np.uint64)
    names = scramble(grid[:, 0])
    for column in grid.T[1:]:
        names = scramble(names + column)
    once, first, back = np.unique(names, return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = np.empty(len(once), np.int64)
    number[order] = np.arange(len(once))
    number, first = number[back.ravel()], first[order]
    lines = number[given.lines]
    kept = lines[:, 0] != lines[:, 1]
    offsets, corners, polygons = _without_repeats(given.offsets, number[given.connectivity])
    vertices, which = np.unique(number[given.vertices], return_index=True)
    of_vertices, of_lines, of_polygons = given.separations
    return Elements(
        given.points[first],
        given.radius[first],
        given.cells[first],
        vertices,
        lines[kept],
        offsets,
        corners,
        (of_vertices[which], of_lines[kept], of_polygons[polygons]),
    )


def _without_repeats(offsets: Ints, corners: Ints) -> tuple[Ints, Ints, Ints]:
    """Polygons without equal corners in a row, and which of them keep three or more."""
    if len(corners) == 0:
        return offsets[:1], corners, np.empty(0, np.int64)
    counts = np.diff(offsets)
    before = np.arange(len(corners)) - 1
    before[offsets[:-1]] = offsets[1:] - 1
    kept = corners != corners[before]
    counts = np.add.reduceat(kept.astype(np.int64), offsets[:-1])
    real = counts >= 3
    kept &= np.repeat(real, np.diff(offsets))
    return np.concatenate([[0], np.cumsum(counts[real])]), corners[kept], np.flatnonzero(real)


def simplified(given: Elements, least_separation: float, least_angle: float) -> VoronoiSkeleton:
    """Elements that are far enough apart from the points, without lines and vertices that others contain."""
    counts = np.diff(given.offsets)
    polygon_of = np.repeat(np.arange(len(counts)), counts)
    widest = (
        given.radius[given.vertices],
        given.radius[given.lines].max(axis=1, initial=0.0),
        np.maximum.reduceat(given.radius[given.connectivity], given.offsets[:-1]) if len(counts) else np.empty(0),
    )
    angles = [_angles(*pair) for pair in zip(given.separations, widest, strict=True)]
    vertex_kept, line_kept, polygon_kept = (
        (separation >= least_separation) & (angle >= least_angle)
        for separation, angle in zip(given.separations, angles, strict=True)
    )
    corners = given.connectivity[polygon_kept[polygon_of]]
    offsets = np.concatenate([[0], np.cumsum(counts[polygon_kept])])
    line_kept &= ~_bounding(given.lines, offsets, corners)
    lines = given.lines[line_kept]
    covered = np.zeros(len(given.points), bool)
    covered[corners] = covered[lines] = True
    vertex_kept &= ~covered[given.vertices]
    vertices = given.vertices[vertex_kept]
    covered[vertices] = True
    number = np.cumsum(covered) - 1
    flags = (vertex_kept, line_kept, polygon_kept)
    return VoronoiSkeleton(
        given.points[covered],
        given.radius[covered],
        given.cells[covered],
        number[vertices],
        number[lines],
        offsets,
        number[corners],
        np.concatenate([values[flag] for values, flag in zip(given.separations, flags, strict=True)]),
        np.concatenate([values[flag] for values, flag in zip(angles, flags, strict=True)]),
    )


def _angles(separation: Floats, widest: Floats) -> Floats:
    """Degrees at which two points that far apart are seen from a place that far from both."""
    share = separation / np.maximum(2 * widest, 1e-300)
    return np.degrees(2 * np.arcsin(np.minimum(share, 1.0)))


def _bounding(lines: Ints, offsets: Ints, corners: Ints) -> Bools:
    """(s,) lines that are sides of polygons."""
    if len(lines) == 0 or len(corners) == 0:
        return np.zeros(len(lines), bool)
    after = np.arange(1, len(corners) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    sides = np.stack([corners, corners[after]], axis=1).astype(np.int64)
    used = np.zeros(int(max(corners.max(), lines.max())) + 1, bool)
    used[corners] = True
    both = used[lines].all(axis=1)
    result = np.zeros(len(lines), bool)
    result[both] = found_in(edge_keys_of(*lines[both].T), edge_keys_of(*sides.T))
    return result
