"""The filter that walks a mesh."""

from __future__ import annotations

from tetraskel.distributed.tree import build_tree_part, simplex_arrays_of_part
from tetraskel.kernels.centres import centres
from tetraskel.kernels.node_arrays import simplex_arrays
from tetraskel.kernels.tree import build_tree
from tetraskel.options import TreeOptions
from tetraskel.vtkfilters import ranks_tree
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, array_of, copy_rows, mesh_of, pass_facts
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
        add_arrays(output.GetPointData(), simplex_arrays(tree, self.tick("Measuring the cells", 0.7, 1.0)))
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
        copies = ranks_tree.fill_nodes(comm, output, tree.forest, positions)
        rows = own[tree.cell]
        described = simplex_arrays_of_part(tree, self.tick("Measuring the cells", 0.7, 1.0))
        ranks_tree.add_node_arrays(comm, output, source.GetCellData(), rows, described, copies)
        pass_facts(source, output)


def _own_arrays(output):
    """Names a mesh's cell arrays must not overwrite."""
    data = output.GetPointData()
    return [data.GetArrayName(k) for k in range(data.GetNumberOfArrays())]
