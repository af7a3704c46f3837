"""A tree as vtkPolyData: nodes as points with the arrays other tools read, lines from parent to son, and back."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.errors import InputError
from tetraskel.kernels.forest import Forest, complete_forest
from tetraskel.kernels.node_arrays import forest_arrays
from tetraskel.vtkfilters.convert import (
    add_arrays,
    add_facts,
    array_of,
    copy_rows,
    fact,
    pass_facts,
    to_cells,
    to_points,
)

NEEDED = ("NodeId", "ParentId", "Depth", "TreeId")


def fill_tree(output: vtkPolyData, positions: np.ndarray, forest: Forest, traversal: str) -> None:
    """Points, lines and the forest's arrays; a node without lines is a vertex, so that it can be seen."""
    output.SetPoints(to_points(positions))
    sons = np.flatnonzero(forest.parent >= 0)
    output.SetLines(to_cells(np.stack([forest.parent[sons], sons], axis=1)))
    alone = np.flatnonzero((forest.parent < 0) & (forest.son_count == 0))
    if len(alone):
        output.SetVerts(to_cells(alone[:, None]))
    add_arrays(output.GetPointData(), forest_arrays(forest))
    output.GetPointData().SetActiveScalars("Depth")
    counts = {"Trees": int((forest.parent < 0).sum()), "Leaves": int(forest.is_leaf.sum())}
    add_facts(output, {"Traversal": traversal, **counts})


def forest_of(data: vtkPolyData) -> tuple[Forest, str]:
    """The forest and the traversal that a tree's polygonal data hold.

    Raises
    ------
    InputError
        When arrays are missing or do not describe a forest.
    """
    arrays = {name: array_of(data.GetPointData(), name) for name in NEEDED}
    missing = [name for name, values in arrays.items() if values is None]
    if missing and data.GetNumberOfPoints():
        raise InputError(
            f"expected a tree with the point arrays {', '.join(NEEDED)}, got data without {', '.join(missing)}; "
            "connect the output of TreeBuilder."
        )
    if data.GetPointData().HasArray("NodeType"):
        raise InputError("expected a tree, got a skeleton made of one; connect the output of TreeBuilder instead.")
    if missing:
        arrays = dict.fromkeys(NEEDED, np.empty(0, np.int32))
    _check_forest(*arrays.values())
    forest = complete_forest(*(arrays[name].astype(np.int32) for name in ("ParentId", "Depth", "TreeId")))
    return forest, fact(data, "Traversal", "breadth")


def _check_forest(node: np.ndarray, parent: np.ndarray, depth: np.ndarray, tree: np.ndarray) -> None:
    """Raise `InputError` unless parents come before their sons, a level above them, in the same tree."""
    numbers = all(values.ndim == 1 and values.dtype.kind in "iu" for values in (node, parent, depth, tree))
    if not numbers or not np.array_equal(node, np.arange(len(node))) or (parent >= node).any() or (parent < -1).any():
        raise InputError("expected nodes numbered from 0, parents before sons, got others; build the tree again.")
    sons = np.flatnonzero(parent >= 0)
    above = parent[sons]
    roots = tree[parent < 0]
    whole = (depth[sons] == depth[above] + 1).all() and (tree[sons] == tree[above]).all()
    if not whole or (depth[parent < 0] != 0).any() or len(np.unique(roots)) != len(roots):
        raise InputError("expected sons one level below their parents, in one tree, got others; build the tree again.")


def copy_node_arrays(source: vtkPolyData, output: vtkPolyData, rows: np.ndarray, skip: tuple[str, ...] = ()) -> None:
    """Carry the node arrays that `output` does not have yet, and the field data."""
    copy_rows(source.GetPointData(), output.GetPointData(), rows, skip)
    pass_facts(source, output)
