"""The filter that removes flat simplices from a tree or a mesh."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataObjectTypes

from tetraskel.distributed.flat import contract_part
from tetraskel.errors import InputError
from tetraskel.kernels.flat import all_flat, contract
from tetraskel.kernels.mesh import submesh
from tetraskel.kernels.node_arrays import forest_arrays
from tetraskel.kernels.quality import qualities
from tetraskel.options import FlatOptions
from tetraskel.vtkfilters import ranks_tree
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import (
    add_facts,
    array_of,
    copy_rows,
    fill_grid,
    mesh_of,
    pass_facts,
    points_of,
    to_cells,
)
from tetraskel.vtkfilters.treedata import copy_node_arrays, fill_tree, forest_of


class FlatTetraRemoval(SkeletonFilter):
    """Remove simplices of quality 1/Qk below a threshold: contracted in a tree, dropped from a mesh.

    In a tree the sons of a flat node move to its nearest kept ancestor; the output has the same arrays, those of the
    hierarchy computed anew. Field data: `FlatRemoved`.
    """

    options = FlatOptions
    input_doc = "A tree from TreeBuilder, or a mesh of tetrahedra or triangles."
    output_type = "vtkPointSet"
    drawn_as = ("thin lines",)
    tells = {  # noqa: RUF012
        "FlatRemoved": "Flat simplices that were removed.",
        "Points": "Nodes that are left of a tree, or points of a mesh.",
        "Cells": "Cells that are left of a mesh.",
    }

    def RequestDataObject(self, request, inInfo, outInfo):  # noqa: N803
        """Called by VTK: polygonal data stay such, all else is an unstructured grid."""
        source = self._connected(inInfo[0])
        information = outInfo.GetInformationObject(0)
        output = information.Get(vtkDataObject.DATA_OBJECT())
        wanted = "vtkPolyData" if source is not None and source.IsA("vtkPolyData") else "vtkUnstructuredGrid"
        if source is not None and (output is None or not output.IsA(wanted)):
            information.Set(vtkDataObject.DATA_OBJECT(), vtkDataObjectTypes.NewDataObject(wanted))
        return 1

    def execute(self, inputs, outputs):
        """Contract a tree, thin out a mesh."""
        source, output = inputs[0], outputs[0]
        if source.GetPointData().HasArray("ParentId"):
            removed = self._contract(source, output)
        else:
            removed = self._drop_cells(source, output)
        add_facts(output, {"FlatRemoved": removed})

    def execute_on_ranks(self, comm, inputs, outputs):
        """Contract the tree of all ranks, thin out each rank's cells."""
        source, output = inputs[0], outputs[0]
        is_tree = comm.total(int(source.GetPointData().HasArray("ParentId"))) > 0
        if not is_tree:
            removed = self._drop_cells(source, output) if source.GetNumberOfCells() else 0
            add_facts(output, {"FlatRemoved": comm.total(removed)})
        elif ranks_tree.is_spread_tree(comm, source):
            self._contract_parts(comm, source, output)
        else:
            super().execute_on_ranks(comm, inputs, outputs)

    def _contract_parts(self, comm, source, output):
        forest, own = ranks_tree.forest_part_of(comm, source)
        quality = self._quality(source) if len(own) else np.empty(0)
        kept_forest, kept = contract_part(comm, forest, quality[own] < self.threshold)
        if forest.n_nodes and kept_forest.n_nodes == 0:
            raise InputError(all_flat(forest.n_nodes, self.threshold))
        copies = ranks_tree.fill_nodes(comm, output, kept_forest, points_of(source)[own[kept]])
        ranks_tree.add_node_arrays(comm, output, source.GetPointData(), own[kept], {}, copies)
        pass_facts(source, output)
        add_facts(output, {"FlatRemoved": forest.n_nodes - kept_forest.n_nodes})

    def _contract(self, source, output):
        forest, traversal = forest_of(source)
        if not source.IsA("vtkPolyData"):
            raise InputError(
                f"expected a tree as polygonal data, got {source.GetClassName()}; extract its surface first."
            )
        quality = self._quality(source)
        kept_forest, kept = contract(forest, quality < self.threshold, traversal)
        if len(forest) and len(kept) == 0:
            raise InputError(all_flat(len(forest), self.threshold))
        fill_tree(output, points_of(source)[kept], kept_forest, traversal)
        copy_node_arrays(source, output, kept, tuple(forest_arrays(kept_forest)))
        return len(forest) - len(kept)

    @staticmethod
    def _quality(source):
        quality = array_of(source.GetPointData(), "Quality")
        if quality is None or not np.isfinite(quality).all():
            raise InputError(
                "expected a tree with the point array Quality, got none or NaN; connect the output of TreeBuilder."
            )
        return quality

    def _drop_cells(self, source, output):
        mesh = mesh_of(source)
        keep = qualities(mesh, self.tick("Measuring the cells")) >= self.threshold
        rest = submesh(mesh, keep)
        if output.IsA("vtkPolyData"):
            output.SetPoints(source.GetPoints())
            output.SetPolys(to_cells(rest.simplices))
        else:
            fill_grid(output, rest)
        output.GetPointData().PassData(source.GetPointData())
        output.GetFieldData().PassData(source.GetFieldData())
        copy_rows(source.GetCellData(), output.GetCellData(), np.flatnonzero(keep))
        return int(len(mesh) - keep.sum())
