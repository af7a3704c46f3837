"""From the finest skeleton to the coarsest: the end that pokes out of the rest by least is cut off next.

What an end is worth is seen when all that is worth more is drawn. The way down is sure to see that; on the way up a
spur beside the end of a limb may come first, and the true end after it looks like a branch.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick
from tetraskel.kernels.exposure import Balls, distances, in_covers, significance, thinned
from tetraskel.kernels.medial_tree import way_up

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]


def prune(parent: Ints, balls: Balls, start: Ints, tips: Ints, diagonal: float, tick: Tick) -> tuple[Floats, Floats]:
    """Cut off all tips, the least significant first.

    Parameters
    ----------
    parent : (m,) int
        Next node on the way to `start`.
    balls : Balls
    start : (s,) int
        Nodes that are always drawn.
    tips : (k,) int
    diagonal : float
        Of the object.
    tick : callable
        Called for every tip with 0.

    Returns
    -------
    excess, significance : (k,) float
        How far each tip pokes out of all that is more significant, and its significance.
    """
    fringe = _Fringe(parent, balls, start, tips)
    excess, worth = np.empty(len(tips)), np.empty(len(tips))
    for _ in range(len(tips)):
        tick(0.0)
        left = np.flatnonzero(fringe.left)
        values = significance(fringe.excess[:, left], fringe.ratio[:, left], fringe.alone[left], diagonal)
        least = int(np.lexsort([fringe.excess[0, left], values])[0])  # edges of plates are worth the same at most
        tip = int(left[least])
        excess[tip], worth[tip] = fringe.excess[0, tip], values[least]
        fringe.cut(tip)
    return excess, worth


class _Fringe:
    """The tips that are left (`left`), and how far each pokes out of all that is not its own way alone.

    `excess` and `ratio` (2, k) are those of `Exposure`, `alone` (k,) is how far `apart` (k, k) the next tip is. Trails
    are cut into pieces where others join them; `through` (k, p) says which pieces lie on the way of which tip. The last
    piece is the start, which is nobody's.
    """

    def __init__(self, parent: Ints, balls: Balls, start: Ints, tips: Ints) -> None:
        self.balls, self.tips = balls, tips
        pieces, self.through = pieces_of(trails(parent, start, tips), len(tips))
        nodes = [thinned(balls, piece) for piece in [*pieces, start]]
        self.nodes = np.concatenate(nodes)
        self.piece_of = np.repeat(np.arange(len(nodes)), [len(piece) for piece in nodes])
        self.covers = balls.covers(self.nodes)
        self.left = np.ones(len(tips), bool)
        self.shared_by = np.append(self.through.sum(axis=0), len(tips))
        self.excess, self.ratio = np.empty((2, len(tips))), np.empty((2, len(tips)))
        self.nearest = np.empty((4, len(tips)), np.int64)  # pieces that give the four
        self.apart = np.maximum(
            distances(balls.positions[tips], balls.positions[tips]), _limbs(parent, balls, pieces, self.through)
        )
        self.alone, self.neighbour = np.full(len(tips), np.inf), np.full(len(tips), -1)
        for tip in range(len(tips)):
            self._measure(tip)
            self._find_neighbour(tip)

    def cut(self, tip: int) -> None:
        """Cut a tip off, with all of its way that no other needs."""
        before = self.shared_by.copy()
        self.left[tip] = False
        self.shared_by[:-1] -= self.through[tip]
        gone = (before > 0) & (self.shared_by == 0)
        alone_now = np.flatnonzero((before > 1) & (self.shared_by == 1))
        touched = gone[self.nearest].any(axis=0)
        touched |= self.through[:, alone_now[alone_now < self.through.shape[1]]].any(axis=1)
        for other in np.flatnonzero(touched & self.left):
            self._measure(int(other))
        for other in np.flatnonzero((self.neighbour == tip) & self.left):
            self._find_neighbour(int(other))

    def _measure(self, tip: int) -> None:
        drawn = self.shared_by > 0
        drawn[:-1] &= ~(self.through[tip] & (self.shared_by[:-1] == 1))
        drawn[-1] = True
        use = np.flatnonzero(drawn[self.piece_of])
        node = self.tips[tip]
        away = np.sqrt(((self.balls.positions[self.nodes[use]] - self.balls.positions[node]) ** 2).sum(axis=1))
        for row, covers in enumerate(self.covers[:, use]):
            out, ratio = away - covers, in_covers(away, covers)
            self.nearest[[row, 2 + row], tip] = self.piece_of[use[[out.argmin(), ratio.argmin()]]]
            self.excess[row, tip] = out.min() + self.balls.radii[node]
            self.ratio[row, tip] = ratio.min()

    def _find_neighbour(self, tip: int) -> None:
        others = np.flatnonzero(self.left & (np.arange(len(self.tips)) != tip))
        self.alone[tip], self.neighbour[tip] = np.inf, -1
        if len(others):
            away = self.apart[tip, others]
            self.alone[tip], self.neighbour[tip] = away.min(), others[away.argmin()]


def _limbs(parent: Ints, balls: Balls, pieces: list[Ints], through: Bools) -> Floats:
    """(k, k) length of the shorter of two tips' ways to where they meet: two legs are apart, however close the feet."""
    steps = [balls.positions[piece] - balls.positions[parent[piece]] for piece in pieces]
    lengths = np.array([np.sqrt((step**2).sum(axis=1)).sum() for step in steps])
    common = (through * lengths) @ through.T.astype(float)
    whole = np.diagonal(common)
    return np.asarray(np.minimum(whole[:, None], whole) - common)


def trails(parent: Ints, start: Ints, tips: Ints) -> list[Ints]:
    """For each tip the nodes up to the trail of an earlier one, or to `start`; the node met there is the last."""
    seen = set(start.tolist())
    found = list[Ints]()
    for tip in tips.tolist():
        way = way_up(parent, tip, seen)
        seen.update(way)
        found.append(np.array(way, dtype=np.int64))
    return found


def pieces_of(found: list[Ints], n_tips: int) -> tuple[list[Ints], Bools]:
    """Trails, cut where others join them: the nodes of each piece, and (k, p) which lie on the way of which tip."""
    joints = {int(way[-1]) for way in found}
    pieces: list[Ints] = []
    piece_at: dict[int, int] = {}
    first = []
    for way in found:
        first.append(len(pieces))
        own = way[:-1]
        cuts = [place for place, node in enumerate(own.tolist()) if place and node in joints]
        for piece in np.split(own, cuts):
            piece_at.update(dict.fromkeys(piece.tolist(), len(pieces)))
            pieces.append(piece)
    trail_of = np.repeat(np.arange(n_tips), np.diff([*first, len(pieces)]))
    through = np.zeros((n_tips, len(pieces)), bool)
    for tip, way in enumerate(found):
        joined = piece_at.get(int(way[-1]), -1)
        if joined >= 0:  # the way of that trail, from there on
            through[tip] = through[trail_of[joined]]
            through[tip, first[trail_of[joined]] : joined] = False
        through[tip, first[tip] : first[tip + 1] if tip + 1 < n_tips else len(pieces)] = True
    return pieces, through
