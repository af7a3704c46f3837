"""Branches in the order of their significance: the same sequence serves every detail.

A branch is worth drawing when its tip's ball pokes far out of the balls of what is worth more. Tips are looked for
from the coarsest on, the farthest first, and judged from the finest back (`pruning`). Then the branches are drawn, the
most significant first: along the tip's way until it enters a ball of the skeleton.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.core import Core
from tetraskel.kernels.exposure import FINEST, SAMPLE, Balls, Exposure, distances, thinned_places
from tetraskel.kernels.medial_tree import MedialTree, lengths_and_tips, way_up
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.pruning import prune

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

LEAST_EXCESS = 0.006  # of the diagonal: no branch reaches out of its parent's ball by less
JOIN = 0.5  # a path joins a drawn node when it comes this close, in its radii
# An end is cut back to the ball that everything beyond pokes out of by less than this, in its radii: less than the
# first share at once, since a right-angled edge pokes out by sqrt(2) - 1, a little more where points are few, and is
# not followed; less than the second where the path goes straight on, to the tip of a slender limb.
TIP = (0.6, 0.2)
TIP_SHARE = 0.4  # of how far a branch pokes out, at most this much is cut
STRAIGHT = 0.3  # a path goes straight on while it leaves the line through its end by less than this share
FINE_SAMPLE = 0.06  # where an end is looked for
# A branch from within this many radii of an end only makes the line longer, and is worth this share of a new one: at
# a flat end, the way into a corner.
LONGER, NEAR_END = 0.45, 0.75
# The root is the end of a line that leads away from it to one side only. The second limb from there, a tip beyond so
# many radii of the root's ball, makes the line longer; the third, and each after it, is a new one.
LIMB = 2.0
# A line goes on from its end to a tip within so many radii, when the two directions make at least a half turn but
# for an angle with this cosine; so many tips are tried.
ONWARDS, FACING, TRIED = 3.0, 0.7, 20


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
        found += _grow(tree.parent, balls, start, mine, float(diagonals[component]), tick)
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


def _grow(
    parent: Ints, balls: Balls, start: Ints, candidates: Ints, diagonal: float, tick: Tick
) -> list[tuple[float, int, Ints]]:
    """Branches of one component: significance, tip, edges.

    A bump that is fatter than it pokes out is worth less by the root of that, and no branch more than the one it
    grows from.
    """
    tips = _exposed_tips(parent, Exposure(balls, candidates), start, diagonal, tick)
    excess, worth = prune(parent, balls, start, tips, diagonal, tick)
    order = np.argsort(-worth, kind="stable")
    drawing = _Drawing(parent, balls, start, np.concatenate([tips[order], np.setdiff1d(candidates, tips)]))
    for tip in order[worth[order] >= FINEST].tolist():
        tick(0.0)
        path = drawing.path_from(int(tips[tip]), TIP_SHARE * float(excess[tip]))
        if len(path) < 2:
            continue
        fatness = float(balls.radii[path[0]]) / max(float(excess[tip]), 1e-300)
        value = min(float(worth[tip]) / np.sqrt(max(fatness, 1.0)), drawing.drawn[int(path[-1])])
        drawing.add(path, value * (LONGER if drawing.makes_longer(path) else 1))
    return drawing.found


def _exposed_tips(parent: Ints, exposure: Exposure, start: Ints, diagonal: float, tick: Tick) -> Ints:
    """Tips that are significant when they are drawn, the most significant of the moment first."""
    seen = set(start.tolist())
    exposure.cover(start)
    tips = list[int]()
    while True:
        tick(0.0)
        values = exposure.drop_covered(diagonal)
        if len(values) == 0:
            return np.array(tips, dtype=np.int64)
        best = int(values.argmax())
        way = way_up(parent, int(exposure.ends[best]), seen)
        exposure.excess[:, best] = -np.inf
        if len(way) > 1:
            tips.append(way[0])
            seen.update(way)
            exposure.add_end(way[0])
            exposure.cover(np.array(way[:-1]))


class _Drawing:
    """The branches of one component so far: `found` (significance, tip, edges).

    `drawn` tells for each node on it the significance of its branch, `ends` are the outer ends of the lines; `tips`
    are all there are, the significant ones first, `lone_root` says that everything began from one node.
    """

    def __init__(self, parent: Ints, balls: Balls, start: Ints, tips: Ints) -> None:
        self.parent, self.balls, self.tips, self.kept = parent, balls, tips, start
        self._cloud: Cloud | None = None  # of the nodes kept
        self.places = balls.positions[tips]
        self.drawn = dict.fromkeys(start.tolist(), np.inf)
        self.ends: list[int] = []
        self.found: list[tuple[float, int, Ints]] = []
        self.lone_root = len(start) == 1
        self.root_goes_on = False  # a limb on the other side of the root is drawn

    def add(self, path: Ints, worth: float) -> None:
        """Draw a path and what goes straight on from it: from its tip, and from the lone root that it began at."""
        from_root = self.lone_root and not self.found
        self._add(path, worth)
        if from_root:
            significant = self.tips[:TRIED]  # a whole second half of the line, rather than the next spur
            beyond = self._onwards(path[::-1], np.concatenate([significant, self._tips_ahead(path[::-1])]))
            if len(beyond):
                self._add(beyond, worth)
            else:
                self.ends.append(int(path[-1]))
        elif self._leaves_root(path):
            self.root_goes_on = True

    def _add(self, path: Ints, worth: float) -> None:
        self._draw(path, worth)
        beyond = self._onwards(path, self._tips_ahead(path))
        if len(beyond):
            self._draw(beyond, worth)
            path = np.concatenate([beyond, path[1:]])
        self.ends.append(int(path[0]))
        self.found.append((worth, int(path[0]), np.stack([path[:-1], path[1:]], axis=1)))

    def _draw(self, path: Ints, worth: float) -> None:
        self.drawn.update(dict.fromkeys(path[:-1].tolist(), worth))
        self.kept = np.concatenate([self.kept, path[:-1]])
        self._cloud = None

    def makes_longer(self, path: Ints) -> bool:
        """Does a path only make a line longer, which ends near the node where the path begins?"""
        ends = np.array(self.ends, dtype=np.int64)
        if self.root_goes_on and self._leaves_root(path):
            ends = np.setdiff1d(ends, self.kept[:1])
        return bool(_within(self.balls, int(path[-1]), ends, NEAR_END).any())

    def _leaves_root(self, path: Ints) -> bool:
        """Does a path lead from near the lone root to a tip far out of its ball?"""
        root, node = int(self.kept[0]), int(path[-1])
        near = bool(_within(self.balls, node, root, NEAR_END))
        return self.lone_root and near and not _within(self.balls, int(path[0]), root, LIMB)

    def path_from(self, tip: int, most: float) -> Ints:
        """The nodes from a tip to the skeleton, cut back to where the rest pokes out by little, never `most`."""
        path = self._path_to_skeleton(tip)
        return path[_end_of_tip(self.balls, path, most) :]

    def _path_to_skeleton(self, tip: int) -> Ints:
        """To where the path enters a ball, then straight to its node."""
        nodes, positions = np.array(way_up(self.parent, tip, self.drawn)), self.balls.positions
        self._cloud = self._cloud or Cloud(positions[self.kept])
        away, nearest = self._cloud.query(positions[nodes])
        near = np.flatnonzero(away < JOIN * self.balls.radii[self.kept[nearest]])
        if len(near) == 0 or near[0] >= len(nodes) - 1:
            return nodes
        return np.append(nodes[: near[0] + 1], self.kept[nearest[near[0]]])

    def _tips_ahead(self, line: Ints) -> Ints:
        """Some tips beyond the first node of a line, the farthest ahead first."""
        balls, end = self.balls, int(line[0])
        ways = self.places - balls.positions[end]
        ahead = -(ways @ _heading(balls, line))
        near = np.flatnonzero(((ways**2).sum(axis=1) < (ONWARDS * balls.radii[end]) ** 2) & (ahead > 0))
        order = np.argsort(-(ahead[near] + balls.radii[self.tips[near]]), kind="stable")
        return self.tips[near[order[:TRIED]]]

    def _onwards(self, line: Ints, tips: Ints) -> Ints:
        """A path from the first tip that goes straight on from the first node of a line to there; empty if none."""
        balls, end, back = self.balls, int(line[0]), _heading(self.balls, line)
        for tip in tips.tolist():
            path = self.path_from(tip, np.inf) if tip not in self.drawn else np.empty(0, np.int64)
            if len(path) < 2 or not _within(balls, path[-1], end, JOIN):
                continue
            path = np.append(path[:-1], end)
            if _heading(balls, path[::-1]) @ back <= -FACING:
                return path
        return np.empty(0, np.int64)


def _within(balls: Balls, node: int, ends: int | Ints, share: float) -> Bools:
    """Whether a node lies within so many radii of each end."""
    away = balls.positions[ends] - balls.positions[node]
    return np.asarray((away**2).sum(axis=-1) <= (share * balls.radii[ends]) ** 2)


def _heading(balls: Balls, path: Ints) -> Floats:
    """Direction, of length 1, in which a path leaves the ball of its first node."""
    ways = balls.positions[path] - balls.positions[path[0]]
    away = np.sqrt((ways**2).sum(axis=1))
    out = np.append(np.flatnonzero(away > balls.radii[path[0]]), len(path) - 1)[0]
    return np.asarray(ways[out] / max(away[out], 1e-300))


def _end_of_tip(balls: Balls, path: Ints, most: float) -> int:
    """Where to cut a path that begins at its tip: what is cut pokes out of the ball there by little, never `most`."""
    where = thinned_places(balls, path, FINE_SAMPLE) if len(path) > 2 else np.arange(len(path))
    positions, radii = balls.positions[path[where]], balls.radii[path[where]]
    away = distances(positions, positions)
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
