"""PointThinning in a VTK pipeline keeps the points that `thinned` keeps, with what belongs to them."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

from tetraskel import InputError, curve_skeleton, thinned
from tetraskel.vtkfilters import CurveSkeleton, PointThinning
from tetraskel.vtkfilters.point_thinning import data_of_thinned
from tubes import TUBES


@pytest.fixture
def cloud():
    points = TUBES["torus"]().sample(6000, np.random.default_rng(0)).astype(np.float32)
    data = pyvista.PolyData(points)
    data["weight"] = np.arange(6000.0)
    data.field_data["unit"] = ["mm"]
    return data


def test_points_arrays_and_facts(cloud):
    step = PointThinning(most_points=1500)
    step.SetInputDataObject(0, cloud)
    found = pyvista.wrap(step.run())
    expected = thinned(cloud.points, most_points=1500)
    assert np.array_equal(found["OriginalPointIds"], expected.ids)
    assert np.array_equal(found["Spacing"], expected.spacing)
    assert np.array_equal(found.points, cloud.points[expected.ids])
    assert found.points.dtype == np.float32
    assert np.array_equal(found["weight"], expected.ids.astype(float))
    assert found.n_verts == found.n_points == len(expected)
    assert list(found.field_data["unit"]) == ["mm"]
    facts = [int(found.field_data[name][0]) for name in ("InputPoints", "KeptPoints", "CoarsePoints")]
    assert facts == [6000, len(expected), expected.n_coarse]
    assert step.GetFoundKeptPoints() == str(len(expected))


@pytest.mark.parametrize("kind", [">f4", ">f8", "<f4", "f2", "i2"])
def test_coordinates_of_every_type(kind):
    points = (100 * TUBES["torus"]().sample(600, np.random.default_rng(0))).astype(kind)
    found = thinned(points, most_points=200)
    data = pyvista.wrap(data_of_thinned(points[found.ids], found, len(points)))
    assert np.array_equal(data.points, points[found.ids])


def test_few_points_pass_as_they_are(cloud):
    step = PointThinning(most_points=6000)
    step.SetInputDataObject(0, cloud)
    found = pyvista.wrap(step.run())
    assert np.array_equal(found.points, cloud.points)
    assert not found["Spacing"].any()


def test_before_the_curve_skeleton(cloud):
    thin, curve = PointThinning(most_points=1500), CurveSkeleton()
    thin.SetInputDataObject(0, cloud)
    curve.SetInputConnection(0, thin.GetOutputPort())
    found = pyvista.wrap(curve.run())
    assert np.array_equal(
        found.points, curve_skeleton(cloud.points[thinned(cloud.points, most_points=1500).ids]).points
    )
    assert int(found.field_data["Loops"][0]) == 1


def test_twice_is_the_names_of_the_second(cloud):
    first, second = PointThinning(most_points=3000), PointThinning(most_points=1000)
    first.SetInputDataObject(0, cloud)
    second.SetInputConnection(0, first.GetOutputPort())
    found = pyvista.wrap(second.run())
    assert found["OriginalPointIds"].max() < 3000
    assert int(found.field_data["InputPoints"][0]) == int(first.GetFoundKeptPoints())


def test_nothing_in_nothing_out():
    step = PointThinning()
    step.SetInputDataObject(0, pyvista.PolyData())
    assert step.run().GetNumberOfPoints() == 0


def test_bad_points_are_told(cloud):
    cloud.points[7] = np.nan
    step = PointThinning()
    step.SetInputDataObject(0, cloud)
    with pytest.raises(InputError, match="got 1 of 6000 points with NaN"):
        step.run()
