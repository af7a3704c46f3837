"""From edges between nodes to chains between ends and junctions."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

MERGE = 0.5  # junctions closer than this, in the larger radius, are one


@dataclass(frozen=True)
class Chains:
    """A graph as its vertices (ends, junctions, one per closed loop or lone node) and the chains between them.

    Attributes
    ----------
    vertices : list of int
        Nodes, ascending.
    paths : list of (k,) int
        Nodes of each chain, the first and last of them vertices.
    """

    vertices: list[int]
    paths: list[Ints]

    @property
    def degrees(self) -> dict[int, int]:
        """How many chains end at each vertex; a closed one counts twice."""
        degree = dict.fromkeys(self.vertices, 0)
        for path in self.paths:
            degree[int(path[0])] += 1
            degree[int(path[-1])] += 1
        return degree


def trace_chains(nodes: Ints, edges: Ints) -> Chains:
    """Cut a graph at every node where not exactly two edges meet.

    Parameters
    ----------
    nodes : (n,) int
        All nodes, so that lone ones are not lost.
    edges : (e, 2) int
        Without duplicates.
    """
    around: dict[int, list[int]] = {int(node): [] for node in nodes}
    for a, b in edges.tolist():
        around[a].append(b)
        around[b].append(a)
    vertices = sorted(node for node, others in around.items() if len(others) != 2)
    walked: set[tuple[int, int]] = set()
    paths = [path for vertex in vertices for path in _paths_from(vertex, around, walked)]
    on_paths = {int(node) for path in paths for node in path}
    for node in sorted(around):  # what is left are closed loops without a junction
        if node not in on_paths and len(around[node]) == 2:
            loop = _paths_from(node, around, walked)[0]
            vertices.append(node)
            paths.append(loop)
            on_paths.update(loop.tolist())
    return Chains(sorted(vertices), paths)


def _paths_from(start: int, around: dict[int, list[int]], walked: set[tuple[int, int]]) -> list[Ints]:
    paths = []
    for first in sorted(around[start]):
        if (start, first) in walked:
            continue
        path = [start, first]
        while len(around[path[-1]]) == 2 and path[-1] != start:
            a, b = around[path[-1]]
            path.append(b if a == path[-2] else a)
        walked.update(pairwise(path))
        walked.update(pairwise(path[::-1]))
        paths.append(np.array(path))
    return paths


def merge_close_junctions(chains: Chains, positions: Floats, radii: Floats) -> Chains:
    """Contract chains between two junctions inside one ball, shortest first; a loop is never contracted.

    Parameters
    ----------
    positions : (m, d) float
    radii : (m,) float
        Of all nodes.
    """
    paths = list(chains.paths)
    while True:
        short = _shortest_inner(Chains(chains.vertices, paths), positions, radii)
        if short is None:
            break
        gone = paths.pop(short)
        kept, lost = sorted((int(gone[0]), int(gone[-1])), key=lambda node: (-radii[node], node))
        paths = [_moved_end(path, lost, kept) for path in paths]
        chains = Chains([vertex for vertex in chains.vertices if vertex != lost], paths)
    return Chains(chains.vertices, paths)


def _shortest_inner(chains: Chains, positions: Floats, radii: Floats) -> int | None:
    degree = chains.degrees
    best, shortest = None, 1.0
    for number, path in enumerate(chains.paths):
        a, b = int(path[0]), int(path[-1])
        if a == b or degree[a] < 3 or degree[b] < 3:
            continue
        apart = np.sqrt(((positions[path] - positions[a]) ** 2).sum(axis=1)).max()
        share = float(apart / (MERGE * max(radii[a], radii[b])))
        if share < shortest:
            best, shortest = number, share
    return best


def _moved_end(path: Ints, lost: int, kept: int) -> Ints:
    if path[0] != lost and path[-1] != lost:
        return path
    moved = path.copy()
    if path[0] == lost:
        moved[0] = kept
    if path[-1] == lost:
        moved[-1] = kept
    return moved
