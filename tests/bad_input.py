"""Bad input for every error of the kernels, one row each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import tetraskel
from bad_rows import (
    BALLS,
    BETWEEN,
    CORNERS,
    FAR_AWAY,
    IN_ONE_PLACE,
    NO_NUMBERS,
    NO_OTHERS,
    OFF,
    OTHERS,
    OURS,
    OUTWARDS,
    RANDOM,
    RING,
    SQUARE,
    Bad,
    against_row,
    around_the_square,
    balls_row,
    bent_grid,
    cloud,
    flat_mesh,
    grid,
    ill_qhull,
    labels_row,
    lines,
    mask_row,
    mesh_of,
    mesh_of_qhull,
    mesh_row,
    nothing_inside,
    outline_row,
    patched,
    points_row,
    random_grid,
    side_row,
    square_model,
    with_a_point_less,
    without_simplices,
    wrong_collapse,
    wrong_loops,
)
from tetraskel.kernels import object_boundary, outline, surface_side, tree
from tetraskel.kernels.ball_graph import BallGraph, ball_graph
from tetraskel.kernels.nearest import Cloud
from tetraskel.kernels.noise import scatter

ROWS = {
    "points: masked": Bad(lambda: tetraskel.triangulate(np.ma.masked_less(RANDOM, 0.5)), why=NO_NUMBERS),
    "points: ragged": Bad(lambda: tetraskel.triangulate([[0, 0], [1]]), why=NO_NUMBERS),
    "points: shape": Bad(lambda: tetraskel.triangulate(np.zeros((4, 5))), why=NO_NUMBERS),
    "points: words": Bad(lambda: tetraskel.triangulate(np.full((4, 3), "a")), why=NO_NUMBERS),
    "points: NaN": points_row(OFF),
    "points: two": points_row(CORNERS[:2]),
    "points: two, doubled": points_row(CORNERS[[0, 1, 0, 1]]),
    "points: on a line": points_row(np.outer(np.arange(5), [1, 2, 3])),
    "points: too close for lengths": Bad(
        lambda: tetraskel.curve_skeleton(RANDOM * 1e-35),
        lambda: cloud(RANDOM * 1e-35),
        "CurveSkeleton",
        command="skeleton",
    ),
    "mesh: a point twice": mesh_row(CORNERS, [[0, 1, 2, 2]]),
    "mesh: three on a facet": mesh_row(CORNERS, [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]),
    "mesh: closed": mesh_row(CORNERS, [[0, 1, 2, 3], [0, 1, 2, 3]]),
    "mesh: bent": Bad(
        lambda: tetraskel.curve_model(tetraskel.triangulation_of(bent_grid().points, [[0, 1, 2], [1, 3, 2]])),
        bent_grid,
        "CurveSkeleton",
        command="skeleton",
    ),
    "mesh: shape": Bad(lambda: tetraskel.triangulation_of(CORNERS, [[0, 1]]), why=NO_NUMBERS),
    "mesh: fractions": Bad(lambda: tetraskel.triangulation_of(CORNERS, [[0.5, 1, 2, 3]]), why=NO_NUMBERS),
    "mesh: no such point": Bad(
        lambda: tetraskel.triangulation_of(CORNERS, [[0, 1, 2, 99]]), why="VTK itself reads beyond its arrays"
    ),
    "mesh: none": Bad(lambda: tetraskel.build_tree(CORNERS), why=NO_OTHERS),
    "tree: none": Bad(lambda: tree.expect_tree(None), why=NO_OTHERS),
    "tree: without flat nodes": Bad(
        lambda: tetraskel.decode_tree(tetraskel.remove_flat(tetraskel.build_tree(mesh_of()), threshold=0.5)),
        why="no filter decodes a tree",
    ),
    "inside: no surface": Bad(
        lambda: tetraskel.interior(mesh_of(), method="surface"),
        random_grid,
        "InteriorCells",
        {"method": "surface"},
        command="tree --inside surface",
        own={
            "filter": "expected a closed surface at the second input, got nothing; connect one.",
            "shell": "expected --boundary FILE with --inside surface, got none.",
        },
    ),
    "inside: no labels": Bad(
        lambda: tetraskel.interior(mesh_of(), method="array"),
        random_grid,
        "InteriorCells",
        {"method": "array", "label_array": "Labels"},
        command="tree --inside array --label-array Labels",
        own={"filter": "expected a cell array 'Labels' on the mesh, got none; name another one."},
    ),
    "inside: labels of two": labels_row(lambda n: np.ones((n, 2))),
    "inside: NaN labels": labels_row(lambda n: np.full(n, np.nan)),
    "inside: words": Bad(
        lambda: tetraskel.interior(mesh_of(), method="array", labels=np.full(len(mesh_of()), "a")), why=NO_NUMBERS
    ),
    "surface: triangles": side_row(CORNERS[:4], OUTWARDS, flat_mesh),
    "surface: none": side_row(CORNERS[:4], np.empty((0, 3), int)),
    "surface: NaN": side_row(np.vstack([CORNERS[:3], [[np.nan, 0, 1]]]), OUTWARDS),
    "surface: open": side_row(CORNERS[:4], OUTWARDS[:3]),
    "surface: inside out": side_row(CORNERS[:4], OUTWARDS[:, ::-1]),
    "surface: twisted": side_row(CORNERS[:4], np.vstack([OUTWARDS[:3], OUTWARDS[3:, ::-1]])),
    "surface: no such point": Bad(
        lambda: surface_side.checked_surface(CORNERS[:4], [[0, 1, 9]]), why="VTK itself reads beyond its arrays"
    ),
    "outline: in space": outline_row(SQUARE, [[0, 1], [1, 2], [2, 3], [3, 0]], mesh_of, random_grid),
    "outline: no lines": outline_row(SQUARE, []),
    "outline: NaN": outline_row([[0, 0, 0], [1, 0, 0], [np.nan, 1, 0]], [[0, 1], [1, 2], [2, 0]]),
    "outline: open": outline_row(SQUARE, [[0, 1], [1, 2], [2, 3]]),
    "outline: crossing": outline_row(0.5 * SQUARE + 0.2, [[0, 2], [2, 1], [1, 3], [3, 0]]),
    "outline: two coordinates": Bad(lambda: outline.checked_outline(mesh_of(), SQUARE, [[0, 1]]), why=NO_OTHERS),
    "curve: fills a volume": Bad(
        lambda: tetraskel.curve_skeleton(RANDOM),
        lambda: cloud(RANDOM),
        "CurveSkeleton",
        command="skeleton",
        own={
            "shell": f"expected an object with an inside, got none in {len(RANDOM)} points: they may fill a volume, "
            "lie on an open surface, or be too sparse; use --inside all to take all of it as inside, or --method tree "
            "to draw the tree."
        },
    ),
    "thinning: NaN": Bad(lambda: tetraskel.thinned(OFF), lambda: cloud(OFF), "PointThinning", command="thin"),
    "thinning: far away": Bad(
        lambda: tetraskel.thinned(FAR_AWAY, most_points=100),
        lambda: cloud(FAR_AWAY),
        "PointThinning",
        {"most_points": 100},
        command="thin --most-points 100",
    ),
    "curve: root": Bad(lambda: tetraskel.draw_curve(square_model(), root=[0.0]), why=NO_OTHERS),
    "voronoi: nothing inside": nothing_inside(tetraskel.voronoi_skeleton, "VoronoiSkeleton", "voronoi --inside all"),
    "raster: nothing inside": nothing_inside(tetraskel.rasterise, "RasterSkeleton", "raster --inside all"),
    "balls: radii of two": balls_row(CORNERS[:2], np.ones((2, 2))),
    "balls: NaN": balls_row([[0, 0, 0], [np.nan, 0, 0]], [1, 1]),
    "balls: negative": balls_row(CORNERS[:2], [1, -1]),
    "balls: shape": Bad(lambda: ball_graph(BallGraph(np.zeros((2, 4)), np.ones(2), [0], [])), why=NO_NUMBERS),
    "balls: no such point": Bad(
        lambda: ball_graph(BallGraph(CORNERS[:2], np.ones(2), np.array([0, 2]), np.array([0, 9]))),
        why="VTK itself reads beyond its arrays",
    ),
    "balls: not in a plane": Bad(
        lambda: tetraskel.skeleton_surface(
            BallGraph(CORNERS[:4], np.ones(4), np.array([0, 4]), np.arange(4)), dimension="plane"
        ),
        lambda: lines(CORNERS[:4], np.ones(4), [[0, 1, 2, 3]]),
        "SkeletonSurface",
        {"dimension": "plane"},
        command="surface --dimension plane",
    ),
    "balls: two coordinates in space": Bad(
        lambda: tetraskel.skeleton_surface(
            BallGraph(SQUARE[:, :2], np.ones(4), np.array([0, 4]), np.arange(4)), dimension="space"
        ),
        why=NO_NUMBERS,
    ),
    "balls: ragged edges": Bad(lambda: ball_graph((CORNERS[:2], [[0, 1], [0]], np.ones(2))), why=NO_NUMBERS),
    "balls: edges of three": Bad(lambda: ball_graph((CORNERS[:3], [[0, 1, 2]], np.ones(3))), why=NO_NUMBERS),
    "balls: far from the origin": Bad(
        lambda: tetraskel.skeleton_surface(BallGraph(CORNERS[:2] + 1e17, np.ones(2), np.array([0, 2]), np.arange(2))),
        why="with coordinates as single numbers, as files often have them, such points are in one place",
    ),
    "original: none": against_row(np.empty((0, 3))),
    "original: NaN": against_row(OFF),
    "original: in one place": against_row(np.zeros((3, 3))),
    "original: two coordinates": Bad(
        lambda: tetraskel.surface_error(tetraskel.skeleton_surface(BALLS), np.zeros((3, 2))),
        why=NO_NUMBERS,
    ),
    "mask: nothing": mask_row(RING),
    "mask: between the grid": Bad(
        lambda: tetraskel.rasterise(tetraskel.triangulation_of(BETWEEN, [[0, 1, 2, 3]]), resolution=2),
        lambda: grid(BETWEEN, [[0, 1, 2, 3]]),
        "RasterSkeleton",
        {"resolution": 2},
        command="raster --inside all --resolution 2",
    ),
    "mask: of one place": Bad(
        lambda: tetraskel.rasterise(tetraskel.triangulation_of(*IN_ONE_PLACE), inside=[1, 0], resolution=9),
        lambda: grid(*IN_ONE_PLACE, Inside=np.array([1, 0])),
        "RasterSkeleton",
        command="raster --inside array",
    ),
    "mask: NaN": mask_row(np.where(RING == 0, np.nan, 0)),
    "mask: one axis": Bad(lambda: tetraskel.raster_skeleton(np.ones(4)), why=NO_NUMBERS),
    "mask: words": Bad(lambda: tetraskel.raster_skeleton(np.full((2, 2), "a")), why=NO_NUMBERS),
    "mask: spacing of two": Bad(lambda: tetraskel.raster_skeleton(RING + 1, spacing=[1, 1]), why=NO_NUMBERS),
    "mask: no spacing": Bad(lambda: tetraskel.raster_skeleton(RING + 1, spacing=0.0), why="VTK's own images have one"),
    "mask: not morphological": Bad(
        lambda: tetraskel.morphological_reversal(tetraskel.raster_skeleton(RING + 1, method="distance")),
        why="no filter goes back",
    ),
    "qhull: gives up": Bad(patched("scipy.spatial.Delaunay", ill_qhull, mesh_of_qhull), why=OTHERS),
    "qhull: no mesh": Bad(patched("tetraskel.kernels.qhull.is_mesh", lambda *_: False, mesh_of_qhull), why=OTHERS),
    "engine: no simplex": Bad(
        patched("tetraskel.kernels.qhull.delaunay", without_simplices, mesh_of_qhull), why=OTHERS
    ),
    "outline: a point is lost": Bad(
        patched("tetraskel.kernels.outline.triangulate", with_a_point_less, around_the_square), why=OTHERS
    ),
    "outline: splits for ever": Bad(patched("tetraskel.kernels.outline.ROUNDS", 1, around_the_square), why=OTHERS),
    "scipy: nearest points": Bad(
        patched("scipy.spatial", None, lambda: Cloud(RANDOM).query(RANDOM)), why="it depends on what is installed"
    ),
    "scipy: noise": Bad(patched("scipy.spatial", None, lambda: scatter(RANDOM)), why="it depends on what is installed"),
    "measure: plane": Bad(
        lambda: tetraskel.measure(tetraskel.draw_curve(square_model()), (SQUARE, [[0, 1, 2]])), why=NO_NUMBERS
    ),
    "measure: no triangles": Bad(
        lambda: tetraskel.measure(
            replace(tetraskel.draw_curve(square_model()), points=CORNERS), (SQUARE, np.empty((0, 3)))
        ),
        why=NO_OTHERS,
    ),
    "compare: facets": Bad(lambda: object_boundary.given_boundary(mesh_of(), (SQUARE, [[0, 1]])), why=NO_OTHERS),
    "compare: NaN": Bad(
        lambda: object_boundary.given_boundary(mesh_of(), (SQUARE * np.nan, [[0, 1, 2]])), why="no filter compares"
    ),
    "compare: no such point": Bad(
        lambda: object_boundary.given_boundary(mesh_of(), (SQUARE, [[0, 1, 9]])), why="no filter compares"
    ),
    "curve: loops that were not found": Bad(wrong_loops, why=OURS),
    "curve: another topology": Bad(wrong_collapse, why=OURS),
}
