"""Skeletons of masks: Lantuejoul's morphological skeleton and the way back, thinning, and the ridge of the distance.

Outside of the grid there is nothing: a mask that touches the border of its grid ends there.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetraskel.errors import EngineError, InputError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.options import RasterOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class RasterSkeleton:
    """Grid points of a skeleton, in the order of the grid (last axis fastest).

    Attributes
    ----------
    indices : (k, d) int
        Place in the grid.
    points : (k, d) float
        origin + indices * spacing.
    radius : (k,) float
        Distance to the nearest grid point outside (`MaximumInscribedSphereRadius`), in the unit of the spacing.
    subset : (k,) int
        Number n of Lantuejoul's subset S_n: how often the mask can be eroded before the point goes (`Subset`). For the
        other methods -1.
    lines : (s, 2) int
        Neighbours, except diagonal ones that others join.
    shape : tuple of int
        Of the mask.
    spacing, origin : (d,) float
    method : str
    element : str
        What the mask was eroded with.
    """

    indices: Ints
    points: Floats
    radius: Floats
    subset: Ints
    lines: Ints
    shape: tuple[int, ...]
    spacing: Floats
    origin: Floats
    method: str
    element: str

    def __len__(self) -> int:
        return len(self.indices)


def raster_skeleton(
    mask: ArrayLike,
    *,
    method: str = RasterOptions.method,
    element: str = RasterOptions.element,
    ridge_slope: float = RasterOptions.ridge_slope,
    spacing: ArrayLike | None = None,
    origin: ArrayLike | None = None,
    tick: Tick = silent,
) -> RasterSkeleton:
    """The skeleton of a mask in the plane or in space.

    Parameters
    ----------
    mask : (nx, ny) or (nx, ny, nz) array
        Not 0 inside; one axis for each coordinate, in their order.
    method, element, ridge_slope
        See `RasterOptions`.
    spacing, origin : (d,) array or number, optional
        Grid point (i, j, k) lies at origin + (i, j, k) * spacing; 1 and 0.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Raises
    ------
    InputError
        For options out of bounds, a mask that is not 2D or 3D, is not of finite numbers or has nothing inside, or a
        spacing that is not positive.
    EngineError
        For thinning without scikit-image.

    Notes
    -----
    Lantuejoul (1978): S_n is what an opening takes from the n-th erosion. A point is in S_n just when its distance to
    the outside in steps of the structuring element is n + 1 and no neighbour's is larger, so one distance map and one
    maximum filter give all subsets.

    Examples
    --------
    >>> bar = np.ones((7, 3), bool)
    >>> found = raster_skeleton(bar)
    >>> found.indices[:, 1].tolist(), found.subset.tolist()
    ([1, 1, 1, 1, 1], [1, 1, 1, 1, 1])
    """
    RasterOptions(method=method, element=element, ridge_slope=ridge_slope)
    inside = _checked(mask)
    steps, start = _grid(inside.ndim, spacing, origin)
    distance = distance_map(inside, steps)
    tick(0.3)
    subset = np.full(inside.shape, -1, np.int32)
    if method == "morphological":
        subset = morphological_subsets(inside, element)
        chosen = subset >= 0
    elif method == "thinning":
        chosen = _thinned(inside, distance)
    else:
        chosen = _ridge(distance, steps, ridge_slope, tick)
    tick(0.8)
    indices = np.argwhere(chosen)
    at = tuple(indices.T)
    return RasterSkeleton(
        indices,
        start + indices * steps,
        distance[at],
        subset[at],
        _neighbours(chosen),
        inside.shape,
        steps,
        start,
        method,
        element,
    )


def _checked(mask: ArrayLike) -> Bools:
    """The mask as booleans."""
    given = np.asarray(mask)
    if given.ndim not in (2, 3):
        raise InputError(f"expected a mask with two or three axes, got shape {given.shape}.")
    if given.dtype.kind not in "biuf":
        raise InputError(f"expected a mask of numbers or booleans, got an array of type {given.dtype}.")
    if given.dtype.kind == "f" and not np.isfinite(given).all():
        raise InputError("expected finite numbers in the mask, got NaN or infinity; set them to 0 first.")
    inside = given != 0
    if not inside.any():
        raise InputError(f"expected a mask with something inside, got 0 at all of its {given.size} points.")
    return np.asarray(inside)


def _grid(dim: int, spacing: ArrayLike | None, origin: ArrayLike | None) -> tuple[Floats, Floats]:
    """Spacing and origin for each axis."""
    found = []
    for name, given, default in (("spacing", spacing, 1.0), ("origin", origin, 0.0)):
        values = np.asarray(default if given is None else given, dtype=float)
        if values.shape not in {(), (dim,)} or not np.isfinite(values).all():
            raise InputError(f"expected a {name} of {dim} finite numbers, got {given!r}.")
        found.append(np.broadcast_to(values, dim).copy())
    if (found[0] <= 0).any():
        raise InputError(f"expected a positive spacing, got {found[0].tolist()}.")
    return found[0], found[1]


def distance_map(inside: Bools, spacing: Floats) -> Floats:
    """Euclidean distance of each grid point to the nearest one outside; beyond the grid all is outside."""
    from scipy.ndimage import distance_transform_edt

    middle = (slice(1, -1),) * inside.ndim
    return np.asarray(distance_transform_edt(np.pad(inside, 1), sampling=spacing)[middle])


def morphological_subsets(inside: Bools, element: str = RasterOptions.element) -> NDArray[np.int32]:
    """Number of Lantuejoul's subset of each grid point, -1 where it is in none.

    Parameters
    ----------
    inside : bool array
    element : {"box", "cross"}
    """
    from scipy.ndimage import distance_transform_cdt, maximum_filter

    metric = "chessboard" if element == "box" else "taxicab"
    steps = distance_transform_cdt(np.pad(inside, 1), metric=metric).astype(np.int32)
    highest = maximum_filter(steps, footprint=structuring_element(inside.ndim, element))
    found = np.where((steps > 0) & (steps == highest), steps - 1, -1)
    return np.asarray(found[(slice(1, -1),) * inside.ndim], np.int32)


def structuring_element(dim: int, element: str) -> Bools:
    """The box of 3 grid points each way, or the cross within it."""
    from scipy.ndimage import generate_binary_structure

    return np.asarray(generate_binary_structure(dim, dim if element == "box" else 1))


def morphological_reversal(skeleton: RasterSkeleton, *, tick: Tick = silent) -> Bools:
    """The mask a morphological skeleton came from, exactly: the union of the subsets, S_n dilated n times.

    Raises
    ------
    InputError
        For a skeleton of another method: it does not hold the mask.
    """
    from scipy.ndimage import binary_dilation

    if skeleton.method != "morphological":
        raise InputError(
            f"expected a morphological skeleton, got one by {skeleton.method}, from which the mask does not come back."
        )
    mask = np.zeros(skeleton.shape, bool)
    structure = structuring_element(mask.ndim, skeleton.element)
    deepest = int(skeleton.subset.max(initial=-1))
    for n in range(deepest, -1, -1):
        tick(1 - (n + 1) / (deepest + 1))
        mask[tuple(skeleton.indices[skeleton.subset == n].T)] = True
        if n:
            mask = binary_dilation(mask, structure)
    return mask


def _thinned(inside: Bools, distance: Floats) -> Bools:
    """What is left when simple points are removed, by scikit-image.

    It takes away some pieces as a whole (cubes with an even number of points along each side): of those the deepest
    point is left.
    """
    from scipy.ndimage import label, maximum_position

    try:
        from skimage.morphology import skeletonize
    except ImportError as error:
        raise EngineError(
            "expected scikit-image for thinning, which cannot be imported; install tetraskel[raster], or use another "
            "method."
        ) from error
    middle = (slice(1, -1),) * inside.ndim
    thin = np.array((skeletonize(np.pad(inside, 1)) != 0)[middle])
    piece, n_pieces = label(inside, structuring_element(inside.ndim, "box"))
    lost = np.setdiff1d(np.arange(1, n_pieces + 1), piece[thin])
    for place in maximum_position(distance, piece, lost):
        thin[place] = True
    return thin


def _ridge(distance: Floats, spacing: Floats, slope: float, tick: Tick) -> Bools:
    """Points from which the distance grows towards no neighbour as it does up a flank.

    The corners of the stairs that a grid makes of a slanted border are none: points of the rim beside deeper ones.
    """
    padded = np.pad(distance, 1)
    ridge, on_rim = distance > 0, distance <= spacing.max()
    offsets = [offset for offset in product((-1, 0, 1), repeat=distance.ndim) if any(offset)]
    for k, offset in enumerate(offsets):
        tick(0.3 + 0.5 * k / len(offsets))
        length = float(np.sqrt(((np.array(offset) * spacing) ** 2).sum()))
        window = tuple(slice(1 + o, 1 + o + n) for o, n in zip(offset, distance.shape, strict=True))
        growth = padded[window] - distance
        ridge &= (growth < slope * length) & ~(on_rim & (growth > 0))
    return np.asarray(ridge)


def _neighbours(chosen: Bools) -> Ints:
    """Pairs of neighbours among the chosen grid points, ascending; diagonal ones that shorter steps join are not."""
    number = np.full(tuple(n + 2 for n in chosen.shape), -1, np.int64)
    number[(slice(1, -1),) * chosen.ndim][chosen] = np.arange(np.count_nonzero(chosen))
    here = np.argwhere(chosen) + 1
    found = []
    for offset in product((-1, 0, 1), repeat=chosen.ndim):
        if offset <= (0,) * chosen.ndim:
            continue
        there = number[tuple((here + offset).T)]
        joined = there >= 0
        for between in product(*({0, o} for o in offset)):
            if any(between) and between != offset:
                joined &= number[tuple((here + between).T)] < 0
        rows = np.flatnonzero(joined)
        found.append(np.stack([rows, there[rows]], axis=1))
    lines = np.concatenate(found)
    return lines[np.lexsort(lines.T[::-1])]
