"""Which part of the skeleton each input point belongs to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.branches import Branches
from tetraskel.kernels.chunks import Tick
from tetraskel.kernels.core import Core
from tetraskel.kernels.curve_lines import Lines
from tetraskel.kernels.inner_mesh import InnerMesh
from tetraskel.kernels.loops_in_python import run_loop
from tetraskel.kernels.medial_nodes import MedialNodes
from tetraskel.kernels.medial_tree import MedialTree

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def anchor_points(inner: InnerMesh, nodes: MedialNodes, core: Core, branches: Branches, tick: Tick) -> Ints:
    """(n,) node of the finest skeleton for each point of the mesh.

    A point belongs to its widest interior simplex (the pole of Amenta and Bern 1999), and that to the first node of
    the skeleton on its way to the root. A point without interior simplex goes with the nearest that has one.
    """
    from scipy.spatial import cKDTree  # not every ParaView has it

    tree = core.tree
    anchor = np.full(len(tree.parent), -1)
    for kept in (core.nodes, *(edges.ravel() for edges in branches.edges)):
        anchor[kept] = kept
    run_loop(_anchor_loop, (tree.sequence, tree.parent), (anchor,), tick, 1e-7 * len(anchor))
    widest = np.empty(len(inner.coordinates), np.int64)
    order = np.argsort(nodes.radii, kind="stable")
    widest[inner.simplices[order]] = order[:, None]  # the last one written is the widest
    result = np.full(len(inner.mesh.points), -1)
    result[inner.point_ids] = anchor[widest]
    lost = np.flatnonzero(result < 0)
    if len(lost) and len(inner.point_ids):
        nearest = cKDTree(inner.coordinates).query(inner.mesh.coordinates[lost])[1]
        result[lost] = result[inner.point_ids[nearest]]
    return result


def _anchor_loop(sequence, parent, anchor):  # type: ignore[no-untyped-def]
    for node in sequence:
        if anchor[node] < 0:
            anchor[node] = anchor[parent[node]]


def points_of_anchors(anchors: Ints, tree: MedialTree, positions: Floats, lines: Lines) -> Ints:
    """(n,) point of the lines for each anchor: up the tree to the first node that is drawn, then along its line.

    Parameters
    ----------
    anchors : (n,) int
        Nodes of the finest skeleton.
    positions : (m, d) float
        Of the nodes.
    """
    from scipy.spatial import cKDTree  # not every ParaView has it

    point_of = {int(node): point for point, node in reversed(list(enumerate(lines.nodes.tolist())))}
    wanted, back = np.unique(anchors, return_inverse=True)
    found = np.array([_climb(int(node), tree.parent, point_of) for node in wanted], dtype=np.int64)
    lost = np.flatnonzero(found < 0)  # above the last drawn node of its piece: the nearest point of the piece
    for component in np.unique(tree.component[wanted[lost]]):
        mine = np.flatnonzero(tree.component[lines.nodes] == component)
        some = lost[tree.component[wanted[lost]] == component]
        found[some] = mine[cKDTree(lines.positions[mine]).query(positions[wanted[some]])[1]]
    return found[back]


def _climb(node: int, parent: Ints, point_of: dict[int, int]) -> int:
    while node >= 0:
        if node in point_of:
            return point_of[node]
        node = int(parent[node])
    return -1
