"""Smooth lines through the nodes of the skeleton, sampled by the radius and kept inside the object."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.chains import Chains
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.curve_skeleton import line_edges
from tetraskel.kernels.inner_mesh import InnerMesh
from tetraskel.kernels.inside_check import facets_between, stays_inside
from tetraskel.kernels.medial_nodes import MedialNodes
from tetraskel.kernels.walking import walk_to

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

STEP = 0.25  # distance between samples, in radii
# Balls of neighbouring nodes share points, so that a step is at most twice their mean radius; a simplex that spans a
# gap between clusters has its barycentre for node, and without a bound its step would take a million samples.
LONGEST_STEP = 16.0  # radii
WINDOW = 0.3  # standard deviation of the weights of the average over nodes, in radii
# Steps towards the neighbours' mean, and away from it: together they take out corners without shrinking what is
# long, as steps towards it alone would (Taubin, A signal processing approach to fair surface design, 1995).
RELAXATIONS = (0.5, -0.53, 0.5, -0.53)
PULLS = (0.5, 1.0)  # shares of the way back to the node for points whose edges leave the interior
FARTHEST = 0.25  # a sample moves this far from the average at most, in radii


@dataclass(frozen=True)
class Lines:
    """Polylines with shared end points.

    Attributes
    ----------
    positions : (p, d) float
        The vertices first, in the order of the chains' vertices, then the inner points of chain after chain.
    offsets : (c+1,) int
        Where each chain begins in `connectivity`.
    connectivity : (total,) int
        Points of each chain, ends among them.
    nodes : (p,) int
        Medial node nearest along the chain.
    """

    positions: Floats
    offsets: Ints
    connectivity: Ints
    nodes: Ints


def smooth_lines(chains: Chains, nodes: MedialNodes, inner: InnerMesh, tick: Tick = silent) -> Lines:
    """Average, relax and check.

    Samples a quarter radius apart are averages over the nodes around them, which takes out the zigzag; a few steps
    towards the neighbours' mean then round off corners and move junctions between their branches. Where an edge
    leaves the interior the line goes back towards the nodes, and if need be from simplex to simplex.
    """
    lines = _relaxed(_sampled(chains, nodes), nodes)
    for done, pull in enumerate(PULLS, 1):
        tick(done / (len(PULLS) + 2))
        bad = _edges_outside(lines, nodes, inner)
        if not bad.any():
            return lines
        points = np.unique(line_edges(lines.offsets, lines.connectivity)[bad])
        positions = lines.positions.copy()
        positions[points] += pull * (nodes.positions[lines.nodes[points]] - positions[points])
        lines = replace(lines, positions=positions)
    bad = _edges_outside(lines, nodes, inner)
    return _bent_inside(lines, bad, nodes, inner) if bad.any() else lines


def _sampled(chains: Chains, nodes: MedialNodes) -> Lines:
    number = {vertex: i for i, vertex in enumerate(chains.vertices)}
    places, rows = [nodes.positions[chains.vertices]], []
    owners: list[Ints] = [np.array(chains.vertices, dtype=np.int64)]
    n_points = len(number)
    for path in chains.paths:
        inner_places, inner_nodes = _averages(nodes.positions[path], nodes.radii[path], path)
        middle = np.arange(n_points, n_points + len(inner_nodes))
        rows.append(np.concatenate([[number[int(path[0])]], middle, [number[int(path[-1])]]]))
        places.append(inner_places)
        owners.append(inner_nodes)
        n_points += len(inner_nodes)
    offsets = np.concatenate([[0], np.cumsum([len(row) for row in rows], dtype=np.int64)])
    connectivity = np.concatenate([np.empty(0, np.int64), *rows])
    return Lines(np.concatenate(places), offsets.astype(np.int64), connectivity, np.concatenate(owners))


def _averages(positions: Floats, radii: Floats, path: Ints) -> tuple[Floats, Ints]:
    """Inner samples of one chain and the node nearest to each along it."""
    step = np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=1))
    mean = 0.5 * (radii[1:] + radii[:-1])
    in_radii = np.divide(step, mean, out=np.where(step > 0, LONGEST_STEP, 0.0), where=mean > 0)
    along = np.concatenate([[0], np.cumsum(np.minimum(in_radii, LONGEST_STEP))])
    closed = path[0] == path[-1]
    n = max(int(np.ceil(along[-1] / STEP)), 3 if closed else 1)
    wanted = np.linspace(0, along[-1], n + 1)[1:-1]
    width = np.minimum(WINDOW, 0.5 * np.minimum(wanted, along[-1] - wanted))
    weights = np.exp(-0.5 * ((along[None] - wanted[:, None]) / np.maximum(width, 1e-12)[:, None]) ** 2)
    share = np.zeros(len(along))  # a node stands for half of each step beside it: crowds of nodes do not count more
    share[1:] += np.diff(along)
    share[:-1] += np.diff(along)
    weights *= share
    total = weights.sum(axis=1)
    nearest = np.abs(along[None] - wanted[:, None]).argmin(axis=1)
    lost = total <= 1e-12
    weights[lost, nearest[lost]], total[lost] = 1.0, 1.0
    return weights @ positions / total[:, None], path[nearest]


def _relaxed(lines: Lines, nodes: MedialNodes) -> Lines:
    """A few steps towards the mean of the neighbours and back; ends stay."""
    a, b = line_edges(lines.offsets, lines.connectivity).T
    degree = np.bincount(np.concatenate([a, b]), minlength=len(lines.positions))
    fixed = degree < 2
    start, limit = lines.positions, FARTHEST * nodes.radii[lines.nodes]
    positions = start.copy()
    for share in RELAXATIONS:
        total = np.zeros_like(positions)
        np.add.at(total, a, positions[b])
        np.add.at(total, b, positions[a])
        mean = total / np.maximum(degree, 1)[:, None]
        moved = positions + share * (mean - positions)
        away = moved - start
        length = np.sqrt((away**2).sum(axis=1))
        away *= np.divide(limit, length, out=np.ones_like(length), where=length > limit)[:, None]
        positions = np.where(fixed[:, None], start, start + away)
    return Lines(positions, lines.offsets, lines.connectivity, lines.nodes)


def _edges_outside(lines: Lines, nodes: MedialNodes, inner: InnerMesh) -> Bools:
    """(s,) edges that leave the interior."""
    edges = line_edges(lines.offsets, lines.connectivity)
    return ~stays_inside(inner, lines.positions, nodes.homes[lines.nodes], edges)


def _bent_inside(lines: Lines, bad: Bools, nodes: MedialNodes, inner: InnerMesh) -> Lines:
    """Lines whose bad edges go through the middles of the facets between the simplices of their ends."""
    homes = walk_to(inner.coordinates, inner.simplices, inner.neighbors, nodes.homes[lines.nodes], lines.positions)
    homes = np.where(homes >= 0, homes, nodes.homes[lines.nodes])
    places, owners, rows, edge = [lines.positions], [lines.nodes], [], 0
    n_points = len(lines.positions)
    for start, stop in zip(lines.offsets[:-1], lines.offsets[1:], strict=True):
        row = lines.connectivity[start:stop].tolist()
        bent = row[:1]
        for a, b in pairwise(row):
            if bad[edge]:
                route = facets_between(inner, int(homes[a]), int(homes[b]))
                bent += range(n_points, n_points + len(route))
                n_points += len(route)
                places.append(route)
                owners.append(np.full(len(route), lines.nodes[a]))
            bent.append(b)
            edge += 1
        rows.append(bent)
    offsets = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    connectivity = np.array([point for row in rows for point in row], dtype=np.int64)
    return Lines(np.concatenate(places), offsets, connectivity, np.concatenate(owners))
