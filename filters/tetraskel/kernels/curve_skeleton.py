"""The curve skeleton as arrays: points with radius, polylines, and what is known about each."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Bools = NDArray[np.bool_]

END, REGULAR, JUNCTION = 0, 1, 2
NODE_TYPES = ("end", "regular", "junction")


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
        0 end, 1 regular, 2 junction (`NODE_TYPES`).
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
