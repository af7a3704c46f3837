"""Pruning beside a plain reference, and on lines whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tetraskel.kernels.chunks import silent
from tetraskel.kernels.exposure import Balls, Exposure, significance
from tetraskel.kernels.pruning import pieces_of, prune, trails

Ints = NDArray[np.integer]


def random_tree(seed: int, n: int = 120) -> tuple[Ints, Balls]:
    """A tree that wanders from node 0."""
    rng = np.random.default_rng(seed)
    parent = np.append(-1, [rng.integers(max(0, k - 12), k) for k in range(1, n)])
    positions = np.zeros((n, 3))
    for k in range(1, n):
        positions[k] = positions[parent[k]] + rng.normal(size=3)
    radii = rng.uniform(0.2, 0.8, n)
    return parent, Balls(positions, radii, radii * rng.uniform(1, 2, n))


def way(parent: Ints, tip: int) -> list[int]:
    nodes = [tip]
    while parent[nodes[-1]] >= 0:
        nodes.append(int(parent[nodes[-1]]))
    return nodes


def apart(parent: Ints, balls: Balls, tip: int, other: int) -> float:
    """Distance of two tips, or the shorter of their ways to where they meet if that is more."""
    ways = way(parent, tip), way(parent, other)
    meet = next(node for node in ways[0] if node in ways[1])
    limbs = [balls.positions[nodes[: nodes.index(meet) + 1]] for nodes in ways]
    long = [np.linalg.norm(np.diff(limb, axis=0), axis=1).sum() for limb in limbs]
    return max(float(np.linalg.norm(balls.positions[tip] - balls.positions[other])), min(long))


def pruned_plainly(parent: Ints, balls: Balls, tips: Ints, diagonal: float) -> tuple[Ints, list[float]]:
    """Which tip goes when, and what it is worth then: everything measured anew each time."""
    left, order, worths = tips.tolist(), [], []
    while left:
        values = []
        for tip in left:
            covered = {node for other in left if other != tip for node in way(parent, other)} | {0}
            exposure = Exposure(balls, np.array([tip]))
            for node in sorted(covered):
                exposure.cover(np.array([node]))
            exposure.alone[0] = min(
                [apart(parent, balls, tip, other) for other in left if other != tip], default=np.inf
            )
            value = significance(exposure.excess, exposure.ratio, exposure.alone, diagonal)[0]
            values.append((value, exposure.excess[0, 0], left.index(tip)))
        least = min(values)
        order.append(left.pop(least[2]))
        worths.append(float(least[0]))
    return np.array(order), worths


@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_plain_reference(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    parent, balls = random_tree(seed)
    monkeypatch.setattr("tetraskel.kernels.pruning.thinned", lambda _, nodes: nodes)
    leaves = np.setdiff1d(np.arange(len(parent)), parent)
    tips = np.random.default_rng(seed).permutation(leaves)[:15]
    order, worths = pruned_plainly(parent, balls, tips, 10.0)
    _, found = prune(parent, balls, np.array([0]), tips, 10.0, silent)
    assert np.allclose(found[[tips.tolist().index(tip) for tip in order]], worths)
    assert np.all(np.diff(worths) >= -1e-12)  # nothing gets less when something else goes


def test_a_spur_beside_the_end_of_a_line_goes_first_even_if_it_was_found_first() -> None:
    """Nodes 0 to 40 along a line, and a spur of two nodes beside its end."""
    along = np.arange(41) * 0.25
    positions = np.zeros((43, 3))
    positions[:41, 0] = along
    positions[41:, 0], positions[41:, 1] = along[37], [0.25, 0.5]
    radii = np.ones(43)
    parent = np.append(np.arange(-1, 40), [37, 41])
    excess, worth = prune(parent, Balls(positions, radii, radii), np.array([0]), np.array([42, 40]), 10.0, silent)
    assert worth[0] < worth[1]
    assert excess == pytest.approx([0.5, 10.0])


def test_pieces_are_cut_where_others_join() -> None:
    parent = np.array([-1, 0, 1, 2, 3, 2, 5])
    found = trails(parent, np.array([0]), np.array([4, 6]))
    assert [trail.tolist() for trail in found] == [[4, 3, 2, 1, 0], [6, 5, 2]]
    pieces, through = pieces_of(found, 2)
    assert [piece.tolist() for piece in pieces] == [[4, 3], [2, 1], [6, 5]]
    assert through.tolist() == [[True, True, False], [False, True, True]]


def test_no_tips_no_work() -> None:
    parent, balls = random_tree(0)
    excess, worth = prune(parent, balls, np.array([0]), np.empty(0, np.int64), 1.0, silent)
    assert len(excess) == len(worth) == 0
