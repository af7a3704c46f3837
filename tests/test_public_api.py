"""What other programs may rely on; a name that goes or comes is a decision, made here too."""

from __future__ import annotations

import inspect
from dataclasses import fields, is_dataclass

import tetraskel
from tetraskel import cli, vtkfilters
from tetraskel.pyvista_accessor import TetraskelAccessor

FUNCTIONS = {
    "assemble_skeleton": "tree, *, centre, keep_leaves",
    "bezier_skeleton": "skeleton, *, tolerance, samples, roots, tick",
    "binarize": "tree",
    "build_tree": "mesh, *, traversal, tick",
    "compare": "points_or_mesh, surface, *, inside, methods, detail, least_angle, resolution, denoise, tick",
    "curve_model": "mesh, *, inside, loop_spacings, tick",
    "curve_skeleton": "points_or_mesh, *, detail, loop_spacings, denoise, inside, root, tick",
    "decode_tree": "tree",
    "denoised": "points, tick",
    "draw_curve": "model, *, detail, root, tick",
    "gate_arrays": "tree, neighbors",
    "gate_tree": "mesh, *, tick",
    "inside_by_outline": "mesh, points, segments, *, tick",
    "interior": "mesh, *, method, ratio, noise, surface, outline, labels, tick",
    "measure": "skeleton, surface, *, tick",
    "medial_mesh": "model, *, sheet_angle, tick",
    "morphological_reversal": "skeleton, *, tick",
    "raster_skeleton": "mask, *, method, element, ridge_slope, spacing, origin, tick",
    "rasterise": "mesh, *, inside, resolution, tick",
    "remove_flat": "tree, *, threshold, tick",
    "skeleton_surface": "skeleton, *, spacing, cells_per_radius, max_cells, dimension, tick",
    "submesh": "mesh, kept",
    "surface_error": "rebuilt, points, triangles, *, tick",
    "thinned": "points, *, most_points, samples_per_radius, tick",
    "tree_skeleton": "points, *, engine, joggle, denoise, traversal, centre, threshold, keep_leaves, tick",
    "triangulate": "points, *, engine, joggle, denoise, tick",
    "triangulation_of": "points, simplices",
    "voronoi_skeleton": "mesh, *, method, inside, least_separation, least_angle, tick",
}
RESULTS = {
    "BezierSkeleton", "BinaryTree", "CurveModel", "Denoised", "Mask", "MedialMesh", "RasterSkeleton", "RebuiltSurface",
    "Row", "Skeleton", "Thinned", "Tree", "TreeSkeleton", "Triangulation", "VoronoiSkeleton",
}  # fmt: skip
ERRORS = {"Aborted", "EngineError", "InputError", "InsideWarning", "MeshError", "TetraskelError"}
FILTERS = {
    "BezierSkeleton", "CurveSkeleton", "DelaunayMesh", "FlatTetraRemoval", "InteriorCells", "PointThinning",
    "RasterSkeleton", "SkeletonFilter", "SkeletonOutput", "SkeletonSurface", "TreeBuilder", "VoronoiSkeleton",
}  # fmt: skip
METHODS = {
    "bezier", "branches", "delaunay", "interior", "raster", "remove_flat", "skeleton", "surface", "thin", "tree",
    "voronoi",
}  # fmt: skip
COMMANDS = [
    "skeleton", "tree", "voronoi", "raster", "thin", "surface", "bezier", "compare", "measure", "view", "plugin-path",
    "completion",
]  # fmt: skip


def parameters_of(function):
    """Names in order, a star before those by keyword only."""
    taken = list(inspect.signature(function).parameters.values())
    names = [one.name for one in taken]
    first = next((k for k, one in enumerate(taken) if one.kind == one.KEYWORD_ONLY), None)
    return ", ".join(names if first is None else [*names[:first], "*", *names[first:]])


def test_the_names():
    assert set(tetraskel.__all__) == set(FUNCTIONS) | RESULTS | ERRORS
    assert tetraskel.__all__ == sorted(tetraskel.__all__)


def test_the_parameters_of_functions():
    assert {name: parameters_of(getattr(tetraskel, name)) for name in FUNCTIONS} == FUNCTIONS


def test_results_are_frozen():
    for name in RESULTS:
        made = getattr(tetraskel, name)
        assert is_dataclass(made)
        assert made.__dataclass_params__.frozen, name
        assert fields(made)


def test_filters_methods_and_commands():
    assert set(vtkfilters.__all__) == FILTERS
    assert {name for name, made in vars(TetraskelAccessor).items() if hasattr(made, "chain")} == METHODS
    assert list(cli.COMMANDS) == COMMANDS


def test_everything_public_says_what_it_is():
    for name in tetraskel.__all__:
        assert inspect.getdoc(getattr(tetraskel, name)), name
