"""Clouds that once broke a kernel, found by fuzzing; each fails without its mend."""

from __future__ import annotations

import numpy as np
import pytest

import contracts
import faces
import tetraskel
from nasty import Nasty
from tetraskel import InputError
from tetraskel.kernels import medial_nodes, walking
from tetraskel.kernels.barycentric import barycentric_coordinates
from tetraskel.kernels.centres import inscribed_weights
from tetraskel.kernels.inside_check import _follow
from tetraskel.kernels.passage_widths import triangle_widths

FOUND = {
    "widths of edges whose squares vanish": ("curve", Nasty("uniform", 3, 40, 1063220237, ("huge", "duplicates"))),
    "gate arrays of no points": ("interior", Nasty("few", 2, 26, 73454286, ("duplicates",))),
    "noise of points in one place": ("denoised", Nasty("solid", 2, 28, 1014239528, ("huge", "outlier"), "bool")),
    "a mask between the points of its grid": ("raster", Nasty("uniform", 3, 58, 651636505)),
    "slivers on a grid": ("raster", Nasty("hollow_box", 3, 28, 762764917, ("squeezed", "ulp_duplicates"))),
    "balls without radius": ("smooth_and_surface", Nasty("polyline", 2, 40, 556921284, (), ">i4")),
    "sheets without area": ("compare", Nasty("few", 3, 5, 32085272, ("mixed_scales",))),
    "cones that touch": ("balls", Nasty("solid", 2, 56, 885797255, ("tilted_plane", "outlier"), "reversed")),
    "Qhull's point at infinity": ("tree", Nasty("sheet", 3, 35, 608383176, ("outlier",))),
    "Qhull's point at infinity among the merged": ("tree", Nasty("sphere", 2, 31, 1052114947, ("squeezed", "huge"))),
    "facets whose area vanishes": ("tree", Nasty("solid", 3, 8, 150442786, ("duplicates", "tiny"))),
    "curves of small pieces": ("balls", Nasty("clusters", 3, 44, 364772223, ("tiny", "duplicates"))),
    "cells without a share": (
        "voronoi",
        Nasty("hollow_box", 3, 15, 881287043, ("duplicates", "mixed_scales"), "float32"),
    ),
    "turns that overflow": ("outline", Nasty("sheet", 3, 8, 45069681, ("duplicates", "huge"))),
    "an outline all in one place": ("outline", Nasty("grid", 2, 8, 39085629, ("tiny", "ulp_duplicates"))),
    "balls far from the origin": ("balls", Nasty("few", 3, 39, 707489505, ("huge",), "read only")),
    "a piece all in one place": ("given_mesh", Nasty("two_sheets", 2, 40, 709477506, ("tiny", "far_away"), "int64")),
    "steps without length": ("curve", Nasty("polyline", 2, 36, 121198482, ("tilted_plane", "huge"), "fortran")),
    "lines and sheets without length": ("compare", Nasty("grid", 3, 5, 14, ("mixed_scales",))),
    "many points in one place": ("denoised", Nasty("hollow_box", 2, 46, 0, ("mixed_scales",) * 2, "int64")),
    "thinning of huge coordinates": ("thinned", Nasty("solid", 3, 389, 533559049, ("huge", "turned"), "reversed")),
    "nodes without radii": ("given_mesh", Nasty("small", 2, 5, 25)),
    "triangles seen edge on": ("compare", Nasty("prism", 3, 11, 100390536, ("ulp_duplicates", "tilted_plane"))),
    "a surface too large for areas": ("surface_side", Nasty("prism", 3, 13, 476091663, ("huge",))),
    "centres of slivers": ("voronoi", Nasty("grid", 2, 53, 475463209, ("ulp_duplicates",))),
}


@pytest.mark.parametrize("name", FOUND)
def test_keeps_its_contract(name):
    probe, cloud = FOUND[name]
    assert contracts.kept(contracts.PROBES[probe], cloud) in ("result", "error")


def clusters():
    """Three clusters a million times smaller than their distances, between which everything is flat."""
    mesh = tetraskel.triangulate(Nasty("clusters", 3, 58, 26862732).array())
    return tetraskel.curve_model(mesh, inside=np.ones(len(mesh)))


def test_nodes_lie_where_they_say():
    model = clusters()
    inner, nodes = model.inner, model.nodes
    held = barycentric_coordinates(inner.coordinates, inner.simplices[nodes.homes], nodes.positions).min(axis=1)
    assert held[nodes.is_medial].min() > -1e-3


def test_walks_that_circle_end_soon(monkeypatch):
    inner, rounds = clusters().inner, []
    step = walking._step
    monkeypatch.setattr(walking, "_step", lambda *given: rounds.append(1) or step(*given))
    n = len(inner.simplices)
    centres = medial_nodes.circumcentres(inner.coordinates, inner.simplices)[0]
    walking.walk_to(inner.coordinates, inner.simplices, inner.neighbors, np.arange(n), centres)
    assert 0 < len(rounds) < 200


def test_segments_that_circle_do_not_arrive():
    """Two simplices without volume that lead into each other."""
    inner = clusters().inner
    n = len(inner.simplices)
    rng = np.random.default_rng(0)
    start = inner.coordinates[inner.simplices].mean(axis=1)
    with contracts.time_limit(20):
        arrived = _follow(inner, np.arange(n), start, start[rng.permutation(n)])
    assert arrived.shape == (n,)


def test_a_gap_between_clusters_takes_few_samples():
    mesh = tetraskel.triangulate(Nasty("clusters", 3, 44, 139055073).array())
    inside = mesh.points[mesh.simplices].mean(axis=1)[:, 0] > 0.5
    skeleton = tetraskel.draw_curve(tetraskel.curve_model(mesh, inside=inside), detail=1.0)
    assert 0 < len(skeleton) < 20_000


@pytest.mark.parametrize("scale", [1e-200, 1e-31, 1e31, 1e90])
def test_sizes_beyond_what_can_be_calculated_with_are_told(scale):
    points = np.random.default_rng(0).random((30, 3)) * scale
    mesh = tetraskel.triangulate(points)  # a triangulation takes any unit
    for call in (tetraskel.gate_tree, tetraskel.curve_model, tetraskel.voronoi_skeleton):
        with pytest.raises(InputError, match="give them in another unit"):
            call(mesh)
    with pytest.raises(InputError, match="give them in another unit"):
        tetraskel.skeleton_surface((points, [], np.zeros(30)))


@pytest.mark.parametrize("scale", [1e-28, 1e28])
def test_sizes_just_within_give_the_same_skeleton(scale):
    points = np.random.default_rng(0).random((40, 3))
    skeletons = [
        tetraskel.curve_skeleton(tetraskel.triangulation_of(points * unit, tetraskel.triangulate(points).simplices))
        for unit in (1.0, scale)
    ]
    assert np.allclose(skeletons[1].points, skeletons[0].points * scale, rtol=1e-6, atol=0)


def test_widths_of_edges_whose_squares_vanish():
    assert triangle_widths(np.zeros((3, 2))).tolist() == [0, 0]
    assert triangle_widths(np.full((3, 1), 1e-200)).tolist() == [0]


def test_all_flat_is_told():
    points = np.random.default_rng(0).random((30, 3)) * [1, 1, 1e-7]
    with pytest.raises(InputError, match="lower the threshold"):
        tetraskel.tree_skeleton(points)
    assert len(tetraskel.tree_skeleton(points, threshold=0.0).points) > 0


@pytest.mark.parametrize(
    "cloud",
    [
        Nasty("grid", 3, 16, 30753, ("ulp_duplicates", "ulp_duplicates")),  # a raster line missed by 1e308 grid steps
        Nasty("sphere", 3, 14, 1106, ("far_away", "duplicates"), ">f4"),  # a mask of cells all in one place
    ],
    ids=repr,
)
def test_chains_of_filters_take(cloud):
    assert faces.filtered(cloud) in ("result", "error")


def test_rays_past_triangles_next_to_nothing(tmp_path):
    cloud = Nasty("hollow_box", 3, 5, 25, ("duplicates", "ulp_duplicates"))  # sides of 5e-324
    assert faces.commanded(cloud, tmp_path) == "result"


@pytest.mark.parametrize("scale", [1e-160, 1e-90, 1.0, 1e90])
def test_incentres_have_no_unit(scale):
    points = np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5.0]])
    weights = inscribed_weights(tetraskel.triangulate(points * scale))
    sizes = np.sort([10, 7.5, 6, 0.5 * np.sqrt(12**2 + 15**2 + 20**2)])
    assert np.allclose(np.sort(weights[0]), sizes / sizes.sum())


@pytest.mark.parametrize("edges", [[[0, 1], [2]], [[0.5, 1.0]], [0, 1, 2], [["a", "b"]]])
def test_edges_that_are_no_pairs_of_ids(edges):
    with pytest.raises(InputError, match="expected edges as"):
        tetraskel.bezier_skeleton((np.zeros((3, 3)), edges, np.ones(3)))


def test_a_mask_between_the_points_of_its_grid_is_told():
    corners = np.array([[0, 0, 0], [1, 0, 0.0], [0, 1, 0], [0, 0, 1]])
    corners = np.concatenate([corners, corners[1:] * 0.99])
    mesh = tetraskel.triangulate(corners)
    inside = np.zeros(len(mesh))
    with pytest.raises(InputError, match="expected an object with an inside"):
        tetraskel.rasterise(mesh, inside=inside)
    thin = tetraskel.triangulation_of([[0, 0.5, 0.5], [1, 0.5, 0.6], [0.5, 0, 0.4], [0.5, 1, 0.45]], [[0, 1, 2, 3]])
    with pytest.raises(InputError, match="raise it"):
        tetraskel.rasterise(thin, resolution=2)


def test_grid_cells_smaller_than_rounding_are_told():
    with pytest.raises(InputError, match="larger than the rounding of the coordinates"):
        tetraskel.skeleton_surface(([[1e20, 0, 0]], [], [1.0]))


def test_an_outlier_does_not_overflow_the_grid_of_the_noise():
    rng = np.random.default_rng(0)
    ways = rng.normal(size=(3000, 3))
    ball = ways / np.linalg.norm(ways, axis=1, keepdims=True) * (1 + 0.03 * rng.normal(size=(3000, 1)))
    found = tetraskel.denoised(np.concatenate([ball, [[1e9, 1e9, 1e9]]]))
    assert found.noise > 0
    assert len(found.points) > 500
