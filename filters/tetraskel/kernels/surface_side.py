"""Which side of a closed surface: simplices whose barycentre the surface winds around.

By the generalised winding number, because it stays right beside small holes and overlaps. VTK's point-in-surface
tests do not: vtkSelectEnclosedPoints shoots rays, which a hole lets out, and vtkImplicitPolyDataDistance asks the
nearest triangle's normal, which is nobody's near a hole.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.mesh import Triangulation
from tetraskel.kernels.winding import winding_numbers

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

LARGEST_HOLE = 0.1  # of the surface's diagonal, across: the winding number beside it is still on the right side of 1/2


def inside_by_surface(mesh: Triangulation, points: ArrayLike, triangles: ArrayLike, *, tick: Tick = silent) -> Bools:
    """(m,) tetrahedra whose barycentre lies inside a closed surface.

    Parameters
    ----------
    mesh : Triangulation
        Of tetrahedra.
    points : (n, 3) array
    triangles : (t, 3) array of point ids
        Counter-clockwise as seen from outside; several closed surfaces are one, a cavity's turned inwards.

    Raises
    ------
    InputError
        For a mesh of triangles, a surface that is open (holes up to 10 % of its diagonal across are tolerated),
        not consistently oriented, or inside out.
    """
    if mesh.dim != 3:
        raise InputError("expected tetrahedra to tell apart by a surface, got triangles; use an outline.")
    corners, faces = checked_surface(points, triangles)
    barycentres = mesh.points[mesh.simplices].mean(axis=1)
    return np.asarray(winding_numbers(barycentres, corners, faces, tick) > 0.5)


def checked_surface(points: ArrayLike, triangles: ArrayLike) -> tuple[Floats, Ints]:
    """A surface that encloses something, equal points merged and triangles without area dropped, moved nowhere."""
    corners, faces = np.asarray(points, dtype=np.float64), np.asarray(triangles)
    if faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0 or corners.ndim != 2 or corners.shape[1] != 3:
        raise InputError(f"expected a surface of triangles in space, got arrays {corners.shape} and {faces.shape}.")
    if not np.isfinite(corners).all():
        raise InputError("expected a surface with finite coordinates, got NaN or infinity.")
    expect_extent(corners)
    if not 0 <= faces.min() <= faces.max() < len(corners):
        raise InputError(f"expected point ids from 0 to {len(corners) - 1}, got {faces.min()} to {faces.max()}.")
    corners, merged = np.unique(corners, axis=0, return_inverse=True)
    faces = merged.reshape(-1)[faces]
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    _refuse_open(corners, faces)
    moved = corners - corners.mean(axis=0)
    volume = (moved[faces[:, 0]] * np.cross(moved[faces[:, 1]], moved[faces[:, 2]])).sum()
    if volume <= 0:
        raise InputError("expected triangles that face outwards, got a surface that is inside out; reverse its faces.")
    return corners, faces


def _refuse_open(corners: Floats, faces: Ints) -> None:
    """Raise `InputError` when edges have no counterpart, unless these bound small holes."""
    low, high, turns = _unbalanced_edges(faces, len(corners))
    if len(low) == 0:
        return
    twisted = int(np.count_nonzero(np.abs(turns) > 1))
    if twisted:
        raise InputError(
            f"expected neighbouring triangles turned alike, got {twisted} edges that both sides run along in one "
            "direction; orient the surface consistently."
        )
    diagonal = float(np.linalg.norm(np.ptp(corners, axis=0)))
    across = max(np.linalg.norm(np.ptp(corners[hole], axis=0)) for hole in _holes(low, high))
    if across > LARGEST_HOLE * diagonal:
        raise InputError(
            f"expected a closed surface, got {len(low)} open edges, around a hole of {across / diagonal:.0%} of the "
            f"diagonal (up to {LARGEST_HOLE:.0%} is tolerated); close it, or use method 'gates'."
        )


def _unbalanced_edges(faces: Ints, n: int) -> tuple[Ints, Ints, Ints]:
    """Edges run along more often one way than the other: their ends, and by how much."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys, edge_of = np.unique(np.minimum(start, end) * np.int64(n) + np.maximum(start, end), return_inverse=True)
    turns = np.bincount(edge_of.reshape(-1), np.where(start < end, 1, -1), len(keys)).astype(np.int64)
    low, high = np.divmod(keys[turns != 0], n)
    return low, high, turns[turns != 0]


def _holes(low: Ints, high: Ints) -> list[Ints]:
    """Point ids of each connected group of edges."""
    ids, ends = np.unique(np.concatenate([low, high]), return_inverse=True)
    first, second = ends.reshape(2, -1)
    label = np.arange(len(ids))
    while True:
        least = label.copy()
        np.minimum.at(least, first, label[second])
        np.minimum.at(least, second, label[first])
        least = least[least]
        if np.array_equal(least, label):
            return [ids[label == one] for one in np.unique(label)]
        label = least
