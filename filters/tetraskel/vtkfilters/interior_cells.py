"""The filter that tells inside from outside."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkDataObject

from tetraskel.distributed.interior import interior_of_part
from tetraskel.errors import InputError, InsideWarning
from tetraskel.kernels.gates import gate_arrays, gate_tree
from tetraskel.kernels.interior import interior
from tetraskel.kernels.mesh import submesh
from tetraskel.kernels.object_boundary import boundary_of
from tetraskel.kernels.outline import inside_by_outline
from tetraskel.options import InteriorCellsOptions, InteriorOptions
from tetraskel.vtkfilters import ranks, ranks_tree
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import (
    add_arrays,
    add_facts,
    array_of,
    copy_rows,
    fill_grid,
    mesh_of,
    pass_facts,
    points_of,
    segments_of,
    simplices_of,
    surface_of_data,
)
from tetraskel.vtkfilters.drawn_data import data_of_boundary


class InteriorCells(SkeletonFilter):
    """A mesh with a cell array Inside, 1 where a cell lies inside the object, or only these cells.

    The second output is the object's boundary: the facets between inside and outside. The object is known by the
    mesh's points alone (method gates), by a closed surface or an outline at the second input, or by a cell array. An
    outline splits cells, so that it becomes a union of their edges; all other methods leave the mesh as it is.

    On several MPI ranks a mesh that DelaunayMesh has dealt to them stays there for the method gates, and so do both
    outputs. Other meshes, and all for other methods, are gathered to the first rank.
    """

    options = InteriorCellsOptions
    input_doc = "A Delaunay mesh of tetrahedra, or of triangles of one plane."
    second_input = ("Boundary", 1, "vtkPolyData", "A closed surface, or closed lines, for the methods of these names.")
    output_type = "vtkUnstructuredGrid"
    n_outputs = 2
    output_names = ("Cells", "Boundary")
    drawn_as = ("hidden", "surface")
    tells = {  # noqa: RUF012
        "InsideCells": "Cells inside the object.",
        "Cells": "Cells of the output.",
    }

    def FillOutputPortInformation(self, port, info):
        """Called by VTK: a mesh, and its boundary."""
        info.Set(vtkDataObject.DATA_TYPE_NAME(), ("vtkUnstructuredGrid", "vtkPolyData")[port])
        return 1

    def execute(self, inputs, outputs):
        """Classify the cells."""
        source, output = inputs[0], outputs[0]
        mesh = mesh_of(source)
        if self.method == "outline" and len(mesh):
            mesh, inside = inside_by_outline(mesh, *self._outline(inputs[1]), tick=self.tick("Following the outline"))
            self._write_new_mesh(output, mesh, inside)
        else:
            inside = self._classify(source, mesh, inputs[1])
            self._write(source, output, mesh, inside)
        pass_facts(source, output)
        add_facts(output, {"InsideCells": int(np.count_nonzero(inside))})
        outputs[1].ShallowCopy(data_of_boundary(boundary_of(mesh, inside), mesh.points))

    def execute_on_ranks(self, comm, inputs, outputs):
        """Classify the cells where they are, or on the first rank."""
        if self.method == "gates" and ranks_tree.is_numbered_by_rank(comm, inputs[0]):
            self._classify_part(comm, inputs[0], outputs)
        else:
            super().execute_on_ranks(comm, inputs, outputs)

    def _classify_part(self, comm, source, outputs):
        part, own = ranks_tree.part_of_data(comm, source, all_points=True)
        options = InteriorOptions(method=self.method, ratio=self.ratio, noise=self.noise)
        told = self.tick("Telling inside from outside")
        found = interior_of_part(comm, part, options, with_arrays=self.gate_arrays, tick=told)
        for message in found.messages if comm.rank == 0 else ():
            self.warn(message)
        mesh = replace(
            part.mesh, points=points_of(source), simplices=simplices_of(source)[own], neighbors=found.neighbors
        )
        self._write_part(comm, source, outputs[0], (mesh, own, found))
        outputs[1].ShallowCopy(data_of_boundary(boundary_of(mesh, found.everywhere), mesh.points))
        ranks.name_points_alike(source, outputs[1])

    def _write_part(self, comm, source, output, classified):
        mesh, own, found = classified
        kept = np.flatnonzero(found.inside) if self.extract else np.arange(len(mesh))
        fill_grid(output, replace(mesh, simplices=mesh.simplices[kept]))
        output.GetPointData().PassData(source.GetPointData())
        ranks.name_points_alike(source, output)
        if len(mesh):
            copy_rows(source.GetCellData(), output.GetCellData(), own[kept], ("Inside", *ranks.own_arrays(source)))
        self._mark(output, found.inside[kept])
        if found.gates is not None:
            self._add_gates(output, found.gates, kept)
        first = comm.before(len(kept))
        ranks.set_global_ids(output.GetCellData(), np.arange(first, first + len(kept)), ranks.CELL_IDS)
        pass_facts(source, output)
        add_facts(output, {"InsideCells": comm.total(int(np.count_nonzero(found.inside)))})

    def _classify(self, source, mesh, boundary):
        """(m,) inside, for the methods that leave the mesh as it is; warnings are printed in one line."""
        surface = self._surface(boundary) if self.method == "surface" else None
        labels = array_of(source.GetCellData(), self.label_array) if self.method == "array" else None
        if self.method == "array" and labels is None and len(mesh):
            raise InputError(f"expected a cell array {self.label_array!r} on the mesh, got none; name another one.")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", InsideWarning)
            inside = interior(
                mesh,
                method=self.method,
                ratio=self.ratio,
                noise=self.noise,
                surface=surface,
                labels=labels,
                tick=self.tick("Telling inside from outside"),
            )
        for warning in caught:
            self.warn(str(warning.message))
        return inside

    def _surface(self, boundary):
        if boundary is None:
            raise InputError("expected a closed surface at the second input, got nothing; connect one.")
        return surface_of_data(boundary)

    def _outline(self, boundary):
        if boundary is None:
            raise InputError("expected closed lines at the second input, got nothing; connect an outline.")
        segments = [segments_of(boundary.GetLines(), closed=False), segments_of(boundary.GetPolys(), closed=True)]
        return points_of(boundary), np.concatenate(segments)

    def _write(self, source, output, mesh, inside):
        kept = inside if self.extract else np.ones(len(mesh), bool)
        fill_grid(output, submesh(mesh, kept))
        output.GetPointData().PassData(source.GetPointData())
        copy_rows(source.GetCellData(), output.GetCellData(), np.flatnonzero(kept), ("Inside",))
        self._mark(output, inside[kept])
        if self.gate_arrays and self.method == "gates":
            self._add_gates(output, gate_arrays(gate_tree(mesh), mesh.neighbors), kept)

    def _write_new_mesh(self, output, mesh, inside):
        kept = inside if self.extract else np.ones(len(mesh), bool)
        fill_grid(output, submesh(mesh, kept))
        self._mark(output, inside[kept])
        add_arrays(output.GetPointData(), {"OriginalPointIds": mesh.original_ids})

    @staticmethod
    def _add_gates(output, found, kept):
        named = {"GateWidth": found.width, "RoomRadius": found.room_radius, "GateParent": found.parent}
        add_arrays(output.GetCellData(), {name: values[kept] for name, values in named.items()})

    @staticmethod
    def _mark(output, inside):
        add_arrays(output.GetCellData(), {"Inside": inside})
        output.GetCellData().SetActiveScalars("Inside")
