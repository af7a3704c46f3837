"""The arrays that describe the nodes of trees and skeletons, under the names and in the types other tools read."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.centres import circumballs
from tetraskel.kernels.chunks import Tick, part, silent
from tetraskel.kernels.quality import qualities
from tetraskel.kernels.tree import Tree

Arrays = dict[str, NDArray[Any]]
Ints = NDArray[Any]


class Numbered(Protocol):
    """Nodes of a forest: all of them, or one rank's."""

    @property
    def number(self) -> Ints:
        """(k,) number of each."""

    @property
    def parent(self) -> Ints:
        """(k,) number of the parent, -1 for a root."""

    @property
    def depth(self) -> Ints:
        """(k,) facets crossed since the root."""

    @property
    def son_rank(self) -> Ints:
        """(k,) place among the parent's sons."""

    @property
    def son_count(self) -> Ints:
        """(k,) number of sons."""

    @property
    def subtree_size(self) -> Ints:
        """(k,) number of nodes from here down."""

    @property
    def tree_id(self) -> Ints:
        """(k,) which tree."""


class Drawn(Protocol):
    """Nodes of a skeleton: all of them, or one rank's."""

    @property
    def degree(self) -> Ints:
        """(k,) number of lines that meet."""

    @property
    def node_type(self) -> Ints:
        """(k,) 0 end, 1 regular, 2 junction."""

    @property
    def branch_id(self) -> Ints:
        """(k,) branch of each, -1 for none."""


def forest_arrays(forest: Numbered) -> Arrays:
    """What a forest says of its nodes; ids have 64 bits, the rest 32 or 8."""
    return {
        "NodeId": forest.number.astype(np.int64),
        "ParentId": forest.parent.astype(np.int64),
        "Depth": forest.depth.astype(np.int32),
        "SonRank": forest.son_rank.astype(np.int32),
        "SonCount": forest.son_count.astype(np.int32),
        "SubtreeSize": forest.subtree_size.astype(np.int32),
        "TreeId": forest.tree_id.astype(np.int32),
        "IsLeaf": np.asarray(forest.son_count == 0),
    }


def simplex_arrays(tree: Tree, tick: Tick = silent) -> Arrays:
    """What the simplices of a tree say of its nodes; ids are those of the tree's mesh."""
    quality = qualities(tree.mesh, part(tick, 0.0, 0.3))
    radius, contains = circumballs(tree.mesh, part(tick, 0.3, 1.0))
    return {
        "CellId": tree.cell.astype(np.int64),
        "ApexId": tree.apex.astype(np.int64),
        "EntryFacet": tree.entry_facet.astype(np.int64),
        "Quality": quality[tree.cell],
        "Radius": radius[tree.cell],
        "ContainsCircumcentre": contains[tree.cell],
    }


def skeleton_arrays(skeleton: Drawn) -> Arrays:
    """What a skeleton says of its nodes."""
    return {
        "NodeDegree": skeleton.degree.astype(np.int32),
        "NodeType": skeleton.node_type.astype(np.uint8),
        "BranchId": skeleton.branch_id.astype(np.int32),
    }
