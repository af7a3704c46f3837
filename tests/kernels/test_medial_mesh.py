"""The medial sheets of a plate lie in its middle."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel.kernels.curve import curve_model
from tetraskel.kernels.medial_mesh import medial_mesh
from tetraskel.kernels.triangulate import triangulate

SIDES = np.array([4.0, 4.0, 0.5])


def plate(n: int) -> np.ndarray:
    rng = np.random.default_rng(0)
    areas = np.array([SIDES[1] * SIDES[2], SIDES[0] * SIDES[2], SIDES[0] * SIDES[1]])
    axis = rng.choice(3, n, p=areas / areas.sum())
    points = rng.random((n, 3)) * SIDES
    points[np.arange(n), axis] = rng.integers(0, 2, n) * SIDES[axis]
    return points


def test_the_sheet_of_a_plate() -> None:
    sheet = medial_mesh(curve_model(triangulate(plate(8000))))
    a, b, c = sheet.points[sheet.triangles].transpose(1, 0, 2)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    middle = (a + b + c) / 3
    flat = (np.abs(middle[:, :2] - 2) < 1.5).all(axis=1)
    assert (area * np.abs(middle[:, 2] - 0.25))[flat].sum() / area[flat].sum() < 0.02
    assert area[flat].sum() == pytest.approx(9, rel=0.2)
    assert np.median(sheet.radius[sheet.triangles[flat]]) == pytest.approx(0.25, rel=0.1)
