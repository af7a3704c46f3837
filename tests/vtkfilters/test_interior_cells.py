"""InteriorCells in a VTK pipeline gives what `interior` gives."""

from __future__ import annotations

import numpy as np
import pytest
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersSources import vtkSphereSource

from tetraskel import InputError, build_tree, gate_arrays, gate_tree, inside_by_outline, interior, submesh, triangulate
from tetraskel.vtkfilters import DelaunayMesh, InteriorCells, TreeBuilder
from tetraskel.vtkfilters.convert import add_arrays, array_of, points_of, simplices_of, to_cells, to_points


def polydata(points):
    data = vtkPolyData()
    data.SetPoints(to_points(np.asarray(points, float)))
    return data


def two_balls(n=1500):
    """Random points of two unit spheres, four apart."""
    points = np.random.default_rng(0).normal(size=(n, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points[::2, 0] += 4
    return points


def mesh_data(points):
    step = DelaunayMesh()
    step.SetInputDataObject(0, polydata(points))
    return step.run()


def classify(data, boundary=None, **options):
    step = InteriorCells(**options)
    step.SetInputDataObject(0, data)
    if boundary is not None:
        step.SetInputDataObject(1, boundary)
    return step.run()


def inside_of(data):
    return array_of(data.GetCellData(), "Inside").astype(bool)


def ball(radius=1.0):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetThetaResolution(24)
    source.SetPhiResolution(24)
    source.Update()
    return source.GetOutput()


def test_gates_are_the_kernel():
    points = two_balls()
    mesh = triangulate(points)
    expected = interior(mesh)
    data = classify(mesh_data(points), gate_arrays=True)
    assert 0 < expected.sum() < len(mesh)
    assert np.array_equal(inside_of(data), expected)
    found = gate_arrays(gate_tree(mesh), mesh.neighbors)
    assert np.array_equal(array_of(data.GetCellData(), "GateWidth"), found.width)
    assert np.array_equal(array_of(data.GetCellData(), "RoomRadius"), found.room_radius)
    assert np.array_equal(array_of(data.GetCellData(), "GateParent"), found.parent)


def test_only_the_inside_can_be_kept_and_walked_piece_by_piece():
    points = two_balls()
    mesh = triangulate(points)
    kept = submesh(mesh, interior(mesh))
    data = classify(mesh_data(points), extract=True)
    assert np.array_equal(simplices_of(data), kept.simplices)
    walk = TreeBuilder()
    walk.SetInputDataObject(0, data)
    assert np.array_equal(array_of(walk.run().GetPointData(), "CellId"), build_tree(kept).cell)
    assert build_tree(kept).tree_id.max() == 1


def test_by_a_surface():
    points = np.random.default_rng(1).uniform(-1, 1, (800, 3))
    mesh = triangulate(points)
    surface = ball(0.8)
    expected = interior(mesh, method="surface", surface=(points_of(surface), simplices_of(surface)))
    data = classify(mesh_data(points), surface, method="surface")
    assert np.array_equal(inside_of(data), expected)
    centre = mesh.points[mesh.simplices].mean(axis=1)
    clear = np.abs(np.linalg.norm(centre, axis=1) - 0.8) > 0.03
    assert np.array_equal(expected[clear], (np.linalg.norm(centre, axis=1) < 0.8)[clear])


def square(size):
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size
    outline = polydata(corners)
    outline.SetLines(to_cells(np.array([0, 1, 2, 3, 0]), np.array([0, 5])))
    return corners, outline


def test_by_an_outline_that_splits_cells():
    points = np.random.default_rng(2).uniform(-1, 1, (300, 2))
    corners, outline = square(0.7)
    followed, expected = inside_by_outline(triangulate(points), corners, [[0, 1], [1, 2], [2, 3], [3, 0]])
    data = classify(mesh_data(points), outline, method="outline")
    assert np.array_equal(inside_of(data), expected)
    assert np.allclose(points_of(data)[:, :2], followed.points)
    corners_of = points_of(data)[simplices_of(data)[inside_of(data)]][:, :, :2]
    sides = corners_of[:, 1:] - corners_of[:, :1]
    assert np.abs(np.linalg.det(sides)).sum() / 2 == pytest.approx(1.4**2)


def test_polygons_are_outlines_too():
    points = np.random.default_rng(2).uniform(-1, 1, (300, 2))
    _, lines = square(0.7)
    polygons = polydata(points_of(lines))
    polygons.SetPolys(to_cells(np.array([[0, 1, 2, 3]])))
    by_lines = classify(mesh_data(points), lines, method="outline")
    by_polygons = classify(mesh_data(points), polygons, method="outline")
    assert np.array_equal(inside_of(by_lines), inside_of(by_polygons))


def test_by_an_array_and_everything():
    data = mesh_data(two_balls(300))
    labels = np.arange(data.GetNumberOfCells()) % 3
    add_arrays(data.GetCellData(), {"part": labels})
    assert np.array_equal(inside_of(classify(data, method="array", label_array="part")), labels != 0)
    assert inside_of(classify(data, method="all")).all()


def test_nothing_inside_is_an_empty_inside_and_one_line(messages):
    data = classify(mesh_data(np.random.default_rng(3).random((200, 3))))
    assert not inside_of(data).any()
    assert messages.GetOutput().startswith("InteriorCells: nothing lies inside")
    assert classify(vtkPolyData()).GetNumberOfCells() == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "surface"}, "expected a closed surface at the second input, got nothing"),
        ({"method": "outline"}, "expected closed lines at the second input, got nothing"),
        ({"method": "array", "label_array": "none"}, "expected a cell array 'none' on the mesh"),
    ],
)
def test_what_a_method_needs_must_be_there(options, message):
    with pytest.raises(InputError, match=message):
        classify(mesh_data(np.random.default_rng(4).random((50, 2))), **options)
