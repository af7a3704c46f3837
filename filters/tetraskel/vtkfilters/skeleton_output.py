"""The filter that draws a tree as a skeleton."""

from __future__ import annotations

import numpy as np

from tetraskel.distributed.skeleton import lines_of, skeleton_part
from tetraskel.kernels.skeleton import skeleton_of
from tetraskel.options import SkeletonOptions
from tetraskel.vtkfilters import ranks, ranks_tree
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, points_of, to_cells, to_points
from tetraskel.vtkfilters.treedata import copy_node_arrays, forest_of


class SkeletonOutput(SkeletonFilter):
    """A tree to its skeleton: without the leaves, one polyline per branch, junction points shared.

    Point arrays: those of the tree (`NodeId` and `ParentId` keep the tree's numbers), `NodeDegree`, `NodeType` (0 end,
    1 regular, 2 junction) and `BranchId`. Cell arrays: `BranchId` and `Length` of each branch.

    On several MPI ranks a branch on more than one of them is a line on each, with the length of the whole branch.
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

    def execute_on_ranks(self, comm, inputs, outputs):
        """Draw the skeleton of the tree of all ranks; each rank draws its nodes and the lines that lead to them."""
        source, output = inputs[0], outputs[0]
        if not ranks_tree.is_spread_tree(comm, source):
            super().execute_on_ranks(comm, inputs, outputs)
            return
        forest, own = ranks_tree.forest_part_of(comm, source)
        skeleton = skeleton_part(comm, forest, keep_leaves=self.keep_leaves)
        rows = own[skeleton.node]
        lines = lines_of(comm, skeleton, points_of(source)[rows])
        output.SetPoints(to_points(lines.points))
        output.SetLines(to_cells(lines.nodes, lines.offsets))
        alone = np.flatnonzero(skeleton.degree == 0)
        if len(alone):
            output.SetVerts(to_cells(alone[:, None]))
        arrays = {
            "NodeDegree": skeleton.degree.astype(np.int32),
            "NodeType": skeleton.node_type.astype(np.uint8),
            "BranchId": skeleton.branch_id.astype(np.int32),
        }
        ranks_tree.add_node_arrays(output, source.GetPointData(), rows, arrays, len(lines.ghosts))
        ids = np.concatenate([skeleton.index, lines.ghosts])
        ranks.set_global_ids(output.GetPointData(), ids, ranks.POINT_IDS)
        add_arrays(output.GetCellData(), _cell_arrays(lines.branch_id, lines.lengths, len(alone)))
        output.GetFieldData().PassData(source.GetFieldData())


def _branch_arrays(skeleton, n_alone):
    """Cell arrays: VTK puts the vertices of nodes that stand alone before the lines."""
    return _cell_arrays(np.arange(len(skeleton.branch_lengths)), skeleton.branch_lengths, n_alone)


def _cell_arrays(branch_id, lengths, n_alone):
    lengths = np.concatenate([np.zeros(n_alone), lengths])
    ids = np.concatenate([np.full(n_alone, -1), branch_id])
    return {"BranchId": ids.astype(np.int32), "Length": lengths}
