"""The predicates of the exact engine, stage by stage, against exact rationals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rationals import inside, orientation, raised, sign, whole_numbers
from tetraskel.kernels.compilation import compiled, numba_is_used

if not numba_is_used():
    pytest.skip("the exact engine needs numba (the extra fast)", allow_module_level=True)

from tetraskel.kernels.exact import limbs, predicates

NEVER = (np.inf, np.inf)


@compiled
def answers_of_the_plane(p, bounds):
    """Orientation of three points; whether the fourth lies in their circle; both by the last stage alone."""
    x, y = p[:, 0].copy(), p[:, 1].copy()
    return (
        predicates.orient2(x[0], y[0], x[1], y[1], x[2], y[2], bounds[0]),
        predicates.in_circle(x[0], y[0], x[1], y[1], x[2], y[2], x[3], y[3], bounds),
        limbs.determinant_sign(p[:3].copy().ravel(), 2),
        limbs.determinant_sign(p.ravel(), 2),
    )


@compiled
def answers_of_space(p, bounds):
    x, y, z = p[:, 0].copy(), p[:, 1].copy(), p[:, 2].copy()
    return (
        predicates.orient3(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2], x[3], y[3], z[3], bounds[0]),
        predicates.in_sphere(
            x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2], x[3], y[3], z[3], x[4], y[4], z[4], bounds
        ),
        -limbs.determinant_sign(p[:4].copy().ravel(), 3),  # its differences are to the last point, not the first
        -limbs.determinant_sign(p.ravel(), 3),
    )


ANSWERS = {2: answers_of_the_plane, 3: answers_of_space}


def assert_right(points):
    """All stages give the sign of the rational determinant; ties go as tiny real heights would have them."""
    dim = points.shape[1]
    whole = whole_numbers(points)
    side = sign(orientation(whole[:-1]))
    lifted = sign(inside(whole[:-1], whole[-1]))
    perturbed = sign(inside(whole[:-1], whole[-1], raised(whole)))
    for bounds in (NEVER, predicates.static_bounds(points)):
        found = ANSWERS[dim](points, bounds)
        assert found[0] == side
        assert found[2:] == (side, lifted)
        if side > 0 and len(np.unique(points, axis=0)) == len(points):
            assert found[1] == (perturbed > 0)


def positive(points):
    """The same points, the first two exchanged where that makes the simplex positive."""
    turned = sign(orientation(whole_numbers(points)[:-1])) < 0
    return points[[1, 0, *range(2, len(points))]] if turned else points


shapes = st.sampled_from([2, 3])
seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=150, deadline=None)
@given(seeds, shapes, st.integers(-3, 3))
def test_almost_cospherical_points(seed, dim, ulps):
    """Whole points of one sphere, moved, scaled, and each coordinate off by a few units of its last place."""
    rng = np.random.default_rng(seed)
    axes = np.stack(np.meshgrid(*[np.arange(-6, 7)] * dim), -1).reshape(-1, dim)
    on = axes[(axes**2).sum(axis=1) == (25 if dim == 2 else 26)]
    points = rng.permutation(on)[: dim + 2] * 0.1 + rng.choice([0.0, 0.3, 1e3, 1e6])
    points = points + ulps * rng.integers(-1, 2, points.shape) * np.spacing(points)
    assert_right(positive(points))


@settings(max_examples=150, deadline=None)
@given(seeds, shapes, st.integers(-2, 2))
def test_almost_flat_simplices(seed, dim, ulps):
    rng = np.random.default_rng(seed)
    points = rng.integers(-4, 5, (dim + 2, dim)) * 0.1
    points[:, -1] = points[:, 0] * 3 + (points[:, 1] if dim == 3 else 0.2)
    points = points + ulps * rng.integers(-1, 2, points.shape) * np.spacing(points)
    assert_right(positive(points))


@settings(max_examples=100, deadline=None)
@given(seeds, shapes, st.sampled_from([1e-60, 1e-9, 1.0, 1e6, 1e59]))
def test_small_whole_points_at_every_scale(seed, dim, scale):
    rng = np.random.default_rng(seed)
    assert_right(positive(rng.integers(-2, 3, (dim + 2, dim)) * scale))


@settings(max_examples=150, deadline=None)
@given(seeds, shapes)
def test_coordinates_of_very_different_sizes(seed, dim):
    """Below what floating-point products can hold, and far beyond what 64-bit integers can."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-3, 4, (dim + 2, dim)) * 10.0 ** rng.integers(-300, 50, (dim + 2, dim))
    assert_right(positive(points))


@settings(max_examples=100, deadline=None)
@given(st.data(), shapes)
def test_any_doubles(data, dim):
    number = st.floats(-1e60, 1e60, allow_subnormal=True)
    points = np.array(data.draw(st.lists(number, min_size=dim * (dim + 2), max_size=dim * (dim + 2))))
    assert_right(positive(points.reshape(dim + 2, dim)))


@pytest.mark.parametrize("dim", [2, 3])
def test_floating_point_errors_stay_below_the_bounds(dim):
    """The filter's bound holds for the error itself, not only for the sign, and is not larger than needed by much."""
    rng, worst = np.random.default_rng(0), 0.0
    for _ in range(300):
        points = rng.choice([0.1, 0.3, 0.7], (dim + 2, dim)) + rng.integers(-9, 10, (dim + 2, dim)) * 2.0**-53
        points = points + rng.random((dim + 2, dim)) * rng.choice([0, 1e-3, 1])
        whole = whole_numbers(points)
        factor = float(whole.ravel()[0] / points.ravel()[0])
        differences = np.abs(points[:-1] - points[-1]).max(axis=0)
        bound = (predicates.CIRCLE if dim == 2 else predicates.SPHERE) * differences.prod() * (differences**2).sum()
        exact = float(inside(whole[:-1], whole[-1])) / factor ** (dim + 2)
        worst = max(worst, abs(_sphere_value(points) - exact) / bound)
    assert 0.005 < worst < 1


def _sphere_value(points):
    rows = (points[:-1] - points[-1]).tolist()
    if len(rows) == 4:
        return predicates.sphere_value.py_func(*[x for row in rows for x in row])
    (a, b), (c, d), (e, f) = rows
    return (a * a + b * b) * (c * f - d * e) + (c * c + d * d) * (e * b - f * a) + (e * e + f * f) * (a * d - b * c)
