"""BezierSkeleton in a VTK pipeline gives what `bezier_skeleton` gives; its cells are those curves."""

from __future__ import annotations

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import VTK_BEZIER_CURVE, vtkPolyData, vtkUnstructuredGrid

from tetraskel import InputError, bezier_skeleton, skeleton_surface
from tetraskel.kernels.cubic_spline import bezier_at
from tetraskel.vtkfilters import BezierSkeleton, SkeletonSurface
from tetraskel.vtkfilters.convert import add_arrays, array_of, points_of, to_cells, to_points

AXIS = np.linspace(0, 6, 60)
POINTS = np.stack([AXIS, np.sin(AXIS), 0.1 * AXIS**2], axis=1)
RADIUS = 0.4 + 0.05 * np.cos(AXIS)
EDGES = np.stack([np.arange(59), np.arange(1, 60)], axis=1)


def bent_line(radius=RADIUS):
    data = vtkPolyData()
    data.SetPoints(to_points(POINTS))
    data.SetLines(to_cells(np.arange(60)[None]))
    add_arrays(data.GetPointData(), {} if radius is None else {"MaximumInscribedSphereRadius": radius})
    return data


def step_on(data, **options):
    step = BezierSkeleton(**options)
    step.SetInputDataObject(0, data)
    return step


def test_lines_are_those_of_the_kernel():
    expected = bezier_skeleton((POINTS, EDGES, RADIUS), tolerance=0.05, samples=5)
    data = step_on(bent_line(), tolerance=0.05, samples=5).run()
    assert np.array_equal(points_of(data), expected.skeleton.points)
    assert np.array_equal(vtk_to_numpy(data.GetLines().GetConnectivityArray()), expected.skeleton.connectivity)
    for name, values in {
        "MaximumInscribedSphereRadius": expected.skeleton.radius,
        "Abscissas": expected.skeleton.abscissa,
        "ParentId": expected.skeleton.parent,
        "Curvature": expected.curvature,
        "Torsion": expected.torsion,
    }.items():
        assert np.array_equal(array_of(data.GetPointData(), name), values), name
    assert array_of(data.GetFieldData(), "Pieces")[0] == len(expected)
    assert array_of(data.GetFieldData(), "Components")[0] == 1
    assert array_of(data.GetFieldData(), "Loops")[0] == 0


def test_cells_are_the_curves():
    expected = bezier_skeleton((POINTS, EDGES, RADIUS))
    step = step_on(bent_line())
    step.run()
    grid = step.GetOutputDataObject(1)
    assert isinstance(grid, vtkUnstructuredGrid)
    assert grid.GetNumberOfCells() == len(expected)
    assert np.array_equal(array_of(grid.GetCellData(), "BranchId"), expected.branch)
    radius = array_of(grid.GetPointData(), "MaximumInscribedSphereRadius")
    for number in range(len(expected)):
        assert grid.GetCellType(number) == VTK_BEZIER_CURVE
        cell, place, weights = grid.GetCell(number), [0.0] * 3, [0.0] * 4
        for share in (0.0, 0.3, 1.0):
            cell.EvaluateLocation(reference(0), [share, 0, 0], place, weights)
            known = bezier_at(expected.control[number : number + 1], np.array([share]))[0][0]
            assert np.allclose(place, known)
            there = radius[[cell.GetPointId(k) for k in range(4)]] @ weights
            thick = bezier_at(expected.control_radius[number : number + 1, :, None], np.array([share]))[0][0, 0]
            assert there == pytest.approx(thick)


def test_the_surface_follows_the_curves():
    curves, surface = step_on(bent_line()), SkeletonSurface()
    surface.SetInputConnection(0, curves.GetOutputPort(0))
    expected = skeleton_surface(bezier_skeleton((POINTS, EDGES, RADIUS)).skeleton)
    assert np.allclose(points_of(surface.run()), expected.points)


def test_the_root_of_the_input_stays_the_root():
    data = bent_line()
    parent = np.append(np.arange(1, 60), -1)
    add_arrays(data.GetPointData(), {"ParentId": parent})
    result = step_on(data).run()
    root = np.flatnonzero(array_of(result.GetPointData(), "ParentId") < 0)
    assert np.allclose(points_of(result)[root], POINTS[-1])


def test_no_points_give_no_curves():
    step = step_on(vtkPolyData())
    assert step.run().GetNumberOfPoints() == 0
    assert step.GetOutputDataObject(1).GetNumberOfCells() == 0


@pytest.mark.parametrize(
    ("radius", "message"), [(None, "got no arrays; name the array"), (-RADIUS, "finite and not negative, got 60 of 60")]
)
def test_what_has_no_radii_is_one_line(messages, radius, message):
    with pytest.raises(InputError, match=message):
        step_on(bent_line(radius)).run()
    assert messages.GetOutput().count("BezierSkeleton: ") == 1
