"""An octree (of the plane a quadtree) that is as deep as it was divided, and which of its leaves points lie in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.voronoi_lines import found_in

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DEEPEST = 20  # levels: names of leaves have 61 bits
WITHIN = 10  # bits of a place in a leaf


class Located(NamedTuple):
    """Where (k, d) points lie.

    Attributes
    ----------
    leaf : (k,) int
    octant : (k,) int
        Of the leaf.
    away : (k,) float
        Square of the distance from the leaf's middle.
    within : (k, d) int
        Place in the leaf, of 2 to the power of `WITHIN` along each axis.
    """

    leaf: Ints
    octant: Ints
    away: Floats
    within: Ints


@dataclass(frozen=True)
class Octree:
    """Cells of a cube, halved along every axis.

    A cell is named by the octants on the way to it, from a leading 1 on: the sons of cell c are 8 c to 8 c + 7 (of the
    plane 4 c to 4 c + 3).

    Attributes
    ----------
    low : (d,) float
    side : float
        Of the cube.
    base : int
        Level down to which every cell is divided.
    divided : tuple of (k,) int
        Cells of level base, base + 1 and so on that are divided further, ascending.
    """

    low: Floats
    side: float
    base: int
    divided: tuple[Ints, ...] = ()

    @property
    def dim(self) -> int:
        """Dimension of the space."""
        return len(self.low)

    def located(self, points: Floats) -> Located:
        """The leaf that each of the (k, d) points lies in, and where there."""
        steps = self._steps(points)
        leaf = np.ones(len(points), np.int64)
        for level in range(1, self.base + 1):
            leaf = (leaf << self.dim) | _octants(steps, level)
        todo = np.arange(len(points))
        for level, divided in enumerate(self.divided, self.base + 1):
            todo = todo[found_in(leaf[todo], divided)]
            leaf[todo] = (leaf[todo] << self.dim) | _octants(steps[todo], level)
        depth = self.levels(leaf)
        below = (DEEPEST - depth)[:, None]
        cell = np.right_shift(steps, below)
        away = points - (self.low + (cell + 0.5) * self.sides(leaf)[:, None])
        within = np.right_shift((steps - np.left_shift(cell, below)) << WITHIN, below)
        octant = _octants(steps, np.minimum(depth + 1, DEEPEST))
        return Located(leaf, octant, np.asarray((away**2).sum(axis=1)), within)

    def _steps(self, points: Floats) -> Ints:
        """(k, d) places in cells of the deepest level."""
        most = 1 << DEEPEST
        return np.minimum((points - self.low) / self.side * most, most - 1).astype(np.int64)

    def levels(self, leaf: Ints) -> Ints:
        """(k,) how often the cube was halved to each leaf."""
        level = np.full(len(leaf), self.base, np.int64)
        for deeper in range(self.base + 1, self.base + len(self.divided) + 1):
            level += leaf >= (1 << (self.dim * deeper))
        return level

    def sides(self, leaf: Ints) -> Floats:
        """(k,) side of each leaf."""
        return np.asarray(np.ldexp(self.side, -self.levels(leaf)))

    def with_divided(self, leaf: Ints) -> Octree:
        """The tree in which these leaves are divided, too."""
        level = self.levels(leaf)
        divided = [*self.divided, np.empty(0, np.int64)]
        for k in range(len(divided)):
            divided[k] = np.union1d(divided[k], leaf[level == self.base + k])
        return Octree(self.low, self.side, self.base, tuple(cells for cells in divided if len(cells)))


def _octants(steps: Ints, level: int | Ints) -> Ints:
    """(k,) the octant of a cell of the level above in which each place lies, the first axis first."""
    octant = np.zeros(len(steps), np.int64)
    for column in steps.T:
        octant = (octant << 1) | ((column >> (DEEPEST - level)) & 1)
    return octant
