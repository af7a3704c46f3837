"""An object that is a union of simplices as a mask: the points of a grid that lie in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import InputError
from tetraskel.kernels.barycentric import barycentric_frames, is_solid
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.extent import expect_extent
from tetraskel.kernels.interior import inside_by_labels
from tetraskel.kernels.mesh import Triangulation, expect_mesh
from tetraskel.options import RasterInputOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

LINES = 1 << 18  # grid lines at a time
ON_FACET = 1e-9  # barycentric: a grid point between two simplices must not fall through


@dataclass(frozen=True)
class Mask:
    """Grid points that are inside.

    Attributes
    ----------
    values : (nx, ny) or (nx, ny, nz) bool
        One axis for each coordinate, in their order.
    spacing, origin : (d,) float
        Grid point (i, j, k) lies at origin + (i, j, k) * spacing.
    """

    values: Bools
    spacing: Floats
    origin: Floats


def rasterise(
    mesh: Triangulation,
    *,
    inside: ArrayLike | None = None,
    resolution: int = RasterInputOptions.resolution,
    tick: Tick = silent,
) -> Mask:
    """The object as a mask.

    Strategy: on a line of the grid along x a simplex covers an interval; its first grid point counts one up, the one
    behind its last one down, and a running sum along x tells who is covered.

    Parameters
    ----------
    mesh : Triangulation
    inside : (m,) array, optional
        Simplices of the object: those that are not 0. Without it all of them.
    resolution : int
        Grid points along the longest side of the box of the object.

    Raises
    ------
    InputError
        When nothing is inside, what is has no size, labels do not fit, the resolution is out of bounds, or so low that
        no point of the grid lies in the object.
    """
    RasterInputOptions(resolution=resolution)
    expect_mesh(mesh)
    expect_extent(mesh.points)
    labels = np.ones(len(mesh), bool) if inside is None else inside_by_labels(len(mesh), inside)
    cells = mesh.simplices[labels]
    if len(cells) == 0:
        raise InputError(f"expected an object with an inside, got none of {len(mesh)} cells inside; label some.")
    x = mesh.coordinates
    low, high = x[cells].min(axis=(0, 1)), x[cells].max(axis=(0, 1))
    if not (high > low).any():
        raise InputError(
            f"expected an object of some size, got {len(cells)} cells inside that are all in one place; label others."
        )
    step = float((high - low).max()) / (resolution - 1)
    shape = np.floor((high - low) / step + ON_FACET).astype(np.int64) + 1
    ends = np.zeros((shape[0] + 1, int(np.prod(shape[1:]))), np.int32)
    first, last = _ranges((x[cells] - low) / step, shape)
    counts = np.maximum(last[:, 1:] - first[:, 1:] + 1, 0).prod(axis=1)
    starts = np.searchsorted(np.cumsum(counts), np.arange(0, counts.sum(), LINES), side="left")
    for start, stop in zip(starts, np.append(starts[1:], len(cells)), strict=True) if len(starts) else ():
        tick(start / len(cells))
        if stop > start:
            _cover(ends, (x[cells[start:stop]] - low) / step, first[start:stop], last[start:stop], shape)
    values = np.cumsum(ends, axis=0)[:-1] > 0
    if not values.any():
        raise InputError(
            f"expected an object that holds points of the grid, got one between those of a resolution of {resolution}; "
            "raise it."
        )
    return Mask(values.reshape(shape), np.full(mesh.dim, step), low)


def _ranges(corners: Floats, shape: Ints) -> tuple[Ints, Ints]:
    """First and last grid index of each simplex along each axis."""
    first = np.ceil(corners.min(axis=1) - ON_FACET).astype(np.int64)
    last = np.floor(corners.max(axis=1) + ON_FACET).astype(np.int64)
    return np.maximum(first, 0), np.minimum(last, shape - 1)


def _cover(ends: Ints, corners: Floats, first: Ints, last: Ints, shape: Ints) -> None:
    """Count the simplices, given in grid units, up and down on their lines, in place."""
    sizes = np.maximum(last[:, 1:] - first[:, 1:] + 1, 0)
    counts = sizes.prod(axis=1)
    cell = np.repeat(np.arange(len(corners)), counts)
    number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    y = first[cell, 1] + number % sizes[cell, 0]
    line, places = y, [y]
    if corners.shape[2] == 3:
        z = first[cell, 2] + number // sizes[cell, 0]
        line, places = y * shape[2] + z, [y, z]
    low, high = _intervals(corners, cell, np.stack(places, axis=1).astype(float))
    start = np.clip(np.ceil(low - ON_FACET), 0, shape[0]).astype(np.int64)  # at the end of the line: nothing
    stop = np.clip(np.floor(high + ON_FACET), -1, shape[0] - 1).astype(np.int64)
    kept = start <= stop
    np.add.at(ends, (start[kept], line[kept]), 1)
    np.add.at(ends, (stop[kept] + 1, line[kept]), -1)


def _intervals(corners: Floats, cell: Ints, places: Floats) -> tuple[Floats, Floats]:
    """Where on the line along x at each place the simplex begins and ends; begins after it ends where it is missed."""
    n, width = len(corners), corners.shape[1]
    flat = np.arange(n * width).reshape(n, width)
    origin, normals, volumes = barycentric_frames(corners.reshape(-1, width - 1), flat)
    volumes[~is_solid(corners.reshape(-1, width - 1), flat, volumes)] = 0
    rows = normals / np.where(volumes == 0, 1.0, volumes)[:, None, None]
    rows = np.concatenate([-rows.sum(axis=1, keepdims=True), rows], axis=1)  # gradients of barycentric coordinates
    offset = np.einsum("ka,kia->ki", -origin, rows)
    offset[:, 0] += 1
    low, high = corners[:, :, 0].min(axis=1)[cell], corners[:, :, 0].max(axis=1)[cell]
    high = np.where(volumes[cell] == 0, -np.inf, high)
    for i in range(width):
        slope = rows[cell, i, 0]
        value = offset[cell, i] + (rows[cell, i, 1:] * places).sum(axis=1) + ON_FACET
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            place = -value / slope
        low = np.where(slope > 0, np.maximum(low, place), low)
        high = np.where(slope < 0, np.minimum(high, place), high)
        high = np.where((slope == 0) & (value < 0), -np.inf, high)
    return low, np.maximum(high, -1e9)
