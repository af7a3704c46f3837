"""Maximum spanning trees of large graphs in NumPy alone, and walks along them.

Boruvka's method (1926): every part takes its strongest link to another part, all at once, and the parts so joined
become one; a handful of rounds leaves a single part. Each round is a few passes over what links are left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class RootedTree:
    """A spanning tree seen from its root.

    Attributes
    ----------
    parent : (n,) int
        Parent node, -1 for the root and for nodes no link reaches.
    link : (n,) int
        Which link leads to the parent, -1 where there is none.
    levels : list of int arrays
        Nodes by depth, the sons of a node side by side.
    """

    parent: Ints
    link: Ints
    levels: list[Ints]


def joined_parts(chosen: Ints) -> tuple[NDArray[np.int32], int]:
    """Part (n,) of each node, and their count, when every node is joined to node `chosen` (itself: to none).

    Each node's choice must be its strongest link in one strict order, so that only pairs choose each other and no
    longer ring can close. Parts are numbered by their smallest such pair member or self-chooser.
    """
    ids = np.arange(len(chosen), dtype=np.int32)
    target = chosen.astype(np.int32)
    first_of_pair = (target[target] == ids) & (ids < target)
    target[first_of_pair] = ids[first_of_pair]
    active = np.flatnonzero(target != ids)
    while len(active):  # everybody looks one further, twice as far each time, until all see the end
        old = target[active]
        new = target[old]
        target[active] = new
        active = active[old != new]
    ends = target == ids
    number = np.cumsum(ends, dtype=np.int32) - 1
    return number[target], int(np.count_nonzero(ends))


def maximum_spanning_tree(n: int, first: Ints, second: Ints, weight: Floats) -> Ints:
    """Indices of the links of a maximum spanning tree (or forest) of n nodes, increasing.

    Parameters
    ----------
    n : int
    first, second : (k,) int
        Ends of each link; links may be parallel.
    weight : (k,) float
        Positive. Of equal weights the later link is the stronger.
    """
    chosen = []
    links = np.arange(len(first))
    while True:
        apart = np.flatnonzero(first != second)
        first, second, weight, links = first[apart], second[apart], weight[apart], links[apart]
        if len(links) == 0:
            break
        strongest = _strongest_links(n, first, second, weight)
        has = np.flatnonzero(strongest >= 0)
        target = np.arange(n, dtype=np.int32)
        target[has] = first[strongest[has]] + second[strongest[has]] - has
        chosen.append(np.unique(links[strongest[has]]))  # the two of a pair choose one link
        part, n = joined_parts(target)
        first, second = part[first], part[second]
    return np.sort(np.concatenate(chosen)) if chosen else np.empty(0, np.intp)


def _strongest_links(n: int, first: Ints, second: Ints, weight: Floats) -> Ints:
    """(n,) strongest link of each node, -1 where it has none."""
    best = np.zeros(n)
    np.maximum.at(best, first, weight)
    np.maximum.at(best, second, weight)
    strongest = np.full(n, -1)
    for ends in (first, second):
        candidates = np.flatnonzero(weight == best[ends])
        np.maximum.at(strongest, ends[candidates], candidates)
    return strongest


def rooted(n: int, first: Ints, second: Ints, root: int) -> RootedTree:
    """The tree of links (first, second) as seen from `root`, breadth first."""
    ends, others = np.concatenate([first, second]), np.concatenate([second, first])
    order = np.argsort(ends, kind="stable")
    others, links = others[order], order % max(len(first), 1)
    start = np.searchsorted(ends[order], np.arange(n + 1))
    parent, link = np.full(n, -1), np.full(n, -1)
    front = np.array([root])
    levels = [front]
    while True:
        counts = start[front + 1] - start[front]
        above = np.repeat(front, counts)
        at = np.arange(len(above)) + np.repeat(start[front] - np.cumsum(counts) + counts, counts)
        away = others[at] != parent[above]
        front = others[at[away]]
        if len(front) == 0:
            return RootedTree(parent, link, levels)
        parent[front], link[front] = above[away], links[at[away]]
        levels.append(front)
