"""The points a rank knows: its block, and what it was told of others' blocks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tetraskel.distributed.blocks import Block, affine_basis
from tetraskel.distributed.boxes import boxes_of_stretches, stretches_by_cells
from tetraskel.distributed.communicator import Communicator, Route
from tetraskel.errors import InputError
from tetraskel.kernels.exact.start import first_simplex
from tetraskel.kernels.points import MORTON_BITS

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

BOXES = 256  # about, around a rank's points, that all ranks know
SMALLEST_BOX = 8  # points


@dataclass(frozen=True)
class Known:
    """Points in the order of their places along the curve.

    Attributes
    ----------
    points : (n, 3) float
    place : (n,) int
        Place of each along the whole curve, increasing.
    names : (n, 4) int
        See `Block.names`.
    own : (n,) bool
        Whether it belongs to this rank's block.
    """

    points: Floats
    place: Ints
    names: Ints
    own: Bools

    def __len__(self) -> int:
        return len(self.place)

    @property
    def row(self) -> Ints:
        """(n,) row of each point in the serial mesh."""
        return np.asarray(self.names[:, 0])

    def kept(self, comm: Communicator) -> Known:
        """The same, to outlast exchanges."""
        points, place, names, own = comm.keep(self.points, self.place, self.names, self.own)
        return Known(points, place, names, own)

    def with_others(self, points: Floats, place: Ints, names: Ints) -> Known:
        """The same and points of other ranks; some may be known already."""
        new = np.flatnonzero(~np.isin(place, self.place))
        new = new[np.unique(place[new], return_index=True)[1]]
        order = np.argsort(np.concatenate([self.place, place[new]]), kind="stable")
        return replace(
            self,
            points=np.concatenate([self.points, points[new]])[order],
            place=np.concatenate([self.place, place[new]])[order],
            names=np.concatenate([self.names, names[new]])[order],
            own=np.concatenate([self.own, np.zeros(len(new), bool)])[order],
        )


@dataclass(frozen=True)
class Boxes:
    """Boxes around stretches of a block.

    Attributes
    ----------
    corners : (k, 6) float
        Lowest and highest corner of each.
    widths : (k,) float
        How far around each box points are taken to be neighbours. A guess: what is missing is asked for later.
    starts : (k+1,) int
        Where the points of each begin, and the number of points.
    """

    corners: Floats
    widths: Floats
    starts: Ints


def known_at_first(comm: Communicator, block: Block, own: Boxes, wide: list[Floats]) -> Known:
    """The block, points of others near its boxes, and a few points that span space.

    Parameters
    ----------
    wide : for each rank (k, 6)
        Its boxes, made larger by what it takes for its neighbourhood.
    """
    known = Known(block.points, block.place, block.names, np.ones(len(block), bool))
    wanted = []
    for rank in range(comm.size):
        near = np.zeros(len(block), bool)
        if rank != comm.rank:
            near = _near(block.points, own, wide[rank])
        wanted.append(np.flatnonzero(near))
    basis = affine_basis(block.points)
    wanted = [np.union1d(rows, basis) if rank != comm.rank else rows for rank, rows in enumerate(wanted)]
    known = known.with_others(*told(comm, block, wanted)).kept(comm)
    spans = comm.lowest(np.array([len(block) == 0 or first_simplex(known.points) is not None]))
    if not spans.all():
        raise InputError("expected points that fill space, got points of one plane; use one rank.")
    return known


def told(comm: Communicator, block: Block, rows: list[Ints]) -> tuple[Floats, Ints, Ints]:
    """Send the block's `rows[k]` to rank k: coordinates, places and names of what was sent here."""
    route = Route(comm, np.repeat(np.arange(comm.size), [len(wanted) for wanted in rows]))
    chosen = np.concatenate(rows).astype(np.int64)
    return (
        route.forward(block.points[chosen]),
        route.forward(block.place[chosen]),
        route.forward(block.names[chosen]),
    )


def boxes_of_block(block: Block) -> Boxes:
    """Boxes around stretches of the block.

    The guess is twice the distance of as many points that fill the octree's cell; few points in a cell, which may only
    touch it, are not taken for sparse ones.
    """
    length = max(SMALLEST_BOX, len(block) // BOXES)
    starts, levels = stretches_by_cells(block.codes, length, MORTON_BITS[3])
    counts = np.maximum(np.diff(starts), length / 8)
    widths = 2 * np.ldexp(block.extent, -levels) / np.cbrt(counts)
    return Boxes(boxes_of_stretches(block.points, starts), widths, starts)


def _near(points: Floats, own: Boxes, wide: Floats) -> Bools:
    """(n,) points in one of the (k, 6) boxes; only boxes that meet that of a point's stretch are looked at."""
    near = np.zeros(len(points), bool)
    for corners, start, stop in zip(own.corners, own.starts[:-1], own.starts[1:], strict=True):
        met = wide[(wide[:, :3] <= corners[3:]).all(axis=1) & (wide[:, 3:] >= corners[:3]).all(axis=1)]
        if len(met):
            stretch = points[start:stop, None]
            near[start:stop] = ((stretch >= met[:, :3]) & (stretch <= met[:, 3:])).all(axis=2).any(axis=1)
    return near
