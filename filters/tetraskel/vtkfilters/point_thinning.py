"""The filter that keeps as many points of a surface as its curve skeleton needs."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.distributed.thinning import first_with_each, thinned_on_ranks
from tetraskel.kernels.thinning import Thinned, thinned
from tetraskel.options import ThinningOptions
from tetraskel.vtkfilters import ranks
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, copy_rows, pass_facts, points_of, to_cells, to_points


class PointThinning(SkeletonFilter):
    """Points of a surface to fewer of them, as dense as its curve skeleton needs them.

    Many are kept where the object or a gap in it is thin, few where it is wide. Points keep their coordinates and
    arrays; `OriginalPointIds` names the input point of each, and `Spacing` the side of the cell it stands for: every
    point of that cell is within 1.74 times as much of it, and where it is 0 there is no other. No normals are needed,
    and the order of the points does not matter.

    On several MPI ranks each rank keeps some of its own points, and together they are those of one rank. Put it before
    `CurveSkeleton` for objects that do not fit the first rank.
    """

    options = ThinningOptions
    input_doc = "Points on the surface of an object; cells are ignored."
    drawn_as = ("cloud",)
    tells = {  # noqa: RUF012
        "InputPoints": "Points that came in.",
        "KeptPoints": "Points that are left.",
        "CoarsePoints": "Kept points that stand for more of the surface than asked, as no more may be kept.",
    }

    def execute(self, inputs, outputs):
        """Choose the points, and write them."""
        source, points = inputs[0], points_of(inputs[0])
        found = thinned(points, **self._values, tick=self.tick("Thinning the points"))
        outputs[0].ShallowCopy(data_of_thinned(points[found.ids], found, len(points)))
        self._pass(source, outputs[0], found.ids)

    def execute_on_ranks(self, comm, inputs, outputs):
        """Choose among the points of all ranks; each writes those of its own."""
        source = inputs[0]
        own, ids = ranks.numbered_points(comm, source)
        once = first_with_each(comm, ids)
        own, ids = own[once], ids[once]
        points = points_of(source)[own]
        found = thinned_on_ranks(comm, points, ids, ThinningOptions(**self._values), self.tick("Thinning the points"))
        rows = np.flatnonzero(np.isin(ids, found.ids))
        place = np.searchsorted(found.ids, ids[rows])
        mine = Thinned(ids[rows], found.spacing[place], found.n_coarse)
        outputs[0].ShallowCopy(data_of_thinned(points[rows], mine, comm.total(len(own))))
        add_facts(outputs[0], {"KeptPoints": len(found)})
        self._pass(source, outputs[0], own[rows])
        ranks.set_global_ids(outputs[0].GetPointData(), ids[rows], ranks.POINT_IDS)

    @staticmethod
    def _pass(source, output, rows):
        """Carry over the arrays of the points that are kept, and the field data."""
        ids = source.GetPointData().GetGlobalIds()
        skip = ("OriginalPointIds", "Spacing", ranks.GHOSTS, *([] if ids is None else [ids.GetName()]))
        copy_rows(source.GetPointData(), output.GetPointData(), rows, skip)
        output.GetPointData().SetActiveScalars("Spacing")
        pass_facts(source, output)


def data_of_thinned(points: np.ndarray, found: Thinned, n_input: int) -> vtkPolyData:
    """The points that are kept, as a cloud with their ids and spacing; coordinates keep their type."""
    output = vtkPolyData()
    if points.shape[1] == 3 and points.dtype in (np.float32, np.float64) and points.dtype.isnative:
        output.SetPoints(vtkPoints())
        output.GetPoints().SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    else:
        output.SetPoints(to_points(points))
    output.SetVerts(to_cells(np.arange(len(points))[:, None]))
    add_arrays(output.GetPointData(), {"OriginalPointIds": found.ids, "Spacing": found.spacing})
    output.GetPointData().SetActiveScalars("Spacing")
    add_facts(output, {"InputPoints": n_input, "KeptPoints": len(found), "CoarsePoints": found.n_coarse})
    return output
