"""VoronoiSkeleton in a VTK pipeline gives what `voronoi_skeleton` gives."""

from __future__ import annotations

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from tetraskel import InputError, interior, triangulate, voronoi_skeleton
from tetraskel.kernels.triangulate import available_engine
from tetraskel.vtkfilters import DelaunayMesh, InteriorCells, VoronoiSkeleton
from tetraskel.vtkfilters.convert import array_of, points_of, to_points

METHODS = ("sk1", "sk2", "sk3", "sk4")


def tube(n=4000):
    u, v = np.random.default_rng(0).random((2, n)) * 2 * np.pi
    return np.stack([(1 + 0.3 * np.cos(v)) * np.cos(u), (1 + 0.3 * np.cos(v)) * np.sin(u), 0.3 * np.sin(v)], axis=1)


def polydata(points):
    data = vtkPolyData()
    data.SetPoints(to_points(np.asarray(points, float)))
    return data


def run(data, **options):
    step = VoronoiSkeleton(**options)
    step.SetInputDataObject(0, data)
    return step.run()


def cells_of(cells):
    arrays = (cells.GetOffsetsArray(), cells.GetConnectivityArray())
    return [vtk_to_numpy(array) for array in arrays] if cells.GetNumberOfCells() else [np.zeros(1), np.empty(0)]


def assert_is(data, expected):
    assert np.array_equal(points_of(data)[:, : expected.points.shape[1]], expected.points)
    assert np.array_equal(cells_of(data.GetVerts())[1], expected.vertices)
    assert np.array_equal(cells_of(data.GetLines())[1], expected.lines.ravel())
    for found, wanted in zip(cells_of(data.GetPolys()), (expected.offsets, expected.connectivity), strict=True):
        assert np.array_equal(found, wanted)
    points, cells = data.GetPointData(), data.GetCellData()
    assert np.array_equal(array_of(points, "MaximumInscribedSphereRadius"), expected.radius)
    assert np.array_equal(array_of(points, "CellId"), expected.cells)
    assert np.array_equal(array_of(cells, "Separation"), expected.separation)
    assert np.array_equal(array_of(cells, "SeparationAngle"), expected.angle)


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("points", [tube(), tube(300) * [1, 1, 0]])
def test_points_a_mesh_and_a_labelled_mesh_give_the_same(method, points):
    mesh = triangulate(points)
    inside = interior(mesh) if len(points) > 300 else np.ones(len(mesh), bool)
    options = {"method": method, "least_separation": 0.01, "least_angle": 10.0}
    expected = voronoi_skeleton(mesh, inside=inside, **options)
    grid = DelaunayMesh()
    grid.SetInputDataObject(0, polydata(points))
    labelled = InteriorCells(method="gates" if len(points) > 300 else "all")
    labelled.SetInputConnection(0, grid.GetOutputPort())
    assert_is(run(labelled.run(), **options), expected)
    if len(points) > 300:
        assert_is(run(polydata(points), **options), expected)
    else:
        assert_is(run(grid.run(), **options), expected)


def test_facts_follow_the_result():
    facts = run(polydata(np.concatenate([tube(), tube()[:9]]))).GetFieldData()
    assert array_of(facts, "DuplicatesMerged")[0] == 9
    assert facts.GetAbstractArray("Engine").GetValue(0) == available_engine("auto")


def test_nothing_inside_is_one_line(messages):
    with pytest.raises(InputError, match="expected an object with an inside, got none of"):
        run(polydata(np.random.default_rng(1).random((300, 3))))
    assert messages.GetOutput().count("VoronoiSkeleton: ") == 1


@pytest.mark.parametrize("method", METHODS)
def test_no_points_give_an_empty_skeleton_with_all_arrays(method):
    empty = run(vtkPolyData(), method=method)
    assert empty.GetNumberOfPoints() == 0
    assert empty.GetPointData().HasArray("MaximumInscribedSphereRadius")
    assert empty.GetCellData().HasArray("Separation")
