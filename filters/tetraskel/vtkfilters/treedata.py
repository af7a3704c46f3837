"""A tree as vtkPolyData: nodes as points with the arrays other tools read, lines from parent to son, and back."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.errors import InputError
from tetraskel.kernels.forest import Forest, complete_forest
from tetraskel.vtkfilters.convert import add_arrays, add_facts, array_of, copy_rows, fact, to_cells, to_points

NEEDED = ("NodeId", "ParentId", "Depth", "TreeId")


def forest_arrays(forest: Forest) -> dict[str, np.ndarray]:
    """The point arrays that describe a forest; ids are vtkIdType, the rest 32-bit or bytes."""
    return {
        "NodeId": np.arange(len(forest), dtype=np.int64),
        "ParentId": forest.parent.astype(np.int64),
        "Depth": forest.depth.astype(np.int32),
        "SonRank": forest.son_rank.astype(np.uint8),
        "SonCount": forest.son_count.astype(np.uint8),
        "SubtreeSize": forest.subtree_size.astype(np.int32),
        "TreeId": forest.tree_id.astype(np.int32),
        "IsLeaf": forest.is_leaf,
    }


def fill_tree(output: vtkPolyData, positions: np.ndarray, forest: Forest, traversal: str) -> None:
    """Points, lines and the forest's arrays; a node without lines is a vertex, so that it can be seen."""
    output.SetPoints(to_points(positions))
    sons = np.flatnonzero(forest.parent >= 0)
    output.SetLines(to_cells(np.stack([forest.parent[sons], sons], axis=1)))
    alone = np.flatnonzero((forest.parent < 0) & (forest.son_count == 0))
    if len(alone):
        output.SetVerts(to_cells(alone[:, None]))
    add_arrays(output.GetPointData(), forest_arrays(forest))
    add_facts(output, {"Traversal": traversal})


def forest_of(data: vtkPolyData) -> tuple[Forest, str]:
    """The forest and the traversal that a tree's polygonal data hold.

    Raises
    ------
    InputError
        When arrays are missing or do not describe a forest.
    """
    arrays = {name: array_of(data.GetPointData(), name) for name in NEEDED}
    missing = [name for name, values in arrays.items() if values is None]
    if missing:
        raise InputError(
            f"expected a tree with the point arrays {', '.join(NEEDED)}, got data without {', '.join(missing)}; "
            "connect the output of TreeBuilder."
        )
    node, parent = arrays["NodeId"], arrays["ParentId"]
    if not np.array_equal(node, np.arange(len(node))) or (parent >= node).any() or (parent < -1).any():
        raise InputError(
            "expected nodes numbered from 0, parents before sons, got another order; build the tree again."
        )
    forest = complete_forest(parent.astype(np.int32), arrays["Depth"], arrays["TreeId"])
    return forest, fact(data, "Traversal", "breadth")


def copy_node_arrays(source: vtkPolyData, output: vtkPolyData, rows: np.ndarray, skip: tuple[str, ...] = ()) -> None:
    """Carry the node arrays that `output` does not have yet, and the field data."""
    copy_rows(source.GetPointData(), output.GetPointData(), rows, skip)
    output.GetFieldData().PassData(source.GetFieldData())
