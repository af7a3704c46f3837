"""Skeletons of masks: Lantuejoul's definition word for word, exact reversal, ridges, thinning, rasterising."""

from __future__ import annotations

import builtins

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import array_shapes, arrays

from shapes import FLATS, SOLIDS
from tetraskel import (
    EngineError,
    InputError,
    curve_skeleton,
    interior,
    morphological_reversal,
    raster_skeleton,
    rasterise,
    triangulate,
)
from tetraskel.kernels.raster_skeleton import morphological_subsets, structuring_element

ELEMENTS = ("box", "cross")
# a font of five by seven points
LETTERS = {
    "A": "01110 10001 10001 11111 10001 10001 10001", "B": "11110 10001 11110 10001 10001 10001 11110",
    "E": "11111 10000 11110 10000 10000 10000 11111", "K": "10001 10010 11100 10100 10010 10001 10001",
    "M": "10001 11011 10101 10101 10001 10001 10001", "O": "01110 10001 10001 10001 10001 10001 01110",
    "R": "11110 10001 10001 11110 10100 10010 10001", "S": "01111 10000 01110 00001 00001 10001 01110",
    "X": "10001 01010 00100 00100 01010 10001 10001", "8": "01110 10001 01110 10001 10001 10001 01110",
}  # fmt: skip


def letter(name: str, size: int = 9) -> np.ndarray:
    """A letter drawn thick, up to the border of its grid."""
    dots = np.array([[c == "1" for c in row] for row in LETTERS[name].split()])
    return np.kron(dots[::-1].T, np.ones((size, size), bool))


def by_definition(mask: np.ndarray, element: str) -> np.ndarray:
    """Lantuejoul's subsets by erosions and openings."""
    from scipy.ndimage import binary_dilation, binary_erosion

    structure = structuring_element(mask.ndim, element)
    eroded, found, n = np.pad(mask, 1), np.full(np.add(mask.shape, 2), -1), 0
    while eroded.any():
        further = binary_erosion(eroded, structure)
        assert (found[eroded & ~binary_dilation(further, structure)] == -1).all()  # in no other subset
        found[eroded & ~binary_dilation(further, structure)] = n
        eroded, n = further, n + 1
    return found[(slice(1, -1),) * mask.ndim]


masks = arrays(bool, array_shapes(min_dims=2, max_dims=3, min_side=1, max_side=9)).filter(np.any)


@pytest.mark.parametrize("element", ELEMENTS)
@settings(deadline=None, max_examples=60)
@given(mask=masks)
def test_random_masks_come_back_bit_for_bit(mask: np.ndarray, element: str) -> None:
    assert np.array_equal(morphological_subsets(mask, element), by_definition(mask, element))
    assert np.array_equal(morphological_reversal(raster_skeleton(mask, element=element)), mask)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("seed", range(4))
def test_blobs_come_back_bit_for_bit(seed: int, element: str) -> None:
    from scipy.ndimage import gaussian_filter

    rng = np.random.default_rng(seed)
    shape = (60, 41) if seed % 2 else (30, 22, 17)
    mask = gaussian_filter(rng.normal(size=shape), 2.5, mode="constant") > 0
    skeleton = raster_skeleton(mask, element=element)
    assert len(skeleton) < 0.5 * mask.sum()
    assert np.array_equal(morphological_reversal(skeleton), mask)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("name", LETTERS)
def test_letters_come_back_bit_for_bit(name: str, element: str) -> None:
    mask = letter(name)
    assert mask[:, [0, -1]].any()  # it touches the border of its grid
    skeleton = raster_skeleton(mask, element=element)
    assert np.array_equal(skeleton.subset, by_definition(mask, element)[tuple(skeleton.indices.T)])
    assert np.array_equal(morphological_reversal(skeleton), mask)


class TestClosedForms:
    def test_a_box_and_a_diamond_have_one_point(self) -> None:
        x, y = np.meshgrid(np.arange(-10, 11), np.arange(-10, 11), indexing="ij")
        for mask, element, radius in (
            (np.ones((21, 21), bool), "box", 10),
            (np.abs(x) + np.abs(y) <= 7, "cross", 7),
        ):
            skeleton = raster_skeleton(mask, element=element)
            assert skeleton.indices.tolist() == [[10, 10]]
            assert skeleton.subset.tolist() == [radius]

    def test_a_mask_of_one_value(self) -> None:
        skeleton = raster_skeleton(np.ones((9, 5, 3)))
        assert np.array_equal(morphological_reversal(skeleton), np.ones((9, 5, 3), bool))
        assert set(skeleton.indices[:, 2].tolist()) == {1}

    def test_the_ridge_of_a_rectangle_is_its_axis_and_its_diagonals(self) -> None:
        ridge = raster_skeleton(np.ones((61, 21)), method="distance", ridge_slope=0.8)
        x, y = ridge.indices.T
        on_axis = (y == 10) & (x >= 10) & (x <= 50)
        on_diagonal = np.minimum(x, 60 - x) == np.minimum(y, 20 - y)
        assert (on_axis | on_diagonal).all()
        assert on_axis.sum() == 41
        assert on_diagonal.sum() >= 4 * 10 + 2 - 4  # the corners are of the rim
        assert np.array_equal(ridge.radius, np.minimum(np.minimum(x, 60 - x), np.minimum(y, 20 - y)) + 1)

    def test_the_ridge_of_a_disc_is_its_centre(self) -> None:
        x, y = np.meshgrid(np.arange(-30, 31), np.arange(-30, 31), indexing="ij")
        ridge = raster_skeleton(x**2 + y**2 <= 28**2, method="distance", ridge_slope=0.5, origin=-30.0)
        assert np.abs(ridge.points).max() <= 1

    def test_grid_and_unit(self) -> None:
        mask = letter("K")
        plain = raster_skeleton(mask, method="distance")
        moved = raster_skeleton(mask, method="distance", spacing=0.001, origin=[5, -2])
        assert np.array_equal(moved.indices, plain.indices)
        assert np.allclose(moved.points, plain.points * 0.001 + [5, -2])
        assert np.allclose(moved.radius, plain.radius * 0.001)

    def test_lines_join_neighbours_without_short_cuts(self) -> None:
        corner = np.zeros((6, 6), bool)
        corner[1, 1:5] = corner[1:5, 4] = True
        skeleton = raster_skeleton(corner, method="distance", ridge_slope=1.0)
        assert len(skeleton) == 7
        assert len(skeleton.lines) == 6
        diagonal = raster_skeleton(np.eye(5), method="distance", ridge_slope=1.0)
        assert diagonal.lines.tolist() == [[0, 1], [1, 2], [2, 3], [3, 4]]


class TestThinning:
    @pytest.mark.parametrize("name", LETTERS)
    def test_letters_keep_their_pieces_and_holes(self, name: str) -> None:
        pytest.importorskip("skimage")
        from scipy.ndimage import label

        mask = letter(name)
        thin = raster_skeleton(mask, method="thinning")
        lines = np.zeros(mask.shape, bool)
        lines[tuple(thin.indices.T)] = True
        assert not (lines & ~mask).any()
        assert label(np.pad(~mask, 1, constant_values=True))[1] == label(np.pad(~lines, 1, constant_values=True))[1]
        assert label(lines, np.ones((3, 3)))[1] == label(mask, np.ones((3, 3)))[1]
        assert len(thin) < mask.sum() / 5

    def test_a_bar_in_space_is_a_line(self) -> None:
        pytest.importorskip("skimage")
        thin = raster_skeleton(np.ones((31, 7, 7)), method="thinning")
        assert (thin.indices[:, 1:] == 3).all()
        assert len(thin.lines) == len(thin) - 1

    @pytest.mark.parametrize("sides", [(2, 2, 2), (4, 4, 4), (2, 2, 3)])
    def test_no_piece_vanishes(self, sides: tuple[int, int, int]) -> None:
        """Found by fuzzing: scikit-image takes away blocks of an even size as a whole."""
        pytest.importorskip("skimage")
        mask = np.zeros((20, 9, 9), bool)
        mask[tuple(slice(1, 1 + side) for side in sides)] = True
        mask[8:19, 2:7, 2:7] = True
        thin = raster_skeleton(mask, method="thinning")
        assert (thin.indices[:, 0] < 6).sum() == 1
        assert (thin.indices[:, 0] >= 8).sum() > 1
        assert mask[tuple(thin.indices.T)].all()

    def test_without_scikit_image_one_sentence(self, monkeypatch) -> None:
        found = builtins.__import__

        def no_skimage(name, *rest, **more):
            if name.startswith("skimage"):
                raise ImportError(name)
            return found(name, *rest, **more)

        monkeypatch.setattr(builtins, "__import__", no_skimage)
        with pytest.raises(EngineError, match=r"expected scikit-image for thinning.*install tetraskel\[raster\]"):
            raster_skeleton(np.ones((5, 5)), method="thinning")


class TestRasterise:
    @pytest.mark.parametrize("shape", [FLATS["letters"](), SOLIDS["torus"](), SOLIDS["two_balls"]()])
    def test_grid_points_of_the_object_are_found(self, shape) -> None:
        mesh = triangulate(shape.sample(6000, np.random.default_rng(0)))
        mask = rasterise(mesh, inside=interior(mesh), resolution=60)
        assert max(mask.values.shape) == 60
        places = mask.origin + np.argwhere(np.ones_like(mask.values)) * mask.spacing
        exact = shape.contains(places).reshape(mask.values.shape)
        assert (mask.values & exact).sum() / (mask.values | exact).sum() > 0.93

    @pytest.mark.parametrize("dim", [2, 3])
    def test_every_grid_point_is_asked_of_every_simplex(self, dim: int) -> None:
        mesh = triangulate(np.random.default_rng(3).random((12, dim)))
        inside = np.arange(len(mesh)) % 2 == 0
        mask = rasterise(mesh, inside=inside, resolution=17)
        places = mask.origin + np.argwhere(np.ones_like(mask.values)) * mask.spacing
        expected = np.zeros(len(places), bool)
        for cell in mesh.simplices[inside]:
            corners = mesh.points[cell]
            weights = np.linalg.solve((corners[1:] - corners[0]).T, (places - corners[0]).T)
            expected |= (weights >= -1e-9).all(axis=0) & (weights.sum(axis=0) <= 1 + 1e-9)
        assert np.array_equal(mask.values.ravel(), expected)

    def test_a_box_is_full(self) -> None:
        corners = np.array([[x, y, z] for x in (0.0, 4) for y in (0.0, 2) for z in (0.0, 1)])
        mask = rasterise(triangulate(corners), resolution=9)
        assert mask.values.shape == (9, 5, 3)
        assert mask.values.all()
        assert mask.spacing.tolist() == [0.5] * 3

    def test_ridge_and_curve_of_a_torus_agree(self) -> None:
        points = SOLIDS["torus"]().sample(4000, np.random.default_rng(0))
        mesh = triangulate(points)
        mask = rasterise(mesh, inside=interior(mesh), resolution=80)
        ridge = raster_skeleton(
            mask.values, method="distance", ridge_slope=0.4, spacing=mask.spacing, origin=mask.origin
        )
        away = np.hypot(np.hypot(ridge.points[:, 0], ridge.points[:, 1]) - 1, ridge.points[:, 2])
        assert np.median(away) < 2 * mask.spacing[0]
        assert np.median(ridge.radius) == pytest.approx(np.median(curve_skeleton(points).radius), rel=0.1)


class TestBadInput:
    @pytest.mark.parametrize(
        ("mask", "message"),
        [
            (np.zeros((3, 4)), "expected a mask with something inside, got 0 at all of its 12 points"),
            (np.empty((0, 3)), "got 0 at all of its 0 points"),
            (np.ones(5), "expected a mask with two or three axes, got shape \\(5,\\)"),
            ([["a", "b"]], "expected a mask of numbers or booleans"),
            ([[1, np.nan]], "expected finite numbers in the mask"),
        ],
    )
    def test_masks(self, mask, message: str) -> None:
        with pytest.raises(InputError, match=message):
            raster_skeleton(mask)

    def test_options_and_grid(self) -> None:
        with pytest.raises(InputError, match="element must be one of box, cross"):
            raster_skeleton(np.ones((3, 3)), element="ball")
        with pytest.raises(InputError, match="expected a spacing of 2 finite numbers"):
            raster_skeleton(np.ones((3, 3)), spacing=[1, 1, 1])
        with pytest.raises(InputError, match="expected a positive spacing"):
            raster_skeleton(np.ones((3, 3)), spacing=[1, 0])

    def test_only_a_morphological_skeleton_comes_back(self) -> None:
        with pytest.raises(InputError, match="got one by distance"):
            morphological_reversal(raster_skeleton(np.ones((3, 3)), method="distance"))

    def test_rasterise(self) -> None:
        mesh = triangulate(np.random.default_rng(0).random((9, 3)))
        with pytest.raises(InputError, match="expected an object with an inside, got none"):
            rasterise(mesh, inside=np.zeros(len(mesh)))
        with pytest.raises(InputError, match="resolution must lie between 2 and 2048; got 1"):
            rasterise(mesh, resolution=1)

    def test_the_mask_is_not_written_to(self) -> None:
        mask = letter("B")
        before = mask.copy()
        for method in ("morphological", "distance"):
            raster_skeleton(mask, method=method)
        assert np.array_equal(mask, before)
