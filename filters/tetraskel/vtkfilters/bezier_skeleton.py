"""The filter that draws a skeleton's branches as smooth curves."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import VTK_BEZIER_CURVE, vtkDataObject, vtkUnstructuredGrid

from tetraskel.kernels.bezier_skeleton import BezierSkeleton as Curves
from tetraskel.kernels.bezier_skeleton import bezier_skeleton
from tetraskel.options import BezierOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import add_arrays, add_facts, array_of, to_cells, to_points
from tetraskel.vtkfilters.curve_skeleton import fill_skeleton
from tetraskel.vtkfilters.skeletondata import balls_of

ENDS_FIRST = [0, 3, 1, 2]  # VTK's order of a cubic cell's points


class BezierSkeleton(SkeletonFilter):
    """A skeleton to smooth curves: every branch as cubic Bezier pieces, with its radius, inside its own balls.

    Ends and junctions stay. The first output is sampled lines with the arrays of a curve skeleton and Curvature and
    Torsion, ready for SkeletonSurface; the second has the pieces as Bezier cells, whose points are the control points.
    """

    options = BezierOptions
    input_doc = "A skeleton: lines with a point array of radii."
    input_type = "vtkPolyData"
    n_outputs = 2
    output_names = ("Curves", "Pieces")
    drawn_as = ("lines", "hidden")
    tells = {  # noqa: RUF012
        "Components": "Connected pieces of the skeleton.",
        "Loops": "Loops of the skeleton.",
        "Lines": "Branches, each a smooth curve.",
        "Pieces": "Cubic Bezier pieces of all curves.",
    }

    def FillOutputPortInformation(self, port, info):
        """Called by VTK: lines, then cells."""
        info.Set(vtkDataObject.DATA_TYPE_NAME(), ("vtkPolyData", "vtkUnstructuredGrid")[port])
        return 1

    def execute(self, inputs, outputs):
        """Fit and sample."""
        source = inputs[0]
        parent = array_of(source.GetPointData(), "ParentId")
        curves = bezier_skeleton(
            balls_of(source, self.radius_array),
            tolerance=self.tolerance,
            samples=self.samples,
            roots=None if parent is None else np.flatnonzero(parent < 0),
            tick=self.tick("Fitting curves"),
        )
        outputs[0].GetFieldData().PassData(source.GetFieldData())
        kept = {name: array_of(source.GetFieldData(), name) for name in ("LoopsRefused", "Cavities")}
        fill_skeleton(outputs[0], curves.skeleton)
        add_arrays(outputs[0].GetFieldData(), {name: values for name, values in kept.items() if values is not None})
        add_arrays(outputs[0].GetPointData(), {"Curvature": curves.curvature, "Torsion": curves.torsion})
        add_facts(outputs[0], {**graph_facts(curves), "Pieces": len(curves)})
        fill_pieces(outputs[1], curves)


def graph_facts(curves: Curves) -> dict[str, int]:
    """Components and loops of the drawn graph."""
    skeleton = curves.skeleton
    components = int(skeleton.component.max(initial=-1)) + 1
    return {"Components": components, "Loops": len(skeleton.edges) - len(skeleton) + components}


def fill_pieces(grid: vtkUnstructuredGrid, curves: Curves) -> None:
    """A Bezier cell for each piece, with points of its own."""
    n = len(curves)
    control = curves.control[:, ENDS_FIRST]
    grid.SetPoints(to_points(control.reshape(-1, control.shape[2])))
    grid.SetCells(VTK_BEZIER_CURVE, to_cells(np.arange(4 * n).reshape(n, 4)))
    radius = curves.control_radius[:, ENDS_FIRST].ravel()
    add_arrays(grid.GetPointData(), {"MaximumInscribedSphereRadius": radius})
    add_arrays(grid.GetCellData(), {"BranchId": curves.branch.astype(np.int32)})
