"""Cubic splines with continuous curvature over any breaks, open or closed, and their Bezier pieces.

Basis by the recurrence of Cox and de Boor, Bezier points by blossoming (Ramshaw 1987).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

ORDER = 4


@dataclass(frozen=True)
class SplineSpace:
    """Cubic splines on [0, 1] with m pieces.

    Attributes
    ----------
    breaks : (m+1,) float
        Where the pieces meet, from 0 to 1, increasing.
    closed : bool
        The end goes on into the beginning.
    """

    breaks: Floats
    closed: bool

    @property
    def n_pieces(self) -> int:
        """Number of pieces."""
        return len(self.breaks) - 1

    @property
    def size(self) -> int:
        """Number of control points."""
        return self.n_pieces + (0 if self.closed else 3)

    @property
    def knots(self) -> Floats:
        """(m+7,) breaks and three more on either side: repeated at open ends, those of the next turn at closed ones."""
        if not self.closed:
            return np.concatenate([[0, 0, 0], self.breaks, [1, 1, 1]])
        turn, place = np.divmod(np.arange(-3, self.n_pieces + 4), self.n_pieces)
        return turn + self.breaks[place]

    @property
    def middles(self) -> Floats:
        """(size,) where each control point belongs (Greville abscissae), in [0, 1]."""
        knots = self.knots
        places = (knots[1:-3] + knots[2:-2] + knots[3:-1])[: self.size] / 3
        return places % 1 if self.closed else places

    def piece_of(self, at: Floats) -> Ints:
        """(n,) piece each parameter lies on."""
        return np.clip(np.searchsorted(self.breaks, at, side="right") - 1, 0, self.n_pieces - 1)

    def columns(self, piece: Ints) -> Ints:
        """(n, 4) control points that matter on each piece."""
        found = piece[:, None] + np.arange(ORDER)
        return found % self.size if self.closed else found

    def weights(self, at: Floats, piece: Ints) -> Floats:
        """(n, 4) what each of these control points counts at each parameter."""
        knots = self.knots
        values = np.zeros((ORDER, len(at)))
        values[0] = 1
        for degree in range(1, ORDER):
            carried = np.zeros(len(at))
            for k in range(degree):
                right, left = knots[piece + ORDER + k], knots[piece + ORDER + k - degree]
                part = values[k] / (right - left)
                values[k] = carried + (right - at) * part
                carried = (at - left) * part
            values[degree] = carried
        return values.T

    def pieces(self, control: Floats) -> Floats:
        """(m, 4, D) Bezier points of the pieces, from (size, D) control points."""
        piece = np.arange(self.n_pieces)
        local = control[self.columns(piece)]
        low, high = self.breaks[:-1], self.breaks[1:]
        points = [self._blossom(local, [low] * (3 - k) + [high] * k) for k in range(ORDER)]
        return np.stack(points, axis=1)

    def _blossom(self, local: Floats, at: list[Floats]) -> Floats:
        """(m, D) polar form of each piece for three arguments of (m,)."""
        knots, piece = self.knots, np.arange(self.n_pieces)
        points = [local[:, k] for k in range(ORDER)]
        for rank, argument in enumerate(at, 1):
            for k in range(ORDER - 1, rank - 1, -1):
                low, high = knots[piece + k], knots[piece + k + ORDER - rank]
                share = ((argument - low) / (high - low))[:, None]
                points[k] = (1 - share) * points[k - 1] + share * points[k]
        return points[-1]


def bezier_at(pieces: Floats, share: Floats) -> Floats:
    """(4, n, D) place and first three derivatives of cubic pieces (n, 4, D) at local parameters (n,) in [0, 1]."""
    s = share[:, None]
    found = []
    points, factor = pieces, 1.0
    for order in range(ORDER):
        degree = ORDER - 1 - order
        row = points
        for _ in range(degree):  # de Casteljau
            row = (1 - s)[:, :, None] * row[:, :-1] + s[:, :, None] * row[:, 1:]
        found.append(factor * row[:, 0])
        points, factor = np.diff(points, axis=1), factor * max(degree, 1)
    return np.stack(found)
