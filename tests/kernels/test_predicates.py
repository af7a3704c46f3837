"""Signs are exact: floating point never disagrees with fractions where it claims to be certain."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tetraskel.kernels.predicates import orientation_signs, signs_and_doubts


def exact_sign(corners):
    """Sign of the determinant in fractions; 0 for a simplex without volume."""
    rows = [[Fraction(float(x)) - Fraction(float(o)) for x, o in zip(p, corners[0], strict=True)] for p in corners[1:]]
    if len(rows) == 2:
        value = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    else:
        (a, b, c), (d, e, f), (g, h, i) = rows
        value = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return (value > 0) - (value < 0)


def almost_flat(dim, n, scale, offset):
    """Simplices whose last corner is a few roundings off the plane (line) of the others, and needles among them."""
    rng = np.random.default_rng(dim)
    corners = (rng.random((n, dim + 1, dim)) + offset) * scale
    weights = rng.dirichlet(np.ones(dim), n)
    corners[:, -1] = np.einsum("nk,nkd->nd", weights, corners[:, :-1])
    steps = rng.integers(-2, 3, (n, dim))
    for _ in range(2):
        corners[:, -1] = np.where(steps > 0, np.nextafter(corners[:, -1], np.inf), corners[:, -1])
        corners[:, -1] = np.where(steps < 0, np.nextafter(corners[:, -1], -np.inf), corners[:, -1])
    return corners


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("scale", "offset"), [(1, 0), (1, 1000), (1e-100, 0), (1e-104, 0), (1e90, 0)])
def test_signs_of_almost_flat_simplices(dim, scale, offset):
    corners = almost_flat(dim, 400, scale, offset)
    expected = np.array([exact_sign(simplex) for simplex in corners])
    assert len(np.unique(expected)) >= 2
    found = orientation_signs(corners)
    assert np.array_equal(found[expected != 0], expected[expected != 0])
    assert (found != 0).all()
    signs, doubts = signs_and_doubts(list(corners.T))
    certain = np.setdiff1d(np.arange(len(corners)), doubts)
    assert np.array_equal(signs[certain], expected[certain])


@pytest.mark.parametrize("dim", [2, 3])
def test_single_precision_is_only_certain_where_it_is_right(dim):
    corners = almost_flat(dim, 3000, 1, 0)
    corners[:, -1] += np.random.default_rng(0).normal(size=(3000, dim)) * 10.0 ** -np.linspace(3, 9, 3000)[:, None]
    corners = np.clip(corners, 0, 1)
    expected = np.array([exact_sign(simplex) for simplex in corners])
    signs, doubts = signs_and_doubts(list(np.ascontiguousarray(corners.T, np.float32)))
    certain = np.setdiff1d(np.arange(len(corners)), doubts)
    assert 0 < len(certain) < len(corners)
    assert np.array_equal(signs[certain], expected[certain])


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(*[st.integers(-4, 4)] * 3), min_size=4, max_size=4))
def test_small_integers(corners):
    expected = exact_sign(corners)
    found = orientation_signs(np.array([corners], float))[0]
    assert found == expected if expected else found in (-1, 1)


def test_flat_simplices_have_the_sign_of_their_sorted_corners():
    flat = np.array([[[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]]], float)
    assert orientation_signs(flat) == [1]
    assert orientation_signs(flat[:, [1, 0, 2, 3]]) == [-1]
    assert orientation_signs(flat[:, [1, 2, 0, 3]]) == [1]
