"""SkeletonSurface in a VTK pipeline gives what `skeleton_surface` gives."""

from __future__ import annotations

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges

from tetraskel import InputError, skeleton_surface, surface_error
from tetraskel.vtkfilters import CurveSkeleton, SkeletonSurface
from tetraskel.vtkfilters.convert import add_arrays, add_facts, array_of, points_of, simplices_of, to_cells, to_points

ANGLE = np.linspace(0, 2 * np.pi, 40, endpoint=False)
RING = np.stack([2 * np.cos(ANGLE), 2 * np.sin(ANGLE), 0 * ANGLE], axis=1)
EDGES = np.stack([np.arange(40), (np.arange(40) + 1) % 40], axis=1)
RADIUS = np.full(40, 0.4)


def ring(name="MaximumInscribedSphereRadius", radius=RADIUS):
    data = vtkPolyData()
    data.SetPoints(to_points(RING))
    data.SetLines(to_cells(np.append(np.arange(40), 0)[None]))
    if name:
        add_arrays(data.GetPointData(), {name: radius})
    return data


def surface_step(data, original=None, **options):
    step = SkeletonSurface(**options)
    step.SetInputDataObject(0, data)
    if original is not None:
        step.SetInputDataObject(1, original)
    return step


def cloud(points):
    data = vtkPolyData()
    data.SetPoints(to_points(points))
    return data


def n_open_edges(data):
    edges = vtkFeatureEdges()
    edges.SetInputData(data)
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfLines()


def test_the_surface_is_that_of_the_kernel():
    expected = skeleton_surface((RING, EDGES, RADIUS), cells_per_radius=4)
    data = surface_step(ring(), cells_per_radius=4).run()
    assert np.array_equal(points_of(data), expected.points)
    assert np.array_equal(simplices_of(data), expected.simplices)
    assert np.array_equal(array_of(data.GetPointData(), "MaximumInscribedSphereRadius"), expected.radius)
    assert np.array_equal(array_of(data.GetPointData(), "BranchId"), expected.branch)
    assert np.allclose(vtk_to_numpy(data.GetPointData().GetNormals()), expected.normals, atol=1e-6)
    assert array_of(data.GetFieldData(), "Spacing")[0] == expected.spacing
    assert n_open_edges(data) == 0


def test_another_array_can_hold_the_radii():
    first, second = surface_step(ring()).run(), surface_step(ring("Thickness"), radius_array="Thickness").run()
    assert np.array_equal(points_of(first), points_of(second))


def test_the_error_is_that_of_the_kernel():
    surface = skeleton_surface((RING, EDGES, RADIUS))
    facts = surface_step(ring(), cloud(1.05 * RING)).run().GetFieldData()
    for name, value in surface_error(surface, 1.05 * RING).items():
        assert array_of(facts, name)[0] == value
    assert not facts.HasArray("BackErrorMean")
    original = surface_step(ring(), cells_per_radius=8).run()
    facts = surface_step(ring(), original).run().GetFieldData()
    for name, value in surface_error(surface, points_of(original), simplices_of(original)).items():
        assert array_of(facts, name)[0] == value
    assert array_of(facts, "ErrorMean")[0] < 0.1


def test_a_region_is_outlined_and_filled():
    data = surface_step(ring(), dimension="plane").run()
    assert data.GetNumberOfLines() == 2
    corners = points_of(data)[vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2].sum() / 2
    assert area == pytest.approx(np.pi * (2.4**2 - 1.6**2), rel=0.01)
    expected = skeleton_surface((RING, EDGES, RADIUS), dimension="plane")
    assert np.array_equal(points_of(data), expected.points)


def test_a_skeleton_of_the_plane_gives_its_region_by_itself():
    data = ring()
    add_facts(data, {"Dimension": 2})
    assert surface_step(data).run().GetNumberOfLines() == 2
    assert surface_step(data, dimension="space").run().GetNumberOfLines() == 0


def test_the_curve_skeleton_of_a_disc_gives_it_back():
    rng = np.random.default_rng(0)
    angle = rng.random(400) * 2 * np.pi
    circle = np.stack([3 * np.cos(angle), np.sin(angle), np.full(400, 7.0)], axis=1)
    curve = CurveSkeleton()
    curve.SetInputDataObject(0, cloud(circle))
    step = SkeletonSurface()
    step.SetInputConnection(0, curve.GetOutputPort(0))
    step.SetInputDataObject(1, cloud(circle))
    data = step.run()
    assert data.GetNumberOfLines() == 1
    assert np.allclose(points_of(data)[:, 2], 7)
    assert array_of(data.GetFieldData(), "ErrorMean")[0] < 2


def test_points_without_lines_are_balls():
    data = cloud(np.array([[0, 0, 0], [5.0, 0, 0]]))
    add_arrays(data.GetPointData(), {"MaximumInscribedSphereRadius": np.ones(2)})
    result = surface_step(data).run()
    assert result.GetNumberOfPoints() - result.GetNumberOfPolys() // 2 == 4


def test_no_points_give_an_empty_surface():
    for dimension in ("auto", "plane"):
        data = surface_step(vtkPolyData(), dimension=dimension).run()
        assert data.GetNumberOfPoints() == data.GetNumberOfCells() == 0


WRONG = [
    ({"name": None}, {}, "expected a skeleton with the point array 'MaximumInscribedSphereRadius' of radii, got no"),
    ({"name": "R"}, {}, "got R; name the array"),
    ({"radius": -RADIUS}, {}, "finite and not negative, got 40 of 40"),
    ({"radius": np.full(40, np.nan)}, {}, "finite and not negative, got 40 of 40"),
    ({"radius": np.ones((40, 3))}, {}, "a radius for each of 40 skeleton points"),
]


@pytest.mark.parametrize(("made", "options", "message"), WRONG)
def test_what_has_no_radii_is_one_line(messages, made, options, message):
    with pytest.raises(InputError, match=message):
        surface_step(ring(**made), **options).run()
    assert messages.GetOutput().count("SkeletonSurface: ") == 1


def test_cells_too_coarse_are_said(messages):
    surface_step(ring(), spacing=1.0).run()
    assert "40 of 40 balls are thinner than the cells of 1 can show" in messages.GetOutput()
    surface_step(ring(), max_cells=1000).run()
    assert "raise MaxCells or set Spacing" in messages.GetOutput()


def sheet(side=11, radius=0.3):
    """A square of 2 by 2 in triangles, with balls on its points."""
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side), indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower = np.stack([corner, corner + side, corner + side + 1], axis=1)
    upper = np.stack([corner, corner + side + 1, corner + 1], axis=1)
    data = vtkPolyData()
    data.SetPoints(to_points(places))
    data.SetPolys(to_cells(np.concatenate([lower, upper])))
    add_arrays(data.GetPointData(), {"MaximumInscribedSphereRadius": np.full(len(places), radius)})
    return data


def test_faces_give_back_a_plate():
    data = surface_step(sheet(), spacing=0.05).run()
    assert n_open_edges(data) == 0
    assert data.GetNumberOfPoints() - data.GetNumberOfCells() / 2 == 2  # a sphere, by its Euler characteristic
    places = points_of(data)
    within = np.abs(places[:, :2]).max(axis=1) < 1
    assert np.abs(places[within, 2]) == pytest.approx(0.3, abs=0.02)  # sides 0.2 apart sag by 0.017
