"""Branches in the order of their significance: the same sequence serves every detail.

A branch is worth drawing when its tip's ball pokes far out of the balls of what is already drawn. The farthest is
taken first, its path followed until it enters a ball of the skeleton; then all distances are brought up to date.
How far the next one pokes out can only fall, so the branches of a coarse skeleton are the first of a fine one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.core import Core
from tetraskel.kernels.medial_tree import MedialTree, lengths_and_tips
from tetraskel.kernels.nearest import Cloud

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FINEST = 0.015  # significance below which no branch is looked for
LEAST_EXCESS = 0.006  # of the diagonal: no branch reaches out of its parent's ball by less
JOIN = 0.5  # a path joins a drawn node when it comes this close, in its radii
# An end is cut back to the ball that everything beyond pokes out of by less than this, in its radii: less than the
# first share at once, since a right-angled edge pokes out by sqrt(2) - 1 and is not followed; less than the second
# where the path goes straight on, to the tip of a slender limb.
TIP = (0.5, 0.2)
LONGER = 0.5  # what only makes an end longer is worth this share of a new one: at a flat end, the way into a corner
TIP_SHARE = 0.4  # of how far a branch pokes out, at most this much is cut
STRAIGHT = 0.3  # a path goes straight on while it leaves the line through its end by less than this share
SAMPLE = 0.25  # balls this far apart, in radii, stand for a path
FINE_SAMPLE = 0.06  # where an end is looked for
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
class Branches:
    """What can be drawn, most significant first.

    Attributes
    ----------
    edges : list of (k, 2) int
        Pairs of nodes that each branch adds.
    tips : (b,) int
        End node of each branch.
    significance : (b,) float
        Non-increasing; never more than that of the branch it grows from.
    """

    edges: list[Ints]
    tips: Ints
    significance: Floats

    def count(self, least: float) -> int:
        """How many branches have at least this significance."""
        return int(np.searchsorted(-self.significance, -least, side="right"))


@dataclass(frozen=True)
class Balls:
    """Nodes as the growth sees them: positions (m, d), radii (m,), and burn times (m,), at least the radii."""

    positions: Floats
    radii: Floats
    burn: Floats


class Exposure:
    """How far each candidate tip pokes out of what is drawn, and how far away that is in its covers.

    Measured twice: out of the balls (row 0), and out of balls as wide as the sheet is (row 1). What pokes out of the
    balls alone is an edge of a plate, not a limb, and counts for details only.
    """

    def __init__(self, balls: Balls, candidates: Ints) -> None:
        self.balls, self.candidates = balls, candidates
        self.alone = np.full(len(candidates), np.inf)  # distance to the nearest end that is drawn
        self.excess = np.full((2, len(candidates)), np.inf)
        self.ratio = np.full((2, len(candidates)), np.inf)

    def cover(self, nodes: Ints) -> None:
        """Draw balls at more nodes."""
        balls, nodes = self.balls, thinned(self.balls, nodes)
        tips, radii = balls.positions[self.candidates], balls.radii[self.candidates]
        for start in range(0, len(nodes), 64):
            some = nodes[start : start + 64]
            away = np.sqrt(((tips[:, None] - balls.positions[some][None]) ** 2).sum(axis=2))  # (tips, some)
            for row, sheet in enumerate(SHEETS):
                covers = balls.radii[some] + sheet * (balls.burn[some] - balls.radii[some])
                np.minimum(self.excess[row], (away - covers).min(axis=1) + radii, out=self.excess[row])
                ratio = np.where(away > 0, np.inf, 0.0)  # of a ball without radius, which covers its own place only
                np.divide(away, covers, out=ratio, where=covers > 0)
                np.minimum(self.ratio[row], ratio.min(axis=1), out=self.ratio[row])

    def significance(self, diagonal: float) -> Floats:
        """One number per candidate, which never grows."""
        alone = np.minimum(self.alone / diagonal, ALONE)
        edge, limb = significance_of(np.maximum(self.excess, 0) / diagonal, alone, self.ratio)
        return np.maximum(limb, np.minimum(EDGE * edge, EDGE_LIMIT))

    def drop_covered(self, diagonal: float) -> Floats:
        """Forget the candidates that are of no significance, for good; significance of the others."""
        values = self.significance(diagonal)
        alive = values >= FINEST
        self.candidates, self.alone = self.candidates[alive], self.alone[alive]
        self.excess, self.ratio = self.excess[:, alive], self.ratio[:, alive]
        return np.asarray(values[alive])

    def add_end(self, node: int) -> None:
        """Draw an end."""
        away = self.balls.positions[self.candidates] - self.balls.positions[node]
        np.minimum(self.alone, np.sqrt((away**2).sum(axis=1)), out=self.alone)


def grow_branches(core: Core, positions: Floats, radii: Floats, burn: Floats, tick: Tick = silent) -> Branches:
    """All branches down to the finest significance.

    Parameters
    ----------
    core : Core
    positions : (m, d) float
    radii, burn : (m,) float
    """
    balls = Balls(positions, radii, burn)
    tree = core.tree
    length, reach, tip = lengths_and_tips(tree.sequence, tree.parent, positions, radii, tick)
    diagonals = _diagonals(tree, positions, radii)
    candidates = _candidates(tree, length, reach, tip, radii, diagonals)
    found: list[tuple[float, int, Ints]] = []
    component_of_core = tree.component[core.nodes]
    for done, component in enumerate(np.unique(tree.component[candidates])):
        tick(done / len(tree.roots))
        mine = candidates[tree.component[candidates] == component]
        start = core.nodes[component_of_core == component]
        found += _grow(tree.parent, balls, start, mine, diagonals[component], tick)
    found.sort(key=lambda branch: -branch[0])  # stable: components in order
    return Branches(
        [edges for _, _, edges in found],
        np.array([tip for _, tip, _ in found], dtype=np.int64),
        np.array([significance for significance, _, _ in found]),
    )


def _diagonals(tree: MedialTree, positions: Floats, radii: Floats) -> Floats:
    """(c,) diagonal of the box around each component's balls."""
    order = np.argsort(tree.component, kind="stable")
    first = np.flatnonzero(np.diff(tree.component[order], prepend=-1))
    low = np.minimum.reduceat((positions - radii[:, None])[order], first, axis=0)
    high = np.maximum.reduceat((positions + radii[:, None])[order], first, axis=0)
    found = np.sqrt(((high - low) ** 2).sum(axis=1))
    return np.where(found > 0, found, 1.0)  # of pieces all in one place, where nothing else has a length either


def _candidates(tree: MedialTree, length: Floats, reach: Floats, tip: Ints, radii: Floats, diagonals: Floats) -> Ints:
    """Tips of all paths that leave a longer one and reach out of its ball by more than the finest significance."""
    sons = np.flatnonzero(tree.parent >= 0)
    above = tree.parent[sons]
    leaves = (tip[above] != tip[sons]) & (
        reach[sons] - length[above] - radii[above] > LEAST_EXCESS * diagonals[tree.component[sons]]
    )
    return np.unique(np.concatenate([tip[sons[leaves]], tip[tree.roots]]))


def significance_of(excess: Floats, alone: Floats, ratio: Floats) -> Floats:
    """One number from how far a tip pokes out, how far the next end is (in diagonals), and distance over cover.

    The geometric mean of the first two: a person draws the lone tail before the second finger of a hand.
    """
    bump = np.clip((ratio - BUMP[0]) / (BUMP[1] - BUMP[0]), 0, 1)
    return np.sqrt(excess * alone) * bump * np.maximum(1, ratio / SLENDER) ** SLENDER_POWER


def _grow(
    parent: Ints, balls: Balls, start: Ints, candidates: Ints, diagonal: float, tick: Tick
) -> list[tuple[float, int, Ints]]:
    """Branches of one component: significance, tip, edges.

    A bump that is fatter than it pokes out is worth less by the root of that, and no branch more than the one it
    grows from.
    """
    kept = start
    exposure = Exposure(balls, candidates)
    exposure.cover(kept)
    found: list[tuple[float, int, Ints]] = []
    on_skeleton = dict.fromkeys(kept.tolist(), np.inf)  # with the significance of the branch a node is drawn with
    limit, ends = np.inf, list[int]()
    while True:
        tick(0.0)
        values = exposure.drop_covered(diagonal)
        if len(values) == 0:
            return found
        best = int(values.argmax())
        limit = min(limit, float(values[best]))
        path = _path_to_skeleton(parent, balls, int(exposure.candidates[best]), on_skeleton, kept)
        excess = float(exposure.excess[0, best])
        path = path[_end_of_tip(balls, path, TIP_SHARE * excess) :]
        exposure.excess[:, best] = -np.inf
        if len(path) < 2:
            continue
        fatness = float(balls.radii[path[0]]) / max(excess, 1e-300)
        worth = min(limit / np.sqrt(max(fatness, 1.0)), on_skeleton[int(path[-1])])
        if path[-1] in ends:
            worth *= LONGER
        ends.append(int(path[0]))
        found.append((worth, int(path[0]), np.stack([path[:-1], path[1:]], axis=1)))
        exposure.add_end(int(path[0]))
        on_skeleton.update(dict.fromkeys(path[:-1].tolist(), worth))
        kept = np.concatenate([kept, path[:-1]])
        exposure.cover(path[:-1])


def thinned(balls: Balls, path: Ints, apart: float = SAMPLE) -> Ints:
    """Nodes of a path about a quarter radius (or `apart` radii) apart, both ends among them."""
    if len(path) < 3:
        return path
    step = np.sqrt((np.diff(balls.positions[path], axis=0) ** 2).sum(axis=1))
    scaled = np.cumsum(np.append(0, step / (apart * np.maximum(balls.radii[path[1:]], 1e-300))))
    chosen = np.append(True, np.floor(scaled[1:]) > np.floor(scaled[:-1]))
    chosen[-1] = True
    return path[chosen]


def _path_to_skeleton(parent: Ints, balls: Balls, tip: int, on_skeleton: dict[int, float], kept: Ints) -> Ints:
    """Nodes from a tip up to the skeleton: to where the path enters a ball, then straight to its node."""
    path = [tip]
    while path[-1] not in on_skeleton:
        path.append(int(parent[path[-1]]))
    nodes = np.array(path)
    away, nearest = Cloud(balls.positions[kept]).query(balls.positions[nodes])
    near = np.flatnonzero(away < JOIN * balls.radii[kept[nearest]])
    if len(near) == 0 or near[0] >= len(nodes) - 1:
        return nodes
    return np.append(nodes[: near[0] + 1], kept[nearest[near[0]]])


def _end_of_tip(balls: Balls, path: Ints, most: float) -> int:
    """Where to cut a path that begins at its tip: what is cut pokes out of the ball there by little, never `most`."""
    sparse = thinned(balls, path, FINE_SAMPLE)
    where = np.flatnonzero(np.isin(path, sparse))
    positions, radii = balls.positions[sparse], balls.radii[sparse]
    away = np.sqrt(((positions[:, None] - positions[None]) ** 2).sum(axis=2))
    out = np.tril(away + radii[None] - radii[:, None], -1).max(axis=1)  # (q,) of everything nearer to the tip than q
    first, last = (int(np.flatnonzero(out <= np.minimum(share * radii, most))[-1]) for share in TIP)
    return int(where[_straight_on(positions, radii, first, last)])


def _straight_on(positions: Floats, radii: Floats, first: int, last: int) -> int:
    """How far down from `first` to `last` the path goes on in the direction in which it comes to `first`."""
    behind = np.flatnonzero(((positions - positions[first]) ** 2).sum(axis=1) > radii[first] ** 2)
    behind = behind[behind > first]
    back = int(behind[0]) if len(behind) else len(positions) - 1
    way = positions[first] - positions[back]
    if not way.any() or first <= last:
        return first
    way = way / np.sqrt((way**2).sum())
    ahead = positions[last:first] - positions[first]
    along = ahead @ way
    aside = np.sqrt(np.maximum((ahead**2).sum(axis=1) - along**2, 0))
    bent = np.flatnonzero(aside > STRAIGHT * np.maximum(along, SAMPLE * radii[first]))
    return last + int(bent[-1]) + 1 if len(bent) else last
