"""How far a rebuilt surface is from the object it stands for, in percent of the object's diagonal."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.skeleton_surface import RebuiltSurface
from tetraskel.kernels.surface_rays import SURFACE_PAIRS, Surface, nearest_in_triangles, surface_of, surface_samples

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

SAMPLES = 10_000  # of a surface; more points than that are measured as they come
NEIGHBORS = (8, 64, 512)  # nearest triangles, by their middles, looked at before all are
SIZE_STEP = 3.0  # between the largest triangles of one size class and of the next
N_SIZES = 6


def surface_error(
    rebuilt: RebuiltSurface, points: ArrayLike, triangles: ArrayLike | None = None, *, tick: Tick = silent
) -> dict[str, float]:
    """Distances between a rebuilt surface and the object's own points, or its own surface.

    Parameters
    ----------
    rebuilt : RebuiltSurface
    points : (n, d) array
        On the surface of the object.
    triangles : (t, 3) int array, optional
        Of the object's surface; then the distances are those of places spread over both surfaces by area.

    Returns
    -------
    dict
        In percent of D, the diagonal of the box around `points`. `ErrorMean`, `ErrorMax`: from the object to the
        rebuilt surface. With triangles also `BackErrorMean`, `BackErrorMax`: from the rebuilt surface to the object,
        which tells of parts that stand out.

    Raises
    ------
    InputError
        When there is nothing to measure or the points do not fit the surface.
    """
    places = np.asarray(points, dtype=float)
    if places.ndim != 2 or places.shape[1] != rebuilt.points.shape[1]:
        raise InputError(
            f"expected points with {rebuilt.points.shape[1]} coordinates to compare with, got {places.shape}."
        )
    if len(places) == 0 or len(rebuilt) == 0:
        raise InputError(f"expected points and a surface to compare, got {len(places)} and {len(rebuilt)} points.")
    if not np.isfinite(places).all():
        raise InputError("expected finite points to compare with, got some with NaN or inf.")
    expect_extent(places)
    diagonal = float(np.sqrt((np.ptp(places, axis=0) ** 2).sum()))
    if diagonal == 0:
        raise InputError(f"expected points to compare with that are apart, got {len(places)} in one place.")
    mine = _triangles(rebuilt.points, rebuilt.simplices)
    if triangles is None:
        return _numbers("Error", distances(mine, _in_space(places), tick), diagonal)
    theirs = surface_of(places, np.asarray(triangles))
    there = distances(mine, surface_samples(theirs, SAMPLES), part(tick, 0.0, 0.5))
    back = distances(theirs, surface_samples(mine, SAMPLES), part(tick, 0.5, 1.0))
    return {**_numbers("Error", there, diagonal), **_numbers("BackError", back, diagonal)}


def _numbers(name: str, distance: Floats, diagonal: float) -> dict[str, float]:
    percent = 100 / diagonal * distance
    return {f"{name}Mean": float(percent.mean()), f"{name}Max": float(percent.max())}


def _in_space(points: Floats) -> Floats:
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _triangles(points: Floats, simplices: Ints) -> Surface:
    """Segments as triangles with two corners in one place."""
    return surface_of(_in_space(points), simplices if simplices.shape[1] == 3 else simplices[:, [0, 1, 1]])


def distances(surface: Surface, places: Floats, tick: Tick = silent) -> Floats:
    """(k,) exact distance from each place to a surface.

    Strategy: the triangles whose middles are nearest are tried first; none of the others can be nearer than the last
    of these middles less the largest reach of a triangle, and where that is not enough, more are tried. Triangles of
    different sizes are searched apart, so that a few large ones do not blur the bound of all.
    """
    found = np.full(len(places), np.inf)
    classes = _size_classes(surface.reaches)
    for number, rows in enumerate(classes):
        some = Surface(surface.corners[rows], surface.centres[rows], surface.reaches[rows])
        _improve(found, some, places)
        tick((number + 1) / len(classes))
    return found


def _size_classes(reaches: Floats) -> list[Ints]:
    """Rows of triangles of about one size, the most numerous first."""
    shrunk = np.log(np.maximum(reaches, 1e-300) / max(reaches.max(), 1e-300)) / np.log(1 / SIZE_STEP)
    size = np.clip(np.floor(shrunk), 0, N_SIZES - 1).astype(int)
    rows = [np.flatnonzero(size == k) for k in range(N_SIZES)]
    return sorted((some for some in rows if len(some)), key=len, reverse=True)


def _improve(found: Floats, surface: Surface, places: Floats) -> None:
    """Lower the distances in `found` to those to the triangles of `surface`."""
    cloud, farthest = Cloud(surface.centres), surface.reaches.max()
    unsure = np.arange(len(places))
    for k in [n for n in NEIGHBORS if n < cloud.n] + [cloud.n]:
        step, left = max(SURFACE_PAIRS // k // 4, 1), []
        for start in range(0, len(unsure), step):
            rows = unsure[start : start + step]
            away, which = (part.reshape(len(rows), k) for part in cloud.query(places[rows], k))
            near = away - farthest < found[rows][:, None]
            place, column = np.nonzero(near)
            nearest = nearest_in_triangles(places[rows][place], surface.corners[which[place, column]])
            np.minimum.at(found, rows[place], np.sqrt(((nearest - places[rows][place]) ** 2).sum(axis=1)))
            left.append(rows[away[:, -1] - farthest < found[rows]])
        unsure = np.concatenate([np.empty(0, np.int64), *left])
