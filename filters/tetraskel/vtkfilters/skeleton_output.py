"""The filter that draws a tree as a skeleton."""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.skeleton import skeleton_of
from tetraskel.options import SkeletonOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, points_of, to_cells, to_points
from tetraskel.vtkfilters.treedata import copy_node_arrays, forest_of


class SkeletonOutput(SkeletonFilter):
    """A tree to its skeleton: without the leaves, one polyline per branch, junction points shared.

    Point arrays: those of the tree (`NodeId` and `ParentId` keep the tree's numbers), `NodeDegree`, `NodeType` (0 end,
    1 regular, 2 junction) and `BranchId`. Cell arrays: `BranchId` and `Length` of each branch.
    """

    options = SkeletonOptions
    input_doc = "A tree from TreeBuilder or FlatTetraRemoval."
    input_type = "vtkPolyData"
    drawn_as = ("lines",)
    tells = {  # noqa: RUF012
        "Points": "Nodes that are drawn.",
        "Lines": "Branches, each a polyline.",
        "FlatRemoved": "Flat simplices that were removed before.",
    }

    def execute(self, inputs, outputs):
        """Leave out the leaves and join the rest into branches."""
        source, output = inputs[0], outputs[0]
        forest, _ = forest_of(source)
        skeleton = skeleton_of(forest, points_of(source), keep_leaves=self.keep_leaves)
        output.SetPoints(to_points(skeleton.points))
        output.SetLines(to_cells(skeleton.branch_nodes, skeleton.branch_offsets))
        alone = np.flatnonzero(skeleton.degree == 0)
        if len(alone):
            output.SetVerts(to_cells(alone[:, None]))
        copy_node_arrays(source, output, skeleton.node)
        output.GetPointData().SetActiveScalars("Depth")
        arrays = {
            "NodeDegree": skeleton.degree.astype(np.int32),
            "NodeType": skeleton.node_type.astype(np.uint8),
            "BranchId": skeleton.branch_id.astype(np.int32),
        }
        add_arrays(output.GetPointData(), arrays)
        add_arrays(output.GetCellData(), _branch_arrays(skeleton, len(alone)))


def _branch_arrays(skeleton, n_alone):
    """Cell arrays: VTK puts the vertices of nodes that stand alone before the lines."""
    lengths = np.concatenate([np.zeros(n_alone), skeleton.branch_lengths])
    ids = np.concatenate([np.full(n_alone, -1), np.arange(len(skeleton.branch_lengths))])
    return {"BranchId": ids.astype(np.int32), "Length": lengths}
