"""Voronoi elements made one skeleton: points in one place merged, elements too narrow left out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.loops_in_python import call_compiled
from tetraskel.kernels.voronoi_diagram import VoronoiDiagram
from tetraskel.kernels.voronoi_elements import Elements, separations
from tetraskel.kernels.voronoi_faces import facets_beside
from tetraskel.kernels.voronoi_lines import edge_keys_of, found_in, grid_keys, ranges, split_keys

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

LIKELY_BITS = 22  # of a name, looked up in a table


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
    """The first of the points at one place for all; lines and polygons that shrink to nothing are left out."""
    if len(given.points) == 0 or step == 0:
        return given
    stands_for = _first_of_each(grid_keys(given.points - given.points.min(axis=0), step))
    if (stands_for == np.arange(len(stands_for))).all():
        return given
    lines, corners = stands_for[given.lines], stands_for[given.connectivity]
    kept = lines[:, 0] != lines[:, 1]
    offsets, corners, polygons = _without_repeats(given.offsets, corners, corners != given.connectivity)
    first = stands_for[given.vertices] == given.vertices  # vertices are the first of the points
    return replace(
        given,
        vertices=given.vertices[first],
        lines=lines[kept],
        offsets=offsets,
        connectivity=corners,
        simplices=given.simplices[first],
        edges=given.edges[kept],
        keys=given.keys[polygons],
        wedges=None,
    )


def _first_of_each(names: NDArray[np.uint64]) -> Ints:
    """(p,) first place with the same name.

    Strategy: to sort names is several times faster than to find their order, which is done for those that come twice.
    """
    found = call_compiled("voronoi_loops.first_of_each", (names,))
    if found is not None:
        return np.asarray(found)
    result = np.arange(len(names))
    ranked = np.sort(names)
    twice = np.zeros(1 << LIKELY_BITS, bool)
    twice[ranked[1:][ranked[1:] == ranked[:-1]] >> np.uint64(64 - LIKELY_BITS)] = True
    some = np.flatnonzero(twice[names >> np.uint64(64 - LIKELY_BITS)])
    order = some[np.argsort(names[some], kind="stable")]
    begins = np.ones(len(order), bool)
    begins[1:] = names[order[1:]] != names[order[:-1]]
    result[order] = order[begins][np.cumsum(begins) - 1]
    return result


def _without_repeats(offsets: Ints, corners: Ints, changed: Bools) -> tuple[Ints, Ints, Ints]:
    """Polygons without equal corners in a row, some of which have (total,) changed, and which keep three or more."""
    counts = np.diff(offsets)
    some = np.unique(np.searchsorted(offsets, np.flatnonzero(changed), "right") - 1)
    begins = np.cumsum(counts[some]) - counts[some]
    rows = ranges(offsets[some], counts[some])
    before = rows - 1
    before[begins] = offsets[some + 1] - 1
    repeated = corners[rows] == corners[before]
    left = counts[some] - np.diff(np.concatenate([[0], np.cumsum(repeated)])[np.append(begins, len(rows))])
    counts[some] = np.where(left < 3, 0, left)
    kept = np.ones(len(corners), bool)
    kept[rows[repeated | np.repeat(left < 3, np.diff(np.append(begins, len(rows))))]] = False
    return np.concatenate([[0], np.cumsum(counts[counts > 0])]), corners[kept], np.flatnonzero(counts)


def simplified(
    diagram: VoronoiDiagram, given: Elements, least_separation: float, least_angle: float
) -> VoronoiSkeleton:
    """Elements that are far enough apart from the points, without lines and vertices that others contain.

    Polygons come first: of a volume most lines and vertices are theirs, and nothing more is asked of those.
    """
    counts = np.diff(given.offsets)

    def measured(generators: Ints, widest: Floats, chosen: Ints) -> tuple[Floats, Floats, Ints]:
        separation = separations(diagram, generators)
        angle = _angles(separation, widest)
        kept = np.flatnonzero((separation >= least_separation) & (angle >= least_angle))
        return separation[kept], angle[kept], chosen[kept]

    widest = np.maximum.reduceat(given.radius[given.connectivity], given.offsets[:-1]) if len(counts) else np.empty(0)
    ends = np.stack(split_keys(given.keys), axis=1)
    *of_polygons, polygons = measured(ends, widest, np.arange(len(counts)))
    offsets, corners, wedges = given.offsets, given.connectivity, given.wedges
    if len(polygons) < len(counts):
        kept = np.zeros(len(counts), bool)
        kept[polygons] = True
        kept = np.repeat(kept, counts)
        offsets, corners = np.concatenate([[0], np.cumsum(counts[polygons])]), corners[kept]
        wedges = None if wedges is None else wedges[kept]
    free: Ints = np.flatnonzero(~_bounding(diagram, given, offsets, corners, wedges))
    widest = np.maximum(*given.radius[given.lines[free].T])
    *of_lines, free = measured(diagram.facet_corners(given.edges[free]), widest, free)
    lines = given.lines[free]
    covered = np.zeros(len(given.points), bool)
    covered[corners] = covered[lines] = True
    alone: Ints = np.flatnonzero(~covered[given.vertices])
    widest = given.radius[given.vertices[alone]]
    *of_vertices, alone = measured(diagram.simplices[given.simplices[alone]], widest, alone)
    vertices = given.vertices[alone]
    covered[vertices] = True
    number = np.cumsum(covered) - 1
    measures = zip(of_vertices, of_lines, of_polygons, strict=True)
    return VoronoiSkeleton(
        given.points[covered],
        given.radius[covered],
        given.cells[covered],
        number[vertices],
        number[lines],
        offsets,
        corners if covered.all() else number[corners],
        *(np.concatenate(values) for values in measures),
    )


def _angles(separation: Floats, widest: Floats) -> Floats:
    """Degrees at which two points that far apart are seen from a place that far from both."""
    share = separation / np.maximum(2 * widest, 1e-300)
    return np.degrees(2 * np.arcsin(np.minimum(share, 1.0)))


def _bounding(diagram: VoronoiDiagram, given: Elements, offsets: Ints, corners: Ints, wedges: Ints | None) -> Bools:
    """(s,) lines that are sides of the polygons.

    A Voronoi edge bounds the faces of the Delaunay edges around its facet, which lies at these in its simplex.
    """
    if len(given.lines) == 0 or len(corners) == 0:
        return np.zeros(len(given.lines), bool)
    if wedges is None:
        return _sides_of(given.lines, offsets, corners)
    return facets_beside(wedges, len(diagram.simplices)).ravel()[diagram.halves[given.edges]]


def _sides_of(lines: Ints, offsets: Ints, corners: Ints) -> Bools:
    """(s,) lines that join corners that follow one another in a polygon."""
    after = np.arange(1, len(corners) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    sides = np.stack([corners, corners[after]], axis=1).astype(np.int64)
    used = np.zeros(int(max(corners.max(), lines.max())) + 1, bool)
    used[corners] = True
    both = used[lines].all(axis=1)
    result = np.zeros(len(lines), bool)
    result[both] = found_in(edge_keys_of(*lines[both].T), edge_keys_of(*sides.T))
    return result
