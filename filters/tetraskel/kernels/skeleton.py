<<<<<<< HEAD
"""The curve skeleton as arrays: points with radius, polylines, and what is known about each."""

from __future__ import annotations

from dataclasses import dataclass, field
=======
"""The skeleton a tree draws: its nodes without the leaves, cut into branches."""

from __future__ import annotations

from dataclasses import dataclass
>>>>>>> interior

import numpy as np
from numpy.typing import NDArray

<<<<<<< HEAD
Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

REGULAR, END, JUNCTION = 0, 1, 2
NODE_TYPES = ("regular", "end", "junction")


@dataclass(frozen=True)
class Skeleton:
    """A graph of polylines; junction points are shared.

    Points are numbered root first, then branch after branch, away from the root; branches in the order in which a
    breadth-first walk from the roots meets them, component by component.

    Attributes
    ----------
    points : (p, e) float
        In the input's unit and space.
    radius : (p,) float
        Distance to the nearest input point of the object (`MaximumInscribedSphereRadius`).
    offsets : (b+1,) int
        Where each branch begins in `connectivity`.
    connectivity : (total,) int
        Points of each branch, nearer end to the root first.
    parent : (p,) int
        Next point towards the root, -1 at a root. Loops are cut at the point farthest from the root.
    depth : (p,) int
        Number of edges to the root.
    abscissa : (p,) float
        Length of the way to the root.
    component : (p,) int
        Connected piece.
    branch_id : (p,) int
        Branch a point lies on; a shared point belongs to the branch that leads to the root, -1 for a lone point.
    node_degree : (p,) int
        Number of edges.
    node_type : (p,) int
        0 regular, 1 end, 2 junction (`NODE_TYPES`).
    strahler_order : (p,) int
        1 from an end on, one more where two of the highest order meet (Strahler 1957).
    blanking : (p,) int
        1 inside the ball of a junction, where branches cannot be told apart.
    branch_length : (b,) float
    branch_tortuosity : (b,) float
        Length over distance between the ends, less 1; infinite for a closed branch.
    branch_radius : (b,) float
        Mean over the length.
    branch_strahler : (b,) int
        Order of its outer points.
    branch_group : (b,) int
        `GroupIds`: one group per branch, for every branch is drawn once.
    branch_blanking : (b,) int
        1 when all of it lies inside balls of junctions.
    point_nodes : (n,) int
        For every input point the skeleton point it belongs to (`SkeletonNodeId`).
    components, loops, loops_refused, cavities : int
        Of the object: connected pieces, independent loops drawn, loops refused as false, and hollow spaces closed
        all around, which no curve can show.
    """

    points: Floats
    radius: Floats
    offsets: Ints
    connectivity: Ints
    parent: Ints
    depth: Ints
    abscissa: Floats
    component: Ints
    branch_id: Ints
    node_degree: Ints
    node_type: Ints
    strahler_order: Ints
    blanking: Ints
    branch_length: Floats
    branch_tortuosity: Floats
    branch_radius: Floats
    branch_strahler: Ints
    branch_group: Ints
    branch_blanking: Ints
    point_nodes: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    components: int = 0
    loops: int = 0
    loops_refused: int = 0
    cavities: int = 0

    def __len__(self) -> int:
        return len(self.points)

    @property
    def n_branches(self) -> int:
        """Number of polylines."""
        return len(self.offsets) - 1

    @property
    def edges(self) -> Ints:
        """(s, 2) pairs of points, branch after branch."""
        return line_edges(self.offsets, self.connectivity)

    @property
    def point_branches(self) -> Ints:
        """(n,) branch of every input point (`BranchId`)."""
        return self.branch_id[self.point_nodes] if len(self.points) else np.full(len(self.point_nodes), -1)

    def branch(self, number: int) -> Ints:
        """Points of one branch."""
        return self.connectivity[self.offsets[number] : self.offsets[number + 1]]


def line_edges(offsets: Ints, connectivity: Ints) -> Ints:
    """(s, 2) edges of polylines."""
    begins = np.ones(len(connectivity), bool)
    begins[offsets[1:] - 1] = False  # the last point of a line begins no edge
    first = np.flatnonzero(begins)
    if len(first) == 0:
        return np.empty((0, 2), np.int64)
    return np.stack([connectivity[first], connectivity[first + 1]], axis=1)
=======
from tetraskel.kernels.centres import centres
from tetraskel.kernels.forest import Forest
from tetraskel.kernels.tree import Tree
from tetraskel.options import SkeletonOptions, TreeOptions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

END, REGULAR, JUNCTION = 0, 1, 2


@dataclass(frozen=True)
class TreeSkeleton:
    """Nodes of a tree drawn as branches.

    Attributes
    ----------
    points : (n, e) float
        Where the nodes lie.
    node : (n,) int
        Number of each in the tree.
    parent : (n,) int
        Index of the parent in this skeleton, -1 for a root.
    degree : (n,) int
        Number of lines that meet.
    node_type : (n,) int
        0 end, 1 regular, 2 junction.
    branch_offsets : (b+1,) int
        Branch k is `branch_nodes[branch_offsets[k]:branch_offsets[k+1]]`.
    branch_nodes : (...) int
        Indices of the points along each branch, from the root outwards; branches share their junctions.
    branch_id : (n,) int
        Branch of each point; a junction has that of the branch that leads to it, a root -1.
    """

    points: Floats
    node: Ints
    parent: Ints
    degree: Ints
    node_type: Ints
    branch_offsets: Ints
    branch_nodes: Ints
    branch_id: Ints

    @property
    def branch_lengths(self) -> Floats:
        """(b,) length of each branch, in the length unit."""
        path = self.points[self.branch_nodes]
        steps = np.sqrt(((path[1:] - path[:-1]) ** 2).sum(axis=1))
        steps = np.append(steps, 0.0)
        steps[self.branch_offsets[1:] - 1] = 0.0  # from the end of one branch to the beginning of the next
        return np.add.reduceat(steps, self.branch_offsets[:-1]) if len(self.branch_nodes) else np.empty(0)


def assemble_skeleton(
    tree: Tree, *, centre: str = TreeOptions.centre, keep_leaves: bool = SkeletonOptions.keep_leaves
) -> TreeSkeleton:
    """The skeleton of a tree: nodes at a centre of their simplices, without the nodes that have no sons.

    Parameters
    ----------
    centre : {"barycentre", "incentre", "circumcentre"}
        See `tetraskel.kernels.centres.centres`.
    keep_leaves : bool
        Keep the nodes without sons. A root always stays.
    """
    return skeleton_of(tree.forest, centres(tree.mesh, centre)[tree.cell], keep_leaves=keep_leaves)


def skeleton_of(forest: Forest, points: Floats, *, keep_leaves: bool = SkeletonOptions.keep_leaves) -> TreeSkeleton:
    """The skeleton of a forest whose nodes lie at `points` (n, e)."""
    node = np.flatnonzero((forest.son_count > 0) | (forest.parent < 0) | keep_leaves)
    index = np.full(len(forest) + 1, -1, np.int64)
    index[node] = np.arange(len(node))
    parent = index[forest.parent[node]]
    sons = np.bincount(parent[parent >= 0], minlength=len(node))
    degree = sons + (parent >= 0)
    node_type = np.clip(degree - 1, END, JUNCTION)
    branch_id = _branch_ids(parent, sons)
    offsets, nodes = _branches(parent, branch_id, forest.depth[node])
    return TreeSkeleton(points[node], node, parent, degree, node_type, offsets, nodes, branch_id)


def _branch_ids(parent: Ints, sons: Ints) -> Ints:
    """Branch of each node; a branch begins below a root or a junction and is numbered by where it begins.

    Strategy: each node points to its parent unless a branch begins with it; the pointers are doubled until every
    node points to the beginning of its branch.
    """
    n = len(parent)
    is_root = parent < 0
    bounds = is_root | (sons != 1)  # a branch ends here, others begin below
    begins = ~is_root & bounds[parent]
    jump = np.where(begins | is_root, np.arange(n), parent)
    while not np.array_equal(jump, further := jump[jump]):
        jump = further
    number = np.full(n, -1, np.int64)
    number[begins] = np.arange(int(begins.sum()))
    return number[jump]


def _branches(parent: Ints, branch_id: Ints, depth: Ints) -> tuple[Ints, Ints]:
    """Offsets and nodes of the branches, each with the node it begins at in front."""
    members = np.flatnonzero(branch_id >= 0)
    members = members[np.lexsort((depth[members], branch_id[members]))]
    sizes = np.bincount(branch_id[members])
    starts = np.cumsum(sizes) - sizes
    nodes = np.insert(members, starts, parent[members[starts]])
    return np.concatenate([[0], np.cumsum(sizes + 1)]).astype(np.int64), nodes
>>>>>>> interior
