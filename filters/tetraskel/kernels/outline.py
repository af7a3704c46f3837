"""Inside by an outline in the plane: the triangulation made to follow it, then the even-odd rule."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import EngineError, InputError
from tetraskel.kernels.chunks import Tick, for_chunks, silent
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.plane import plane_of_mesh, rounding
from tetraskel.kernels.triangulate import ENGINE_MODULES, triangulate

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

ROUNDS = 60  # halving a segment so often leaves nothing to halve
MOST_SPLITS = 20  # new points per point given, before an outline counts as hopeless
ROUNDINGS_APART = 4.0  # times `rounding`: nearer points are one, and a point so near to a segment lies on it


def inside_by_outline(
    mesh: Triangulation, points: ArrayLike, segments: ArrayLike, *, tick: Tick = silent
) -> tuple[Triangulation, Bools]:
    """A triangulation that follows the outline, and which (m,) of its triangles lie inside by the even-odd rule.

    Parameters
    ----------
    mesh : Triangulation
        Of triangles, in the plane or in one plane of space.
    points : (k, 2) array, or (k, 3) for a mesh in space
        Points in space are projected into the plane of the mesh.
    segments : (s, 2) array of point ids
        Closed lines, in any order and direction; a polygon inside another one is a hole.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    Triangulation
        Its `original_ids` are -1 at points of the outline, given or added, that the mesh did not have.
    (m,) bool

    Raises
    ------
    InputError
        For an outline that does not close, crosses itself, or cannot be followed with a bounded number of points.
    """
    flat, corners = _in_plane(mesh, points)
    corners, edges = checked_outline(flat, corners, segments)
    followed = conform(flat, corners, edges, tick)
    inside = even_odd(followed.points[followed.simplices].mean(axis=1), corners, edges)
    return replace(followed, points=_lifted(mesh, followed.points)), inside


def _in_plane(mesh: Triangulation, points: ArrayLike) -> tuple[Triangulation, Floats]:
    """The mesh and an outline's points in two coordinates."""
    corners = np.asarray(points, dtype=np.float64)
    if mesh.dim != 2 or corners.ndim != 2 or corners.shape[1] != mesh.points.shape[1]:
        raise InputError(
            f"expected triangles, and an outline with as many coordinates, got simplices of {mesh.dim + 1} points "
            f"with {mesh.points.shape[1]} coordinates and an outline of shape {corners.shape}."
        )
    if mesh.points.shape[1] == 2:
        return mesh, corners
    plane = plane_of_mesh(mesh.points)
    return replace(mesh, points=plane.project(mesh.points)), plane.project(corners)


def _lifted(mesh: Triangulation, points: Floats) -> Floats:
    """Points of the plane, the mesh's own first, with the mesh's number of coordinates."""
    if mesh.points.shape[1] == 2:
        return points
    added = plane_of_mesh(mesh.points).lift(points[len(mesh.points) :])
    return np.concatenate([mesh.points, added])


def checked_outline(mesh: Triangulation, points: ArrayLike, segments: ArrayLike) -> tuple[Floats, Ints]:
    """Distinct points and segments of an outline that closes and does not cross itself."""
    corners, edges = np.asarray(points, dtype=np.float64), np.asarray(segments)
    if mesh.dim != 2 or mesh.points.shape[1] != 2 or corners.ndim != 2 or corners.shape[1] != 2:
        raise InputError(
            f"expected triangles and an outline with two coordinates, got {mesh.points.shape[1]} and an outline of "
            f"shape {corners.shape}; for a plane in space use inside_by_outline."
        )
    if edges.ndim != 2 or edges.shape[1] != 2 or len(edges) == 0 or edges.dtype.kind not in "iu":
        raise InputError(f"expected segments as an array of point ids of shape (s, 2), got shape {edges.shape}.")
    if not np.isfinite(corners).all() or not 0 <= edges.min() <= edges.max() < len(corners):
        raise InputError(
            f"expected finite points and segment ids from 0 to {len(corners) - 1}, got NaN, infinity or other ids."
        )
    expect_extent(mesh.points)
    expect_extent(corners)
    used, edges = np.unique(edges, return_inverse=True)
    corners, merged = np.unique(corners[used], axis=0, return_inverse=True)
    edges = np.sort(merged.reshape(-1)[edges.reshape(-1, 2)], axis=1)
    edges, times = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0, return_counts=True)
    edges = edges[times % 2 == 1]  # there and back again bounds nothing
    loose = int(np.count_nonzero(np.bincount(edges.ravel(), minlength=len(corners)) % 2))
    if loose or len(edges) == 0:
        raise InputError(f"expected closed lines, got {loose} loose ends in {len(edges)} segments; close the outline.")
    _refuse_crossings(corners, edges)
    return corners, edges


def _refuse_crossings(corners: Floats, edges: Ints) -> None:
    """Raise `InputError` when two segments cross between their ends."""
    a, b = corners[edges[:, 0]], corners[edges[:, 1]]
    for row in range(len(edges) - 1):
        c, d = a[row + 1 :], b[row + 1 :]
        apart = np.sign(_turn(a[row], b[row], c)) * np.sign(_turn(a[row], b[row], d)) < 0
        crossing = apart & (np.sign(_turn(c, d, a[row])) * np.sign(_turn(c, d, b[row])) < 0)
        if crossing.any():
            x, y = 0.5 * (a[row] + b[row])
            raise InputError(
                f"expected an outline that does not cross itself, got a segment near ({x:g}, {y:g}) that crosses "
                f"{int(crossing.sum())} others; split them where they cross."
            )


def _turn(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice the signed area of triangles, the sum's last bits being noise."""
    left, right = (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]), (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
    area = left - right
    return np.where(np.abs(area) <= 1e-14 * (np.abs(left) + np.abs(right)), 0, area)


def conform(mesh: Triangulation, corners: Floats, edges: Ints, tick: Tick = silent) -> Triangulation:
    """The Delaunay triangulation of the mesh's points, the outline's, and as many more as let it follow the outline.

    Strategy: triangulate, split every segment that is not an edge, repeat. A segment is split at a point that lies
    on it, if there is one; else near its middle, at a power of two from the outline's point it starts from, so that
    segments that meet at a sharp angle are cut at equal distances and do not push each other on for ever.
    """
    points, ids = _with_corners(mesh, corners)
    segments, n_given = ids[edges], len(points)
    starts = np.zeros(len(points), bool)
    starts[ids] = True
    for turn in range(ROUNDS):
        found = _triangulated(points, mesh)
        missing = ~_are_edges(found, segments)
        if not missing.any():
            return _with_origins(found, mesh)
        if len(points) > n_given * (1 + MOST_SPLITS):
            break
        points, split = _split(points, segments[missing], starts)
        starts = np.append(starts, np.zeros(len(points) - len(starts), bool))
        segments = np.concatenate([segments[~missing], split])
        tick(turn / ROUNDS)
    raise InputError(
        f"expected an outline that a triangulation can follow, got one with {int(missing.sum())} pieces left after "
        f"{len(points) - n_given} splits; points may lie too close to it: move or remove them."
    )


def _with_corners(mesh: Triangulation, corners: Floats) -> tuple[Floats, Ints]:
    """The mesh's points followed by the outline's that it does not have, and the ids of the outline's."""
    from scipy.spatial import cKDTree

    distance, ids = cKDTree(mesh.points).query(corners)
    fresh = distance > ROUNDINGS_APART * rounding(mesh.points)
    ids[fresh] = len(mesh.points) + np.arange(np.count_nonzero(fresh))
    return np.concatenate([mesh.points, corners[fresh]]), ids


def _triangulated(points: Floats, mesh: Triangulation) -> Triangulation:
    found = triangulate(points, engine=mesh.engine if mesh.engine in ENGINE_MODULES else "auto")
    if len(found.points) != len(points):
        raise EngineError("the engine left out points that lie almost on the outline; remove them.")
    return found


def _are_edges(mesh: Triangulation, segments: Ints) -> Bools:
    n = np.int64(len(mesh.points))
    ends = np.concatenate([mesh.simplices[:, [0, 1]], mesh.simplices[:, [1, 2]], mesh.simplices[:, [2, 0]]])
    low, high = ends.min(axis=1).astype(np.int64), ends.max(axis=1)
    return np.isin(segments.min(axis=1) * n + segments.max(axis=1), low * n + high)


def _split(points: Floats, segments: Ints, starts: Bools) -> tuple[Floats, Ints]:
    """Segments cut in two: all points, new ones last, and the pieces."""
    on_it = _points_on(points, segments)
    fresh = on_it < 0
    begin = np.where(starts[segments[:, 0]], segments[:, 0], segments[:, 1])
    end = segments.sum(axis=1) - begin
    side = points[end] - points[begin]
    length = np.sqrt((side**2).sum(axis=1))
    share = np.where(starts[begin], np.exp2(np.round(np.log2(0.5 * length))) / length, 0.5)
    middle = points[begin] + share[:, None] * side
    cut = on_it.copy()
    cut[fresh] = len(points) + np.arange(np.count_nonzero(fresh))
    pieces = np.concatenate([np.stack([begin, cut], axis=1), np.stack([cut, end], axis=1)])
    return np.concatenate([points, middle[fresh]]), pieces


def _points_on(points: Floats, segments: Ints) -> Ints:
    """(s,) a point that lies on each segment, the one nearest its middle, -1 where there is none."""
    from scipy.spatial import cKDTree

    tolerance = ROUNDINGS_APART * rounding(points)
    start, side = points[segments[:, 0]], points[segments[:, 1]] - points[segments[:, 0]]
    length = np.sqrt((side**2).sum(axis=1))
    around = cKDTree(points).query_ball_point(start + 0.5 * side, 0.5 * length, return_sorted=True)
    found = np.full(len(segments), -1)
    for row, ids in enumerate(around):
        others = np.setdiff1d(np.asarray(ids, np.intp), segments[row])
        offset = points[others] - start[row]
        off = np.abs(offset[:, 0] * side[row, 1] - offset[:, 1] * side[row, 0]) / length[row]
        on = others[off <= tolerance]
        if len(on):
            middle = start[row] + 0.5 * side[row]
            found[row] = on[np.argmin(((points[on] - middle) ** 2).sum(axis=1))]
    return found


def _with_origins(found: Triangulation, mesh: Triangulation) -> Triangulation:
    """The input's ids for the mesh's own points, -1 for the others."""
    n = len(mesh.points)
    origins = np.full(len(found.points), -1, np.int64)
    origins[:n] = mesh.original_ids if len(mesh.original_ids) == n else np.arange(n)
    own_map = mesh.point_map if len(mesh.point_map) else np.arange(n)
    return replace(found, original_ids=origins, point_map=own_map)


def even_odd(queries: Floats, corners: Floats, edges: Ints) -> Bools:
    """(q,) points with an odd number of (s, 2) segments to their right."""
    inside = np.zeros(len(queries), bool)
    a, b = corners[edges[:, 0]], corners[edges[:, 1]]
    a, b = np.where((a[:, 1] <= b[:, 1])[:, None], a, b), np.where((a[:, 1] <= b[:, 1])[:, None], b, a)

    def work(piece: slice) -> None:
        x, y = queries[piece].T[:, :, None]
        spans = (a[:, 1] <= y) & (y < b[:, 1])
        left = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0]) > 0
        inside[piece] = np.count_nonzero(spans & left, axis=1) % 2 == 1

    for_chunks(work, len(queries), chunk=max(1, (1 << 18) // len(edges)))
    return inside
