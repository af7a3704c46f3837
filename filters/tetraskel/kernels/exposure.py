"""How far the end of a path pokes out of what is drawn, and what that is worth: one number per end.

Measured twice: out of the balls, and out of balls as wide as the sheet is. What pokes out of the balls alone is an
edge of a plate, not a limb, and counts for details only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FINEST = 0.015  # significance below which no branch is looked for
SAMPLE = 0.25  # balls this far apart, in radii, stand for a path
# A bump is judged by how far it pokes out in diagonals of the object, a limb also by its own slenderness: beyond
# this ratio of distance to cover it counts for more, so that the twigs of a large tree are branches too.
ALONE = 0.25  # an end farther than this from all others, in diagonals, is no more alone
SLENDER = 2.5
SLENDER_POWER = 4
# What counts as covered, as a share of the way from the ball to the width of the sheet: nothing but the ball for the
# edges of plates, most of the sheet for limbs. An edge counts for this share of a limb, and at most so much.
SHEETS = (0.0, 0.85)
EDGE, EDGE_LIMIT = 0.6, 0.055
BUMP = (1.05, 1.2)  # ratio of distance to cover: below the first it is nothing, from the second on it counts in full


@dataclass(frozen=True)
class Balls:
    """Nodes as the growth sees them: positions (m, d), radii (m,), and burn times (m,), at least the radii."""

    positions: Floats
    radii: Floats
    burn: Floats

    def covers(self, nodes: Ints) -> Floats:
        """(2, k) radii that count as covered: the ball, and most of the sheet."""
        radii, burn = self.radii[nodes], self.burn[nodes]
        return np.stack([radii + sheet * (burn - radii) for sheet in SHEETS])


class Exposure:
    """How far each of some ends pokes out of all that is drawn (`excess`), and its distance in covers (`ratio`).

    Both are (2, k): out of the balls, and out of the sheets. `alone` (k,) is the distance to the nearest end drawn.
    """

    def __init__(self, balls: Balls, ends: Ints) -> None:
        self.balls, self.ends = balls, ends
        self.alone = np.full(len(ends), np.inf)
        self.excess = np.full((2, len(ends)), np.inf)
        self.ratio = np.full((2, len(ends)), np.inf)

    def cover(self, nodes: Ints) -> None:
        """Draw balls at more nodes."""
        balls, nodes = self.balls, thinned(self.balls, nodes)
        places, radii = balls.positions[self.ends], balls.radii[self.ends]
        for start in range(0, len(nodes), 64):
            some = nodes[start : start + 64]
            away = distances(places, balls.positions[some])
            for row, covers in enumerate(balls.covers(some)):
                np.minimum(self.excess[row], (away - covers).min(axis=1) + radii, out=self.excess[row])
                np.minimum(self.ratio[row], in_covers(away, covers).min(axis=1), out=self.ratio[row])

    def drop_covered(self, diagonal: float) -> Floats:
        """Forget the ends that are of no significance, for good; significance of the others, which never grows."""
        values = significance(self.excess, self.ratio, self.alone, diagonal)
        alive = values >= FINEST
        self.ends, self.alone = self.ends[alive], self.alone[alive]
        self.excess, self.ratio = self.excess[:, alive], self.ratio[:, alive]
        return np.asarray(values[alive])

    def add_end(self, node: int) -> None:
        """Draw an end."""
        away = self.balls.positions[self.ends] - self.balls.positions[node]
        np.minimum(self.alone, np.sqrt((away**2).sum(axis=1)), out=self.alone)


def significance(excess: Floats, ratio: Floats, alone: Floats, diagonal: float) -> Floats:
    """(k,) what ends are worth, from (2, k) excess and ratio and the distance (k,) to the next end.

    The geometric mean of how far an end pokes out and how far the next one is, in diagonals: a person draws the lone
    tail before the second finger of a hand.
    """
    bump = np.clip((ratio - BUMP[0]) / (BUMP[1] - BUMP[0]), 0, 1)
    poking = np.sqrt(np.maximum(excess, 0) / diagonal * np.minimum(alone / diagonal, ALONE))
    edge, limb = poking * bump * np.maximum(1, ratio / SLENDER) ** SLENDER_POWER
    return np.asarray(np.maximum(limb, np.minimum(EDGE * edge, EDGE_LIMIT)))


def in_covers(away: Floats, covers: Floats) -> Floats:
    """Distances in covers; a ball without radius covers its own place only."""
    ratio = np.where(away > 0, np.inf, 0.0)
    return np.divide(away, covers, out=ratio, where=covers > 0)


def thinned(balls: Balls, path: Ints, apart: float = SAMPLE) -> Ints:
    """Nodes of a path about a quarter radius (or `apart` radii) apart, both ends among them."""
    if len(path) < 3:
        return path
    return path[thinned_places(balls, path, apart)]


def thinned_places(balls: Balls, path: Ints, apart: float) -> Ints:
    """Where in a path of at least three nodes the nodes of `thinned` are."""
    step = np.sqrt((np.diff(balls.positions[path], axis=0) ** 2).sum(axis=1))
    scaled = np.cumsum(np.append(0, step / (apart * np.maximum(balls.radii[path[1:]], 1e-300))))
    chosen = np.append(True, np.floor(scaled[1:]) > np.floor(scaled[:-1]))
    chosen[-1] = True
    return np.flatnonzero(chosen)


def distances(first: Floats, second: Floats) -> Floats:
    """(k, l) distances from each of (k, d) places to each of (l, d) others, one axis after another."""
    total = np.zeros((len(first), len(second)))
    for one, other in zip(first.T, second.T, strict=True):
        total += (one[:, None] - other) ** 2
    return np.sqrt(total, out=total)
