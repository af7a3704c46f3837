"""RasterSkeleton in a VTK pipeline gives what `raster_skeleton` gives."""

from __future__ import annotations

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkRectilinearGrid

from tetraskel import InputError, interior, raster_skeleton, rasterise, triangulate
from tetraskel.vtkfilters import DelaunayMesh, RasterSkeleton
from tetraskel.vtkfilters.convert import add_arrays, array_of, points_of, to_points


def image_of(mask, spacing=(1, 1, 1), origin=(0, 0, 0), first=(0, 0, 0)):
    image = vtkImageData()
    shape = (*mask.shape, 1)[:3]
    image.SetExtent(*np.stack([first, np.add(first, shape) - 1], axis=1).ravel().tolist())
    image.SetSpacing(*spacing)
    image.SetOrigin(*origin)
    add_arrays(image.GetPointData(), {"mask": mask.reshape(shape).transpose().astype(np.uint8).ravel()})
    image.GetPointData().SetActiveScalars("mask")
    return image


def blob(*shape):
    from scipy.ndimage import gaussian_filter

    return gaussian_filter(np.random.default_rng(0).normal(size=shape), 2, mode="constant") > 0


def run(data, **options):
    step = RasterSkeleton(**options)
    step.SetInputDataObject(0, data)
    return step.run()


def assert_is(data, expected, points=None):
    assert np.allclose(points_of(data), expected.points if points is None else points, rtol=0, atol=1e-12)
    arrays = data.GetPointData()
    assert np.array_equal(array_of(arrays, "MaximumInscribedSphereRadius"), expected.radius)
    assert np.array_equal(array_of(arrays, "GridIndex"), expected.indices)
    assert arrays.HasArray("Subset") == (expected.method == "morphological")
    if expected.method == "morphological":
        assert np.array_equal(array_of(arrays, "Subset"), expected.subset)
    lines = data.GetLines()
    found = vtk_to_numpy(lines.GetConnectivityArray()) if lines.GetNumberOfCells() else []
    assert np.array_equal(found, expected.lines.ravel())
    assert array_of(data.GetFieldData(), "GridDimensions").tolist() == list(expected.shape)


@pytest.mark.parametrize("method", ["morphological", "distance"])
def test_images(method):
    mask = blob(20, 17, 13)
    spacing, origin = (0.5, 1, 2), (3, 4, 5)
    expected = raster_skeleton(mask, method=method, spacing=spacing)
    data = run(image_of(mask, spacing, origin), method=method)
    assert_is(data, expected, expected.points + origin)
    moved = run(image_of(mask, spacing, origin, first=(2, -1, 4)), method=method)
    assert_is(moved, expected, expected.points + origin + np.multiply(spacing, (2, -1, 4)))


def test_flat_images_and_turned_ones():
    mask = blob(30, 21)
    expected = raster_skeleton(mask, element="cross")
    flat = np.column_stack([expected.points, np.zeros(len(expected))])
    assert_is(run(image_of(mask), element="cross"), expected, flat)
    upright = run(image_of(mask.reshape(30, 1, 21)), element="cross")
    assert_is(upright, expected, flat[:, [0, 2, 1]])
    turned = image_of(mask)
    turned.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    assert_is(run(turned, element="cross"), expected, flat[:, [1, 0, 2]] * [-1, 1, 1])


def test_an_array_is_named():
    image = image_of(blob(15, 15))
    add_arrays(image.GetPointData(), {"other": np.ones(225)})
    assert_is(
        run(image, mask_array="other"),
        raster_skeleton(np.ones((15, 15))),
        [[7, 7, 0]],
    )
    with pytest.raises(InputError, match="expected a point array 'none' with one number each on the image, got none"):
        run(image, mask_array="none")


def tube(n=4000):
    u, v = np.random.default_rng(0).random((2, n)) * 2 * np.pi
    return np.stack([(1 + 0.3 * np.cos(v)) * np.cos(u), (1 + 0.3 * np.cos(v)) * np.sin(u), 0.3 * np.sin(v)], axis=1)


def test_points_and_meshes_are_made_into_masks():
    points = vtkPolyData()
    points.SetPoints(to_points(tube()))
    mesh = triangulate(tube())
    for inside, source in ((interior(mesh), points), (None, DelaunayMesh())):
        if inside is None:
            source.SetInputDataObject(0, points)
            source = source.run()
        mask = rasterise(mesh, inside=inside, resolution=40)
        expected = raster_skeleton(mask.values, spacing=mask.spacing, origin=mask.origin)
        assert_is(run(source, resolution=40), expected)


def test_points_of_a_plane_in_space():
    points = vtkPolyData()
    corners = np.array([[0.0, 0, 2], [4, 0, 2], [4, 2, 2], [0, 2, 2]])
    points.SetPoints(to_points(corners))
    mesh = DelaunayMesh()
    mesh.SetInputDataObject(0, points)
    data = run(mesh.run(), resolution=9)
    assert points_of(data).tolist() == [[x, 1.0, 2.0] for x in (1.0, 1.5, 2.0, 2.5, 3.0)]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (image_of(np.zeros((4, 4))), "expected a mask with something inside, got 0 at all of its 16 points"),
        (vtkImageData(), "expected a point array of scalars with one number each on the image, got none"),
        (vtkRectilinearGrid(), "expected an image, points or a mesh, got vtkRectilinearGrid"),
        (vtkPolyData(), "expected an object with an inside, got none of 0 cells inside"),
    ],
)
def test_what_has_no_skeleton_is_one_line(messages, data, message):
    with pytest.raises(InputError, match=message):
        run(data)
    assert messages.GetOutput().count("RasterSkeleton: ") == 1
