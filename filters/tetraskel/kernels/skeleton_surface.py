"""The way back from a skeleton to its object: the surface of the balls along its edges."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.ball_graph import BallGraph, SkeletonLike, ball_graph, branches_of
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.marching import contour_blocks
from tetraskel.kernels.plane import Plane, plane_of, roundings_by_axis
from tetraskel.kernels.round_cones import RoundCones, nearest_along, round_cones
from tetraskel.kernels.straightened import straightened
from tetraskel.kernels.surface_blocks import Blocks, Grid, block_values, grid_around, surface_blocks
from tetraskel.options import SurfaceOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

CELL_ROUNDINGS = 64  # of the largest coordinate in a cell: below, grid points fall together
THIN_SHARE = 0.1  # of the length may be thinner than the radius that chooses the spacing
STRAIGHT = 0.05  # of the spacing: edges that run straighter than this become one
FINEST = 1024  # cells along the longest side of the box, when the spacing is chosen here
CROSSED_PER_AREA = 1.5  # cells a surface passes through, per area of a cell's face
PAIRS = 8192  # blocks times cones evaluated at a time


@dataclass(frozen=True)
class RebuiltSurface:
    """A closed surface in space, or closed lines in the plane.

    Attributes
    ----------
    points : (v, e) float
    simplices : (t, 3) or (t, 2) int
        Triangles counter-clockwise as seen from outside, or segments with the object to their left.
    normals : (v, e) float
        Unit vectors outwards.
    radius : (v,) float
        Of the nearest ball of the skeleton.
    branch : (v,) int
        Branch that ball belongs to, -1 for a point that stands alone.
    spacing : float
        Side of the grid's cells.
    thickened : int
        Skeleton points whose balls the grid could not resolve; they were drawn with half a cell's diagonal as radius,
        so that nothing is lost or torn.
    capped : bool
        The cells were made larger than the radii ask for, to keep to the largest number of them.
    """

    points: Floats
    simplices: Ints
    normals: Floats
    radius: Floats
    branch: Ints
    spacing: float = 0.0
    thickened: int = 0
    capped: bool = False

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def loops(self) -> tuple[Ints, Ints]:
        """Offsets (l+1,) and points of the closed lines of a surface in the plane, the first point not repeated."""
        after = np.full(len(self.points), -1, np.int64)
        after[self.simplices[:, 0]] = self.simplices[:, 1]
        ahead, offsets, order = after.tolist(), [0], []
        for start in range(len(ahead)):
            point = start
            while ahead[point] >= 0:
                order.append(point)
                ahead[point], point = -1, ahead[point]
            if len(order) > offsets[-1]:
                offsets.append(len(order))
        return np.array(offsets, np.int64), np.array(order, np.int64)


def skeleton_surface(
    skeleton: SkeletonLike,
    *,
    spacing: float = SurfaceOptions.spacing,
    cells_per_radius: float = SurfaceOptions.cells_per_radius,
    max_cells: int = SurfaceOptions.max_cells,
    dimension: str = SurfaceOptions.dimension,
    tick: Tick = silent,
) -> RebuiltSurface:
    """The surface of the union of a skeleton's balls and of the tapered cones between neighbouring ones.

    Parameters
    ----------
    skeleton : Skeleton, or (points, edges, radius)
        See `tetraskel.kernels.ball_graph.ball_graph`.
    spacing, cells_per_radius, max_cells
        See `tetraskel.options.SurfaceOptions`.
    dimension : {"auto", "space", "plane"}
        A surface in space or the outline of a region of the plane; auto goes by the number of coordinates. A region
        of any plane of space comes back in that plane.
    tick : callable, optional

    Returns
    -------
    RebuiltSurface
        Watertight, whatever the skeleton: every edge belongs to two triangles.

    Raises
    ------
    InputError
        For arrays that are no skeleton with radii, or a skeleton that leaves the plane it is to be drawn in.

    Examples
    --------
    >>> ball = skeleton_surface(([[0, 0, 0]], [], [1.0]))
    >>> bool(abs((ball.points**2).sum(axis=1) ** 0.5 - 1).max() < 0.02)
    True
    """
    SurfaceOptions(spacing=spacing, cells_per_radius=cells_per_radius, max_cells=max_cells, dimension=dimension)
    graph = ball_graph(skeleton)
    dim = graph.points.shape[1]
    if len(graph) == 0 or (dim == 2 and dimension == "space"):
        if len(graph):
            raise InputError("expected skeleton points with three coordinates for a surface in space, got two.")
        return _empty(dim, 2 if dimension == "plane" else dim)
    if dim == 3 and dimension == "plane":
        plane = skeleton_plane(graph.points)
        flat = replace(graph, points=plane.project(graph.points))
        return _lifted(_surface(flat, spacing, cells_per_radius, max_cells, tick), plane)
    return _surface(graph, spacing, cells_per_radius, max_cells, tick)


def _empty(width: int, dim: int) -> RebuiltSurface:
    none = np.empty((0, width))
    return RebuiltSurface(none, np.empty((0, dim), np.int64), none, np.empty(0), np.empty(0, np.int64))


def skeleton_plane(points: Floats) -> Plane:
    """The plane that holds (p, 3) points; z = constant where they leave a choice.

    Raises
    ------
    InputError
        When there is none.
    """
    for kind in (np.float64, np.float32):
        tolerance = roundings_by_axis(points, np.dtype(kind))
        if np.ptp(points[:, 2]) <= tolerance[2]:
            return Plane(np.array([0.0, 0.0, points[:, 2].min()]), np.eye(3)[:2])
        plane = plane_of(points, tolerance)
        if plane is not None:
            return plane
    raise InputError("expected a skeleton in one plane, got one that leaves it; choose dimension = space.")


def _lifted(surface: RebuiltSurface, plane: Plane) -> RebuiltSurface:
    return replace(surface, points=plane.lift(surface.points), normals=surface.normals @ plane.directions)


def _surface(graph: BallGraph, spacing: float, fineness: float, max_cells: int, tick: Tick) -> RebuiltSurface:
    branches = branches_of(graph)
    step, capped = (spacing, False) if spacing > 0 else chosen_spacing(branches, fineness, max_cells)
    dim = graph.points.shape[1]
    rounding = CELL_ROUNDINGS * np.finfo(float).eps * float(np.abs(np.stack(branches.box)).max())
    if step < rounding:
        raise InputError(
            f"expected cells larger than the rounding of the coordinates ({rounding:.3g}), got {step:.3g}; move the "
            "skeleton near to the origin, or give a larger spacing."
        )
    floor = 0.5 * np.sqrt(dim) * step
    thin = branches.radius < floor
    branches = replace(branches, radius=np.maximum(branches.radius, floor))
    edges, branch = straightened(branches, STRAIGHT * step)
    alone = np.flatnonzero(branches.degree == 0)
    edges = np.concatenate([edges, np.stack([alone, alone], axis=1)])
    branch = np.concatenate([branch, np.full(len(alone), -1)])
    cones = round_cones(branches.points, branches.radius, edges)
    grid = grid_around(*branches.box, step)
    blocks = surface_blocks(cones, grid, part(tick, 0.0, 0.3))
    parts = _contoured(cones, grid, blocks, part(tick, 0.3, 1.0))
    surface = _joined(parts, branch)
    return replace(surface, spacing=float(step), thickened=int(thin.sum()), capped=capped)


def chosen_spacing(branches: BallGraph, cells_per_radius: float, max_cells: int) -> tuple[float, bool]:
    """A side for the cells: a share of a small radius, but not more cells than allowed; and whether that bound it.

    All but a tenth of the length is at least as thick as the radius asked; skeletons often taper to nothing at their
    ends, which must not decide.
    """
    first, second = branches.edges.T
    long = np.sqrt(((branches.points[second] - branches.points[first]) ** 2).sum(axis=1))
    middle = 0.5 * (branches.radius[first] + branches.radius[second])
    alone = branches.radius[branches.degree == 0]
    radii, weights = np.concatenate([middle, alone]), np.concatenate([long, 2 * alone])
    low, high = branches.box
    size = float((high - low).max())
    if size == 0 or weights.sum() == 0:
        return size / cells_per_radius or 1.0, False
    order = np.argsort(radii, kind="stable")
    thin = radii[order][np.searchsorted(np.cumsum(weights[order]), THIN_SHARE * weights.sum())]
    wanted = float(thin) / cells_per_radius
    dim = branches.points.shape[1]
    if dim == 3:
        area = 2 * np.pi * float((middle * long).sum()) + 4 * np.pi * float(
            (branches.radius[branches.degree < 2] ** 2).sum()
        )
        coarsest = float(np.sqrt(CROSSED_PER_AREA * area / max_cells))
    else:
        coarsest = CROSSED_PER_AREA * 2 * (float(long.sum()) + np.pi * float(branches.radius.max())) / max_cells
    least = max(coarsest, size / FINEST)
    return max(wanted, least), wanted < least


@dataclass(frozen=True)
class _Part:
    """What the blocks of one piece of work give: pieces and points by grid edge, with what is known of each point."""

    keys: Ints
    pieces: Ints
    points: Floats
    normals: Floats
    radius: Floats
    cone: Ints


def _contoured(cones: RoundCones, grid: Grid, blocks: Blocks, tick: Tick) -> list[_Part]:
    """The surface, some blocks at a time, so that memory stays that of the surface itself."""
    steps = np.arange(0, blocks.offsets[-1], PAIRS)
    cuts = np.unique(np.append(np.searchsorted(blocks.offsets[:-1], steps), len(blocks)))
    parts = []
    for start, stop in pairwise(cuts.tolist()):
        parts.append(_part(cones, grid, blocks, slice(start, stop)))
        tick(stop / len(blocks))
    return parts


def _part(cones: RoundCones, grid: Grid, blocks: Blocks, some: slice) -> _Part:
    found = contour_blocks(block_values(cones, grid, blocks, some), blocks.corner[some], grid.shape)
    place = np.stack(np.unravel_index(found.keys // len(grid.shape), tuple(grid.shape)), axis=1).astype(float)
    place[np.arange(len(place)), found.keys % len(grid.shape)] += found.share
    points = grid.origin + grid.spacing * place
    cone, along = _nearest_cones(cones, points, blocks, some.start + found.block)
    away = points - cones.start[cone] - along[:, None] * cones.axis[cone]
    normals = away / np.maximum(np.sqrt((away**2).sum(axis=1)), 1e-300)[:, None]
    return _Part(found.keys, found.pieces, points, normals, cones.radius[cone] + cones.slope[cone] * along, cone)


def _nearest_cones(cones: RoundCones, points: Floats, blocks: Blocks, block: Ints) -> tuple[Ints, Floats]:
    """Cone nearest to each point, of those that matter in its block, and where along it the nearest ball is."""
    first = blocks.offsets[block]
    sizes = blocks.offsets[block + 1] - first
    begins = np.cumsum(sizes) - sizes
    which = blocks.cones[np.arange(int(sizes.sum())) + np.repeat(first - begins, sizes)]
    distance, along = nearest_along(cones, np.repeat(points.T, sizes, axis=1), which)
    if len(points) == 0:
        return which, along
    least = np.minimum.reduceat(distance, begins)
    best = np.flatnonzero(distance == np.repeat(least, sizes))
    best = best[np.searchsorted(best, begins)]  # the first of equal ones
    return which[best], along[best]


def _joined(parts: list[_Part], branch: Ints) -> RebuiltSurface:
    """One surface: points in the order of their grid edges, pieces in that of the blocks."""
    keys, pieces, points, normals, radius, cone = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("keys", "pieces", "points", "normals", "radius", "cone")
    )
    order = np.argsort(keys, kind="stable")
    simplices = np.searchsorted(keys[order], pieces)
    return RebuiltSurface(points[order], simplices, normals[order], radius[order], branch[cone[order]])
