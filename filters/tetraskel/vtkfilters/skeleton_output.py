"""The filter that draws a tree as a skeleton."""

from __future__ import annotations

import numpy as np

from tetraskel.distributed.copies import Copies
from tetraskel.distributed.skeleton import Lines, lines_of, skeleton_part
from tetraskel.kernels.node_arrays import skeleton_arrays
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
        lines = Lines(
            skeleton.points, Copies(*[np.empty(0, np.int64)] * 3), skeleton.branch_offsets, skeleton.branch_nodes,
            np.arange(len(skeleton.branch_lengths)), skeleton.branch_lengths,
        )  # fmt: skip
        _draw(output, lines, np.flatnonzero(skeleton.degree == 0))
        copy_node_arrays(source, output, skeleton.node)
        output.GetPointData().SetActiveScalars("Depth")
        add_arrays(output.GetPointData(), skeleton_arrays(skeleton))

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
        _draw(output, lines, np.flatnonzero(skeleton.degree == 0))
        arrays = skeleton_arrays(skeleton)
        ranks_tree.add_node_arrays(comm, output, source.GetPointData(), rows, arrays, lines.ghosts)
        output.GetPointData().SetActiveScalars("Depth")
        ids = np.concatenate([skeleton.index, lines.ghosts.ids])
        ranks.set_global_ids(output.GetPointData(), ids, ranks.POINT_IDS)
        output.GetFieldData().PassData(source.GetFieldData())


def _draw(output, lines, alone):
    """Points, branches with their arrays, and a vertex for each node that stands alone: VTK puts these first."""
    output.SetPoints(to_points(lines.points))
    output.SetLines(to_cells(lines.nodes, lines.offsets))
    if len(alone):
        output.SetVerts(to_cells(alone[:, None]))
    ids = np.concatenate([np.full(len(alone), -1), lines.branch_id])
    lengths = np.concatenate([np.zeros(len(alone)), lines.lengths])
    add_arrays(output.GetCellData(), {"BranchId": ids.astype(np.int32), "Length": lengths})
