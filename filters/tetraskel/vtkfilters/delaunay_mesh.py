"""The filter that triangulates points."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkDataSetAttributes

from tetraskel.distributed.space import fills_space
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.kernels.plane import roundings_by_axis
from tetraskel.kernels.points import finite_points
from tetraskel.kernels.triangulate import available_engine, ready_engine, triangulate
from tetraskel.options import DelaunayOptions
from tetraskel.vtkfilters import ranks
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, copy_rows, fill_grid, points_of, to_cells, to_points


class DelaunayMesh(SkeletonFilter):
    """Points to the tetrahedra (triangles, if they lie in a plane) of their Delaunay triangulation.

    Equal points are merged; the point array `OriginalPointIds` names the input point of each, and the other point
    arrays are carried over. Field data: `Engine`, `InputPoints`, `DuplicatesMerged` (points for which another one
    stands) and `Noise` (what was taken out, in the unit of the points).

    On several MPI ranks the cells are dealt to the ranks by place and are those of one rank, with global ids; the exact
    engine is needed for that. Points of one plane, other engines and few points are gathered to the first rank.
    """

    options = DelaunayOptions
    input_doc = "The points; cells are ignored."
    output_type = "vtkUnstructuredGrid"
    drawn_as = ("mesh",)
    tells = {  # noqa: RUF012
        "Engine": "Who computed the triangulation.",
        "InputPoints": "Points that came in.",
        "DuplicatesMerged": "Points for which another one stands, because they are equal or closer than the noise.",
        "Cells": "Tetrahedra, or triangles of a plane.",
        "Noise": "What was taken out of the points, in their unit.",
    }

    def execute(self, inputs, outputs):
        """Triangulate the points of the input."""
        source = inputs[0]
        self._write_whole(source, points_of(source), np.arange(source.GetNumberOfPoints()), outputs[0])

    def _write_whole(self, source, points, ids, grid):
        options = {"engine": self.engine, "joggle": self.joggle, "denoise": self.denoise}
        mesh = triangulate(points, **options, tick=self.tick("Triangulating"))
        fill_grid(grid, mesh)
        copy_rows(source.GetPointData(), grid.GetPointData(), mesh.original_ids)
        add_arrays(grid.GetPointData(), {"OriginalPointIds": np.asarray(ids, np.int64)[mesh.original_ids]})
        grid.GetFieldData().PassData(source.GetFieldData())
        facts = {"Engine": mesh.engine, "InputPoints": len(mesh.point_map), "DuplicatesMerged": mesh.n_merged}
        add_facts(grid, {**facts, "Noise": mesh.noise})

    def execute_on_ranks(self, comm, inputs, outputs):
        """Triangulate the points of all ranks: together, or on the first rank where that is better or needed."""
        source = inputs[0]
        own, ids = ranks.numbered_points(comm, source)
        points = points_of(source)[own]
        if self._is_for_one_rank(comm, points):
            whole, all_ids = ranks.gathered_points(comm, source, own, ids)
            if comm.rank == 0:
                self._write_whole(whole, points_of(whole), all_ids, outputs[0])
            return
        found = triangulate_part(comm, points, ids, self.tick("Triangulating"))
        self._write_part(comm, source, own, found, outputs[0])

    def _is_for_one_rank(self, comm, points) -> bool:
        """Whether the first rank is to do all the work; where that is not for few points, it says why."""
        n = comm.total(len(points))
        whole = finite_points(points)  # what is wrong with them is said by the rank that has them
        exact = available_engine(self.engine) == "exact" and ready_engine(self.engine, 3) == "exact"
        if comm.total(int(not exact)):
            reason = "only the exact engine gives one triangulation on many ranks"
        elif self.joggle or self.denoise:
            reason = "displaced and denoised points are treated on one rank"
        elif not fills_space(comm, whole, roundings_by_axis(whole, points.dtype)):
            reason = "points of one plane are treated on one rank"
        else:
            return n < self.gather_below
        if comm.rank == 0 and n >= self.gather_below:
            self.warn(f"all {n} points are gathered to the first rank: {reason}.")
        return True

    def _write_part(self, comm, source, own, found, grid):
        part, origins = found.part, found.origins
        grid.SetPoints(to_points(part.mesh.points))
        if len(part):
            grid.SetCells(VTK_TETRA, to_cells(part.mesh.simplices))
        arrays = ranks.fetched_arrays(comm, source.GetPointData(), origins[:, 1], origins[:, 2], own)
        add_arrays(grid.GetPointData(), {**arrays, "OriginalPointIds": origins[:, 0]})
        ranks.set_global_ids(grid.GetPointData(), part.point_ids, ranks.POINT_IDS)
        ranks.set_global_ids(grid.GetCellData(), part.cell_ids, ranks.CELL_IDS)
        ranks.mark_copies(grid.GetPointData(), ~found.owned, vtkDataSetAttributes.DUPLICATEPOINT)
        grid.GetFieldData().PassData(source.GetFieldData())
        merged = found.n_input - found.n_distinct
        facts = {"Engine": "exact", "InputPoints": found.n_input, "DuplicatesMerged": merged, "Noise": 0.0}
        add_facts(grid, facts)
