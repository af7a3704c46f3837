"""Skeletons with radii in polygonal data, ours or others', and back."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel.errors import InputError
from tetraskel.kernels.ball_graph import BallGraph, ball_graph
from tetraskel.vtkfilters.convert import array_of, points_of, segments_of


def balls_of(data: vtkPolyData, radius_array: str, *, faces: bool = False) -> BallGraph:
    """The points, radii and lines of polygonal data; no points give an empty graph.

    With `faces` the sides of polygons are lines too: medial sheets are made of balls as lines are.

    Raises
    ------
    InputError
        When the radii are missing or are no radii.
    """
    points = points_of(data).astype(float)
    if len(points) == 0:
        return BallGraph(points, np.empty(0), np.zeros(1, np.int64), np.empty(0, np.int64))
    radius = array_of(data.GetPointData(), radius_array)
    if radius is None:
        raise InputError(
            f"expected a skeleton with the point array {radius_array!r} of radii, got {_names(data)}; "
            "name the array that holds them."
        )
    offsets, ids = np.zeros(1, np.int64), np.empty(0, np.int64)
    if data.GetNumberOfLines():
        lines = data.GetLines()
        offsets, ids = (vtk_to_numpy(array) for array in (lines.GetOffsetsArray(), lines.GetConnectivityArray()))
    if faces and data.GetNumberOfPolys():
        sides = np.unique(np.sort(segments_of(data.GetPolys(), closed=True), axis=1), axis=0)
        offsets = np.concatenate([offsets, offsets[-1] + np.arange(2, 2 * len(sides) + 1, 2)])
        ids = np.concatenate([ids, sides.ravel()])
    return ball_graph(BallGraph(points, radius.astype(float), offsets.astype(np.int64), ids.astype(np.int64)))


def _names(data: vtkPolyData) -> str:
    attributes = data.GetPointData()
    names = [attributes.GetArrayName(k) or "one without a name" for k in range(attributes.GetNumberOfArrays())]
    return ", ".join(names) or "no arrays"


def lies_in_plane(data: vtkPolyData) -> bool:
    """Whether the data say that they come from an object of the plane."""
    dimension = array_of(data.GetFieldData(), "Dimension")
    return dimension is not None and len(dimension) > 0 and int(dimension[0]) == 2
