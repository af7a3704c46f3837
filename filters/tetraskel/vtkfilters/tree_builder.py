"""The filter that walks a mesh."""

from __future__ import annotations

import numpy as np

from tetraskel.distributed.tree import build_tree_part
from tetraskel.kernels.centres import centres, circumballs
from tetraskel.kernels.quality import qualities
from tetraskel.kernels.tree import Tree, build_tree
from tetraskel.options import TreeOptions
from tetraskel.vtkfilters import ranks_tree
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, array_of, copy_rows, mesh_of, pass_facts
from tetraskel.vtkfilters.treedata import fill_tree


class TreeBuilder(SkeletonFilter):
    """A mesh of tetrahedra or of triangles to the tree of its cells: nodes as points, lines from parent to son.

    The mesh may come from DelaunayMesh or from anywhere; a mesh in pieces gives a tree per piece. The mesh's cell
    arrays become point arrays of the nodes. ApexId and EntryFacet number the mesh's points; the field array
    OriginalPointIds, if the mesh has one, leads from these to the input's.

    On several MPI ranks each has the nodes of its cells, numbered among all ranks, with CellId, ApexId and EntryFacet
    as global ids; a parent on another rank is drawn as a copy.
    """

    options = TreeOptions
    input_doc = "A mesh of tetrahedra only, or of triangles of one plane only."
    drawn_as = ("thin lines",)
    tells = {  # noqa: RUF012
        "Points": "Nodes of the tree, one for each cell.",
        "Trees": "Trees, one for each piece of the mesh.",
        "Leaves": "Nodes without sons.",
    }

    def execute(self, inputs, outputs):
        """Build the tree and describe its nodes."""
        source, output = inputs[0], outputs[0]
        self._write_whole(source, mesh_of(source), output)

    def _write_whole(self, source, mesh, output):
        tree = build_tree(mesh, traversal=self.traversal, tick=self.tick("Building the tree", 0.2, 0.6))
        positions = centres(mesh, self.centre, self.tick("Placing the nodes", 0.6, 0.7))
        fill_tree(output, positions[tree.cell], tree.forest, tree.traversal)
        copy_rows(source.GetCellData(), output.GetPointData(), tree.cell, tuple(_own_arrays(output)))
        add_arrays(output.GetPointData(), self._node_arrays(tree))
        pass_facts(source, output)
        original = array_of(source.GetPointData(), "OriginalPointIds")
        if original is not None:
            add_arrays(output.GetFieldData(), {"OriginalPointIds": original})

    def execute_on_ranks(self, comm, inputs, outputs):
        """Build the tree of the cells of all ranks; each rank describes the nodes of its own."""
        source, output = inputs[0], outputs[0]
        if self.traversal != "breadth" or not ranks_tree.is_spread(comm, source, self.warn):
            super().execute_on_ranks(comm, inputs, outputs)
            return
        part, own = ranks_tree.part_of_data(comm, source)
        tree = build_tree_part(comm, part, self.tick("Building the tree", 0.2, 0.6))
        positions = centres(part.mesh, self.centre, self.tick("Placing the nodes", 0.6, 0.7))[tree.cell]
        arrays = ranks_tree.forest_part_arrays(tree.forest)
        ranks_tree.fill_nodes(comm, output, tree.forest, positions, arrays)
        rows = own[tree.cell]
        n_copies = output.GetNumberOfPoints() - len(rows)
        described = self._part_arrays(tree)
        ranks_tree.add_node_arrays(output, source.GetCellData(), rows, described, n_copies)
        output.GetFieldData().PassData(source.GetFieldData())
        add_facts(output, {"Traversal": "breadth"})

    def _part_arrays(self, tree):
        """Arrays of one rank's nodes, with the ids that cells and points have among all ranks."""
        mesh, ids = tree.part.mesh, tree.part.point_ids
        walked = Tree(tree.forest, tree.cell, tree.entry, mesh, "breadth")
        arrays = self._node_arrays(walked)
        named = {"CellId": tree.part.cell_ids[tree.cell], "ApexId": ids[walked.apex]}
        return {**arrays, **named, "EntryFacet": ids[walked.entry_facet]}

    def _node_arrays(self, tree):
        quality = qualities(tree.mesh, self.tick("Measuring the cells", 0.7, 0.8))
        radius, contains = circumballs(tree.mesh, self.tick("Measuring the cells", 0.8, 1.0))
        return {
            "CellId": tree.cell.astype(np.int64),
            "ApexId": tree.apex.astype(np.int64),
            "EntryFacet": tree.entry_facet.astype(np.int64),
            "Quality": quality[tree.cell],
            "Radius": radius[tree.cell],
            "ContainsCircumcentre": contains[tree.cell],
        }


def _own_arrays(output):
    """Names a mesh's cell arrays must not overwrite."""
    data = output.GetPointData()
    return [data.GetArrayName(k) for k in range(data.GetNumberOfArrays())]
