"""The binary or ternary tree of a triangulation: the paper's core.

The root is the simplex behind the hull facet whose barycentre has the smallest first coordinate, then second, then
third, exact ties going to the smallest sorted point ids. A mesh in several pieces gives a tree per piece, numbered
in the order of their root facets by the same rule.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError, MeshError
from tetraskel.kernels.chunks import Tick, silent
from tetraskel.kernels.forest import Forest, complete_forest
from tetraskel.kernels.mesh import Triangulation, expect_mesh
from tetraskel.kernels.pieces import label_pieces
from tetraskel.kernels.roots import first_facets_by_piece
from tetraskel.kernels.sons import crossing_codes
from tetraskel.kernels.traversal import Walk, walk_breadth_first, walk_depth_first
from tetraskel.options import TreeOptions

Ints = NDArray[np.integer]


@dataclass(frozen=True)
class Tree:
    """Nodes at simplices, in the order of the traversal.

    Attributes
    ----------
    forest : Forest
        Parents, depths, ranks and sizes.
    cell : (n,) int
        Simplex of each node in the mesh.
    entry : (n,) int
        Local index of the vertex opposite the entry facet.
    mesh : Triangulation
        The triangulation that was walked.
    traversal : str
        "breadth" or "depth".
    """

    forest: Forest
    cell: Ints
    entry: NDArray[np.uint8]
    mesh: Triangulation
    traversal: str

    def __len__(self) -> int:
        return len(self.cell)

    @property
    def parent(self) -> Ints:
        """(n,) parent node, -1 for a root."""
        return self.forest.parent

    @property
    def depth(self) -> Ints:
        """(n,) number of facets crossed since the root."""
        return self.forest.depth

    @property
    def son_rank(self) -> Ints:
        """(n,) place among the parent's sons, from 0."""
        return self.forest.son_rank

    @property
    def son_count(self) -> Ints:
        """(n,) number of sons."""
        return self.forest.son_count

    @property
    def subtree_size(self) -> Ints:
        """(n,) number of nodes from here down."""
        return self.forest.subtree_size

    @property
    def tree_id(self) -> Ints:
        """(n,) piece of the mesh the node belongs to."""
        return self.forest.tree_id

    @property
    def is_leaf(self) -> NDArray[np.bool_]:
        """(n,) nodes without sons."""
        return self.forest.is_leaf

    @property
    def apex(self) -> Ints:
        """(n,) point opposite the entry facet."""
        return np.asarray(self.mesh.simplices[self.cell, self.entry])

    @property
    def entry_facet(self) -> Ints:
        """(n, d) points of the entry facet, in the order of the simplex."""
        width = self.mesh.simplices.shape[1]
        columns = np.array([[v for v in range(width) if v != entry] for entry in range(width)])
        return np.asarray(self.mesh.simplices[self.cell[:, None], columns[self.entry]])


def build_tree(mesh: Triangulation, *, traversal: str = TreeOptions.traversal, tick: Tick = silent) -> Tree:
    """Walk the triangulation from its first hull facet: one node per simplex.

    Parameters
    ----------
    mesh : Triangulation
        m simplices in any number of pieces.
    traversal : {"breadth", "depth"}
        First-in-first-out queue, or first sons first.
    tick : callable, optional
        Told the share of work done; may raise `Aborted`.

    Returns
    -------
    Tree
        m nodes, numbered tree by tree in the order of the traversal.

    Raises
    ------
    InputError
        For an unknown traversal, or what is not a mesh.
    MeshError
        For a piece without border: its simplices are doubled or overlap.
    """
    expect_mesh(mesh)
    TreeOptions(traversal=traversal)
    codes = crossing_codes(mesh, tick)
    walk, tree_id = _walk_pieces(mesh, codes, traversal, tick)
    forest = complete_forest(walk.parent, walk.depth, tree_id)
    return Tree(forest, walk.cell, walk.entry, mesh, traversal)


def expect_tree(tree: object) -> None:
    """Raise `InputError` for anything but a `Tree`."""
    if not isinstance(tree, Tree):
        raise InputError(f"expected a Tree, got {type(tree).__name__}; make one with build_tree.")


def _walk_pieces(mesh: Triangulation, codes: NDArray[np.uint8], traversal: str, tick: Tick) -> tuple[Walk, Ints]:
    """The walk over everything and the tree of each node; pieces are looked for only when one walk is not enough."""
    walk_from = walk_breadth_first if traversal == "breadth" else walk_depth_first
    one_piece = np.zeros(len(mesh), np.int32)
    walk = walk_from(mesh.neighbors, codes, *first_facets_by_piece(mesh, one_piece), tick)
    if len(walk.cell) == len(mesh):
        return walk, one_piece
    pieces = label_pieces(mesh.neighbors)
    root_cells, root_entries = first_facets_by_piece(mesh, pieces)
    walk = walk_from(mesh.neighbors, codes, root_cells, root_entries, tick)
    if len(walk.cell) < len(mesh):
        closed = len(mesh) - len(walk.cell)
        raise MeshError(f"expected pieces with a border, got {closed} simplices without one; remove doubled cells.")
    tree_of_piece = np.empty(int(pieces.max()) + 1, np.int32)
    tree_of_piece[pieces[root_cells]] = np.arange(len(root_cells), dtype=np.int32)
    return _tree_by_tree(walk, tree_of_piece[pieces[walk.cell]])


def _tree_by_tree(walk: Walk, tree_id: Ints) -> tuple[Walk, Ints]:
    """Renumber nodes so that trees follow one another, in the same order inside each."""
    order = np.argsort(tree_id, kind="stable")
    number = np.empty(len(order) + 1, np.int32)
    number[order] = np.arange(len(order), dtype=np.int32)
    number[-1] = -1  # no parent
    parent = number[walk.parent[order]]
    return Walk(walk.cell[order], walk.entry[order], parent, walk.depth[order]), tree_id[order]
