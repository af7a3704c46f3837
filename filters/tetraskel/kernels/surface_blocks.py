"""Where the surface of round cones runs on a grid: small blocks of cells, each with the few cones that matter in it.

Only these blocks are ever evaluated, so neither time nor memory grows with the volume of the grid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.round_cones import RoundCones, nearest_along, on_lattices

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

SIDE = 2  # cells along a block
SLACK = 1e-6  # of a block's half diagonal: what rounding may do to a bound


@dataclass(frozen=True)
class Grid:
    """Places origin + spacing * (i, j, k).

    Attributes
    ----------
    origin : (d,) float
    spacing : float
    shape : (d,) int
        Number of places along each axis, one more than a multiple of the block's side.
    """

    origin: Floats
    spacing: float
    shape: Ints


@dataclass(frozen=True)
class Blocks:
    """Blocks the surface may run through.

    Attributes
    ----------
    corner : (n, d) int
        Lowest place of each block on the grid.
    offsets : (n+1,) int
        Where the cones of each block begin in `cones`.
    cones : (...) int
        Cones that may be nearest somewhere in the block.
    """

    corner: Ints
    offsets: Ints
    cones: Ints

    def __len__(self) -> int:
        return len(self.corner)


def grid_around(low: Floats, high: Floats, spacing: float) -> Grid:
    """A grid over a box with at least a cell to spare all around; a grid twice as fine has its places among its own.

    The middle of the box is the middle of the grid: a mirrored object has the mirrored surface.
    """
    n_blocks = np.ceil((high - low) / spacing / SIDE + 2 / SIDE).astype(np.int64)
    origin = 0.5 * (low + high) - 0.5 * SIDE * spacing * n_blocks
    return Grid(origin, spacing, SIDE * n_blocks + 1)


def surface_blocks(cones: RoundCones, grid: Grid, tick: Tick = silent) -> Blocks:
    """The blocks near the surface of the union of `cones`.

    Strategy: halve boxes from one that holds the whole grid. The distance at the middle of a box tells whether the
    surface can run through it, for it changes by at most the half diagonal; and a cone that is farther than the
    nearest one by twice that is nearest nowhere in the box.
    """
    dim = len(grid.shape)
    levels = int(np.ceil(np.log2(max(int(grid.shape.max() - 1) // SIDE, 1))))
    boxes = Blocks(np.zeros((1, dim), np.int64), np.array([0, len(cones)]), np.arange(len(cones)))
    for level in range(levels, -1, -1):
        side = SIDE << level
        reach = 0.5 * np.sqrt(dim) * side * grid.spacing * (1 + SLACK)
        middle = grid.origin + grid.spacing * (boxes.corner + 0.5 * side)
        boxes = _kept(cones, middle, reach, boxes)
        if level:
            boxes = _halved(boxes, side // 2)
        tick((levels - level + 1) / (levels + 1))
    return _sharpened(cones, grid, boxes)


def _kept(cones: RoundCones, middle: Floats, reach: float, boxes: Blocks) -> Blocks:
    """Boxes the surface may run through, with the cones that may be nearest in each."""
    sizes = np.diff(boxes.offsets)
    distance, _ = nearest_along(cones, np.repeat(middle.T, sizes, axis=1), boxes.cones)
    least = np.minimum.reduceat(distance, boxes.offsets[:-1])
    stays = np.abs(least) <= reach
    bound = np.where(stays, least + 2 * reach, -np.inf)
    matters = distance <= np.repeat(bound, sizes)
    left = np.add.reduceat(matters, boxes.offsets[:-1])[stays]
    return Blocks(boxes.corner[stays], np.concatenate([[0], np.cumsum(left)]), boxes.cones[matters])


def _sharpened(cones: RoundCones, grid: Grid, blocks: Blocks) -> Blocks:
    """Blocks without the cones that a nearer one hides in all of the block.

    Each distance is a convex function: it lies above its tangent at the middle. The nearest one's bends away from its
    tangent by at most half the squared way over the distance to the ball's centre, the radius of its level surface.
    """
    sizes = np.diff(blocks.offsets)
    reach = 0.5 * np.sqrt(len(grid.shape)) * SIDE * grid.spacing * (1 + SLACK)
    middle = np.repeat((grid.origin + grid.spacing * (blocks.corner + 0.5 * SIDE)).T, sizes, axis=1)
    distance, along = nearest_along(cones, middle, blocks.cones)
    away = middle - cones.start[blocks.cones].T - along * cones.axis[blocks.cones].T
    far = np.sqrt((away * away).sum(axis=0))
    away /= np.maximum(far, 1e-300)
    least = np.minimum.reduceat(distance, blocks.offsets[:-1])
    best = np.flatnonzero(distance == np.repeat(least, sizes))
    best = best[np.searchsorted(best, blocks.offsets[:-1])]
    turn = away - np.repeat(away[:, best], sizes, axis=1)
    bend = reach * reach / (2 * np.maximum(far[best] - reach, SLACK * reach))
    slack = np.repeat(bend + SLACK * reach, sizes)
    matters = distance - np.repeat(least, sizes) <= reach * np.sqrt((turn * turn).sum(axis=0)) + slack
    left = np.add.reduceat(matters, blocks.offsets[:-1])
    return Blocks(blocks.corner, np.concatenate([[0], np.cumsum(left)]), blocks.cones[matters])


def _halved(boxes: Blocks, side: int) -> Blocks:
    """The 2**d halves of each box, each with all its cones."""
    dim = boxes.corner.shape[1]
    parts = 1 << dim
    shifts = side * (np.arange(parts)[:, None] >> np.arange(dim) & 1)
    sizes = np.repeat(np.diff(boxes.offsets), parts)
    begins = np.concatenate([[0], np.cumsum(sizes)])
    rank = np.arange(begins[-1]) - np.repeat(begins[:-1] - np.repeat(boxes.offsets[:-1], parts), sizes)
    return Blocks((boxes.corner[:, None] + shifts).reshape(-1, dim), begins, boxes.cones[rank])


def block_values(cones: RoundCones, grid: Grid, blocks: Blocks, some: slice) -> Floats:
    """(SIDE+1, ..., SIDE+1, k) signed distance at the places of consecutive blocks, those on their sides among them."""
    corner, offsets = blocks.corner[some], blocks.offsets[some.start : some.stop + 1]
    which = blocks.cones[offsets[0] : offsets[-1]]
    places = corner.T[:, None] + np.arange(SIDE + 1)[:, None]  # (d, SIDE+1, k)
    ticks = np.repeat(grid.origin[:, None, None] + grid.spacing * places, np.diff(offsets), axis=2)
    return np.minimum.reduceat(on_lattices(cones, which, ticks), offsets[:-1] - offsets[0], axis=-1)
