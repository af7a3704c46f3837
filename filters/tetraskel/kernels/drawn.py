"""What any skeleton draws: points with radii, lines between them, and sheets; one form in which all are compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.curve_skeleton import Skeleton
from tetraskel.kernels.raster_skeleton import RasterSkeleton
from tetraskel.kernels.skeleton import TreeSkeleton
from tetraskel.kernels.voronoi_simplification import VoronoiSkeleton

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

POINTS, LINES, SHEETS = "points", "lines", "sheets"


@dataclass(frozen=True)
class Drawn:
    """Points, lines and polygons.

    Attributes
    ----------
    kind : {"points", "lines", "sheets"}
        What counts: points alone, though neighbours may be joined; lines; or polygons, with lines beside them.
    points : (p, e) float
    radius : (p,) float
    edges : (s, 2) int
        Ends of each line.
    offsets, connectivity : (f+1,), (total,) int
        Polygons: where each begins among the points of all.
    """

    kind: str
    points: Floats
    radius: Floats
    edges: Ints
    offsets: Ints
    connectivity: Ints

    def __len__(self) -> int:
        return len(self.points)

    @property
    def sides(self) -> Ints:
        """(total, 2) sides of the polygons, polygon after polygon."""
        after = np.arange(1, len(self.connectivity) + 1)
        after[self.offsets[1:] - 1] = self.offsets[:-1]
        return np.stack([self.connectivity, self.connectivity[after]], axis=1)

    @property
    def all_edges(self) -> Ints:
        """(k, 2) lines and sides of polygons, each once, the smaller point first; ascending."""
        pairs = np.sort(np.concatenate([self.edges, self.sides]), axis=1).astype(np.int64)
        return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)


def drawn_lines(points: Floats, radius: Floats, edges: Ints, kind: str = LINES) -> Drawn:
    """Points and lines without polygons."""
    return Drawn(kind, points, radius, edges.reshape(-1, 2), np.zeros(1, np.int64), np.empty(0, np.int64))


def drawn_skeleton(skeleton: Skeleton) -> Drawn:
    """A curve skeleton, or a smooth one as it is sampled."""
    return drawn_lines(skeleton.points, skeleton.radius, skeleton.edges)


def drawn_tree(skeleton: TreeSkeleton, radius: Floats) -> Drawn:
    """The skeleton of a tree, with a radius for each of its points."""
    son = np.flatnonzero(skeleton.parent >= 0)
    return drawn_lines(skeleton.points, radius, np.stack([skeleton.parent[son], son], axis=1))


def drawn_voronoi(skeleton: VoronoiSkeleton) -> Drawn:
    """A Voronoi skeleton: points where it has nothing else, sheets where it has any."""
    kind = SHEETS if skeleton.n_polygons else LINES if len(skeleton.lines) else POINTS
    return Drawn(kind, skeleton.points, skeleton.radius, skeleton.lines, skeleton.offsets, skeleton.connectivity)


def drawn_raster(skeleton: RasterSkeleton, points: Floats) -> Drawn:
    """A raster skeleton at `points`: thinning gives lines, the other methods sets of grid points."""
    kind = LINES if skeleton.method == "thinning" else POINTS
    return drawn_lines(points, skeleton.radius, skeleton.lines, kind)
