"""The filter that walks a mesh."""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.centres import centres, circumballs
from tetraskel.kernels.quality import qualities
from tetraskel.kernels.tree import build_tree
from tetraskel.options import TreeOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, array_of, copy_rows, mesh_of, pass_facts
from tetraskel.vtkfilters.treedata import fill_tree


class TreeBuilder(SkeletonFilter):
    """A mesh of tetrahedra or of triangles to the tree of its cells: nodes as points, lines from parent to son.

    The mesh may come from DelaunayMesh or from anywhere; a mesh in pieces gives a tree per piece. The mesh's cell
    arrays become point arrays of the nodes. ApexId and EntryFacet number the mesh's points; the field array
    OriginalPointIds, if the mesh has one, leads from these to the input's.
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
        mesh = mesh_of(source)
        tree = build_tree(mesh, traversal=self.traversal, tick=self.tick("Building the tree", 0.2, 0.6))
        positions = centres(mesh, self.centre, self.tick("Placing the nodes", 0.6, 0.7))
        fill_tree(output, positions[tree.cell], tree.forest, tree.traversal)
        copy_rows(source.GetCellData(), output.GetPointData(), tree.cell, tuple(_own_arrays(output)))
        add_arrays(output.GetPointData(), self._node_arrays(tree))
        pass_facts(source, output)
        original = array_of(source.GetPointData(), "OriginalPointIds")
        if original is not None:
            add_arrays(output.GetFieldData(), {"OriginalPointIds": original})

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
