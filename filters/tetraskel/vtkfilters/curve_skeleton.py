"""The one-click filter: points, or a mesh with its inside, to the curve skeleton."""

from __future__ import annotations

from dataclasses import MISSING, fields

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.errors import InputError
from tetraskel.kernels.curve import CurveModel, curve_model, draw_curve
from tetraskel.kernels.curve_skeleton import Skeleton, line_edges
from tetraskel.kernels.curve_stages import stage_at
from tetraskel.kernels.medial_mesh import MedialMesh, medial_mesh
from tetraskel.options import CurveOptions
from tetraskel.vtkfilters.base import SkeletonFilter
from tetraskel.vtkfilters.convert import (
    add_arrays,
    add_facts,
    array_of,
    holds_simplices,
    points_of,
    to_cells,
    to_points,
)
from tetraskel.vtkfilters.object_input import mesh_and_labels


class CurveSkeleton(SkeletonFilter):
    """Points of a surface, or a mesh with a cell array Inside, to the curve skeleton of the object.

    Points need no normals and no closed mesh; cells of polygonal data are not looked at. A mesh of tetrahedra or of
    triangles in an unstructured grid is taken as it is: inside where its cell array Inside is not 0, or everywhere.
    The second output is the input's points with the skeleton point and the branch they belong to, the third, where
    asked for, the medial sheets. Changing the detail, the root or the sheets draws from what was computed before.
    """

    options = CurveOptions
    input_doc = "Points on the surface of an object, or a mesh with a cell array Inside."
    n_outputs = 3
    output_names = ("Skeleton", "Points", "Sheets")
    drawn_as = ("lines", "cloud", "surface")
    tells = {  # noqa: RUF012
        "Components": "Connected pieces of the skeleton.",
        "Loops": "Loops of the skeleton, those of the object.",
        "LoopsRefused": "Loops that were cut, because their narrowest passage is a gap between samples.",
        "Cavities": "Hollow spaces closed all around, which no curve can show.",
        "Lines": "Branches, each a polyline.",
        "Points": "Points of the skeleton.",
        "Engine": "Who computed the triangulation.",
        "DuplicatesMerged": "Points for which another one stands, because they are equal or closer than the noise.",
        "Noise": "What was taken out of the points, in their unit.",
    }

    def __init__(self, **values):
        self._model: CurveModel | None = None
        self._made_from: tuple | None = None
        self._sheets: tuple[float, MedialMesh] | None = None
        super().__init__(**values)

    def execute(self, inputs, outputs):
        """Compute the model where the input or its options changed, and draw it."""
        source = inputs[0]
        key = (source, source.GetMTime(), self.loop_spacings, self.denoise)
        if self._made_from != key:
            self._model, self._made_from, self._sheets = None, None, None
            self._model = self._compute(source)
            self._made_from = key
        root = self.root_point if self.root == "point" else self.root
        skeleton = draw_curve(
            self._model, detail=self.detail, root=root, tick=self.tick("Drawing the lines", 0.95, 1.0)
        )
        fill_skeleton(outputs[0], skeleton)
        outputs[0].GetFieldData().PassData(source.GetFieldData())
        add_facts(outputs[0], {"Dimension": self._model.inner.mesh.dim})
        if not holds_simplices(source):  # a mesh brings these facts from where it was made
            mesh = self._model.inner.mesh
            add_facts(outputs[0], {"Engine": mesh.engine, "DuplicatesMerged": mesh.n_merged, "Noise": mesh.noise})
        _fill_points(source, outputs[1], skeleton)
        if self.sheets:
            fill_sheets(outputs[2], self._medial_mesh())

    def _medial_mesh(self):
        """The sheets of the model at this angle; another detail needs no others."""
        if self._sheets is None or self._sheets[0] != self.sheet_angle:
            tick = self.tick("Finding the sheets", 0.9, 1.0)
            self._sheets = (self.sheet_angle, medial_mesh(self._model, sheet_angle=self.sheet_angle, tick=tick))
        return self._sheets[1]

    def _compute(self, source):
        mesh, inside = mesh_and_labels(source, self.tick("Triangulating", 0.0, 0.5), denoise=self.denoise)
        tick = self.tick(stage_at, 0.0 if holds_simplices(source) else 0.5, 0.95)
        return curve_model(mesh, inside=inside, loop_spacings=self.loop_spacings, tick=tick)


def fill_skeleton(output: vtkPolyData, skeleton) -> None:
    """A skeleton as polygonal data: a polyline per branch, shared junctions, arrays and facts."""
    output.SetPoints(to_points(skeleton.points))
    alone = np.flatnonzero(skeleton.node_degree == 0)
    if len(alone):
        output.SetVerts(to_cells(alone[:, None]))
    output.SetLines(to_cells(skeleton.connectivity, skeleton.offsets))
    add_arrays(output.GetPointData(), _point_arrays(skeleton))
    add_arrays(output.GetCellData(), _branch_arrays(skeleton, len(alone)))
    output.GetPointData().SetActiveScalars("MaximumInscribedSphereRadius")
    facts = {"Components": skeleton.components, "Loops": skeleton.loops, "LoopsRefused": skeleton.loops_refused}
    add_facts(output, {**facts, "Cavities": skeleton.cavities})


def fill_sheets(output: vtkPolyData, sheets: MedialMesh) -> None:
    """Medial sheets as triangles with radii on the points and object angles on the cells."""
    output.SetPoints(to_points(sheets.points))
    output.SetPolys(to_cells(sheets.triangles))
    add_arrays(output.GetPointData(), {"MaximumInscribedSphereRadius": sheets.radius})
    add_arrays(output.GetCellData(), {"ObjectAngle": sheets.angle})
    output.GetPointData().SetActiveScalars("MaximumInscribedSphereRadius")


def skeleton_from(data: vtkPolyData) -> Skeleton:
    """The skeleton in polygonal data with polylines and radii, as far as measures need it; other arrays are empty.

    Raises
    ------
    InputError
        When there are no lines or no radii, or a line has no length.
    """
    if not isinstance(data, vtkPolyData):
        raise InputError(
            f"expected a skeleton as polygonal data, got {data.GetClassName()}; extract its surface first."
        )
    radius = array_of(data.GetPointData(), "MaximumInscribedSphereRadius")
    if radius is None or data.GetNumberOfLines() == 0:
        raise InputError("expected lines with the point array MaximumInscribedSphereRadius, got none.")
    lines, points = data.GetLines(), points_of(data)
    offsets, ids = (vtk_to_numpy(array) for array in (lines.GetOffsetsArray(), lines.GetConnectivityArray()))
    short = int((np.diff(offsets) < 2).sum())
    if short:
        raise InputError(f"expected lines through two points or more, got {short} of {len(offsets) - 1} through fewer.")
    edges = line_edges(offsets, ids)
    long = np.sqrt(((points[edges[:, 1]] - points[edges[:, 0]]) ** 2).sum(axis=1))
    degree = np.bincount(edges.ravel(), minlength=len(points))
    lengths = np.add.reduceat(long, offsets[:-1] - np.arange(len(offsets) - 1))
    empty = {field.name: np.empty(0) for field in fields(Skeleton) if field.default is MISSING}
    known = {"points": points, "radius": radius, "offsets": offsets, "connectivity": ids, "node_degree": degree}
    return Skeleton(**{**empty, **known, "branch_length": lengths})


def _point_arrays(skeleton):
    return {
        "MaximumInscribedSphereRadius": skeleton.radius,
        "Depth": skeleton.depth.astype(np.int32),
        "ParentId": skeleton.parent.astype(np.int64),
        "BranchId": skeleton.branch_id.astype(np.int32),
        "ComponentId": skeleton.component.astype(np.int32),
        "NodeType": skeleton.node_type.astype(np.uint8),
        "NodeDegree": skeleton.node_degree.astype(np.int32),
        "StrahlerOrder": skeleton.strahler_order.astype(np.int32),
        "Abscissas": skeleton.abscissa,
        "Blanking": skeleton.blanking.astype(np.uint8),
    }


def _branch_arrays(skeleton, n_alone):
    """Cell arrays; VTK puts the vertices of points that stand alone before the lines."""
    arrays = {
        "BranchId": np.arange(skeleton.n_branches, dtype=np.int32),
        "GroupIds": skeleton.branch_group.astype(np.int32),
        "Blanking": skeleton.branch_blanking.astype(np.int32),
        "Length": skeleton.branch_length,
        "Tortuosity": skeleton.branch_tortuosity,
        "MeanRadius": skeleton.branch_radius,
        "StrahlerOrder": skeleton.branch_strahler.astype(np.int32),
    }
    return {name: np.concatenate([np.zeros(n_alone, values.dtype), values]) for name, values in arrays.items()}


def _fill_points(source, output, skeleton):
    """The input's points, with its own cells if it is polygonal data, and where each belongs."""
    if source.IsA("vtkPolyData"):
        output.ShallowCopy(source)
    else:
        output.SetPoints(source.GetPoints())
        output.SetVerts(to_cells(np.arange(source.GetNumberOfPoints())[:, None]))
        output.GetPointData().PassData(source.GetPointData())
    arrays = {"SkeletonNodeId": skeleton.point_nodes, "BranchId": skeleton.point_branches.astype(np.int32)}
    add_arrays(output.GetPointData(), arrays)
    output.GetPointData().SetActiveScalars("BranchId")
