"""Branches in the order of their significance: the same sequence serves every detail.

A branch is worth drawing when its tip's ball pokes far out of the balls of what is already drawn. The farthest is
taken first, its path followed until it enters a ball of the skeleton; then all distances are brought up to date.
How far the next one pokes out can only fall, so the branches of a coarse skeleton are the first of a fine one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.core import Core
from tetraskel.kernels.medial_tree import MedialTree, lengths_and_tips

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FINEST = 0.003  # significance below which no branch is looked for
SHEET = 1.0  # how much of a sheet's width beyond its thickness counts as covered
JOIN = 0.5  # a path joins a drawn node when it comes this close, in its radii
TIP = 0.45  # an end is cut back to the ball that everything beyond pokes out of by less than this, in its radii
SAMPLE = 0.25  # balls this far apart, in radii, stand for a path
# A bump is judged by how far it pokes out in diagonals of the object, a limb also by its own slenderness: beyond
# this ratio of distance to cover it counts for more, so that the twigs of a large tree are branches too.
SLENDER = 2.5
SLENDER_POWER = 4
BUMP = (1.1, 1.3)  # ratio of distance to cover: below the first it is nothing, from the second on it counts in full


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
        Non-increasing inside a component; of the whole sequence sorted.
    """

    edges: list[Ints]
    tips: Ints
    significance: Floats

    def count(self, least: float) -> int:
        """How many branches have at least this significance."""
        return int(np.searchsorted(-self.significance, -least, side="right"))


@dataclass(frozen=True)
class Balls:
    """Nodes as the growth sees them: positions (m, d), radii (m,), and how far each is taken to cover (m,)."""

    positions: Floats
    radii: Floats
    covers: Floats


def grow_branches(core: Core, positions: Floats, radii: Floats, burn: Floats, tick: Tick = silent) -> Branches:
    """All branches down to the finest significance.

    Parameters
    ----------
    core : Core
    positions : (m, d) float
    radii, burn : (m,) float
    """
    balls = Balls(positions, radii, radii + SHEET * (burn - radii))
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
    n = len(tree.roots)
    low, high = np.full((n, positions.shape[1]), np.inf), np.full((n, positions.shape[1]), -np.inf)
    np.minimum.at(low, tree.component, positions - radii[:, None])
    np.maximum.at(high, tree.component, positions + radii[:, None])
    return np.sqrt(((high - low) ** 2).sum(axis=1))


def _candidates(
    tree: MedialTree, length: Floats, reach: Floats, tip: Ints, radii: Floats, diagonals: Floats
) -> Ints:
    """Tips of all paths that leave a longer one and reach out of its ball by more than the finest significance."""
    sons = np.flatnonzero(tree.parent >= 0)
    above = tree.parent[sons]
    leaves = (tip[above] != tip[sons]) & (
        reach[sons] - length[above] - radii[above] > FINEST * diagonals[tree.component[sons]]
    )
    return np.unique(np.concatenate([tip[sons[leaves]], tip[tree.roots]]))


def significance_of(excess: Floats, ratio: Floats) -> Floats:
    """One number from how far a tip pokes out (in diagonals) and its distance over the cover there."""
    bump = np.clip((ratio - BUMP[0]) / (BUMP[1] - BUMP[0]), 0, 1)
    return excess * bump * np.maximum(1, ratio / SLENDER) ** SLENDER_POWER


def _grow(
    parent: Ints, balls: Balls, start: Ints, candidates: Ints, diagonal: float, tick: Tick
) -> list[tuple[float, int, Ints]]:
    """Branches of one component: significance, tip, edges."""
    kept = start
    excess, ratio = np.full(len(candidates), np.inf), np.full(len(candidates), np.inf)
    _cover(balls, candidates, kept, excess, ratio)
    found: list[tuple[float, int, Ints]] = []
    on_skeleton = dict.fromkeys(kept.tolist())
    limit = np.inf
    while True:
        tick(0.0)
        values = significance_of(np.maximum(excess, 0) / diagonal, ratio)
        best = int(values.argmax())
        if values[best] < FINEST:
            return found
        limit = min(limit, float(values[best]))
        path = _path_to_skeleton(parent, balls, int(candidates[best]), on_skeleton, kept)
        excess[best] = -np.inf
        path = path[_end_of_tip(balls, path) :]
        if len(path) < 2:
            continue
        found.append((limit, int(path[0]), np.stack([path[:-1], path[1:]], axis=1)))
        on_skeleton.update(dict.fromkeys(path[:-1].tolist()))
        kept = np.concatenate([kept, path[:-1]])
        _cover(balls, candidates, path[:-1], excess, ratio)


def _cover(balls: Balls, candidates: Ints, nodes: Ints, excess: Floats, ratio: Floats) -> None:
    """Lower the candidates' excess and ratio to what the balls at `nodes` leave, in place."""
    nodes = thinned(balls, nodes)
    for start in range(0, len(nodes), 64):
        some = nodes[start : start + 64]
        away = np.sqrt(
            ((balls.positions[candidates][:, None] - balls.positions[some][None]) ** 2).sum(axis=2)
        )  # (candidates, some)
        np.minimum(excess, (away - balls.covers[some]).min(axis=1) + balls.radii[candidates], out=excess)
        np.minimum(ratio, (away / balls.covers[some]).min(axis=1), out=ratio)


def thinned(balls: Balls, path: Ints) -> Ints:
    """Nodes of a path about a quarter radius apart, both ends among them."""
    if len(path) < 3:
        return path
    step = np.sqrt((np.diff(balls.positions[path], axis=0) ** 2).sum(axis=1))
    scaled = np.cumsum(np.append(0, step / (SAMPLE * np.maximum(balls.radii[path[1:]], 1e-300))))
    chosen = np.append(True, np.floor(scaled[1:]) > np.floor(scaled[:-1]))
    chosen[-1] = True
    return path[chosen]


def _path_to_skeleton(parent: Ints, balls: Balls, tip: int, on_skeleton: dict[int, None], kept: Ints) -> Ints:
    """Nodes from a tip up to the skeleton: to where the path enters a ball, then straight to its node."""
    path = [tip]
    while path[-1] not in on_skeleton:
        path.append(int(parent[path[-1]]))
    nodes = np.array(path)
    away, nearest = cKDTree(balls.positions[kept]).query(balls.positions[nodes])
    near = np.flatnonzero(away < JOIN * balls.radii[kept[nearest]])
    if len(near) == 0 or near[0] >= len(nodes) - 1:
        return nodes
    return np.append(nodes[: near[0] + 1], kept[nearest[near[0]]])


def _end_of_tip(balls: Balls, path: Ints) -> int:
    """Where to cut a path that begins at its tip: what is cut pokes out of the ball there by little."""
    sparse = thinned(balls, path)
    where = np.flatnonzero(np.isin(path, sparse))
    positions, radii = balls.positions[sparse], balls.radii[sparse]
    away = np.sqrt(((positions[:, None] - positions[None]) ** 2).sum(axis=2))
    out = np.tril(away + radii[None] - radii[:, None], -1).max(axis=1)  # (q,) of everything nearer to the tip than q
    fits = np.flatnonzero(out <= TIP * radii)
    return int(where[fits[-1]])
