"""Walks around the parts of Voronoi faces: as the slabs have them, with corners in common, and what they leave."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest

from shapes import SOLIDS
from tetraskel import triangulate
from tetraskel.kernels.voronoi_clip import clipped_faces
from tetraskel.kernels.voronoi_crossings import find_crossings
from tetraskel.kernels.voronoi_diagram import voronoi_diagram, without_flat_rim
from tetraskel.kernels.voronoi_faces import EDGES, ordered_faces
from tetraskel.kernels.voronoi_parts import parts_of_faces
from tetraskel.kernels.voronoi_sides import edges_wholly_inside, vertices_inside


def walked(points, inside_of):
    """The diagram, its crossings, who is inside, all its faces, and the parts that walks tell."""
    mesh = triangulate(points)
    diagram = without_flat_rim(voronoi_diagram(mesh, inside_of(mesh)))
    crossings = find_crossings(diagram)
    inside = vertices_inside(diagram, crossings)
    every = np.ones((len(mesh), len(EDGES)), bool)
    faces = ordered_faces(diagram, every, crossings.faces)
    whole = edges_wholly_inside(diagram, crossings, inside)
    return diagram, crossings, inside, faces, parts_of_faces(diagram, crossings, inside, whole, faces)


def torus(n):
    shape = SOLIDS["torus"]()
    return shape.sample(n, np.random.default_rng(5)), lambda mesh: shape.contains(
        mesh.points[mesh.simplices].mean(axis=1)
    )


def ball_in_a_volume(n):
    points = np.random.default_rng(6).random((n, 3))
    return points, lambda mesh: ((mesh.points[mesh.simplices].mean(axis=1) - 0.5) ** 2).sum(axis=1) < 0.1


def areas_by_face(faces, starts, corners, n_faces):
    """(q,) area of all polygons of each face."""
    rings = [corners[first:last] for first, last in pairwise(starts)]
    areas = [np.linalg.norm(np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)) / 2 for ring in rings]
    return np.bincount(faces, areas, minlength=n_faces)


@pytest.mark.parametrize("cloud", [torus, ball_in_a_volume])
def test_parts_have_the_areas_that_slabs_have(cloud) -> None:
    diagram, crossings, inside, faces, parts = walked(*cloud(1500))
    places = np.concatenate([diagram.positions, crossings.positions, crossings.segments.places[:, 0]])
    n = len(faces.keys)
    told = np.ones(n, bool)
    told[parts.unsure] = False
    assert told.mean() > 0.98
    found = areas_by_face(parts.faces, np.append(0, np.cumsum(parts.counts)), places[parts.nodes], n)
    expected = areas_by_face(*clipped_faces(diagram, crossings, inside, faces), n)
    # slabs cut the ring of the centres, which are rough where simplices are nearly flat; walks go by crossings
    corners = diagram.coordinates[diagram.simplices]
    away = np.linalg.norm(corners - diagram.positions[: len(corners), None], axis=2)
    exact = told & ~faces.any_of((np.ptp(away, axis=1) > 1e-9)[faces.cells])
    assert exact.mean() > 0.8
    assert (found[exact] > 0).mean() > 0.1
    assert np.allclose(found[exact], expected[exact], rtol=1e-9, atol=1e-9)


def test_corners_are_common() -> None:
    """In general position three faces meet where a Voronoi edge crosses the boundary; all else is of one face."""
    diagram, crossings, *_, parts = walked(*torus(1500))
    assert len(parts.unsure) == 0
    n, m = len(diagram.positions), len(diagram.positions) + len(crossings.edges)
    used = np.bincount(parts.nodes, minlength=m + len(crossings.segments.faces))
    assert (used[n:m] == 3).all()
    assert used[m:].max() == 1


def test_a_face_that_the_boundary_crosses_without_meeting_its_edges_is_left_to_slabs() -> None:
    needle = [[0, 0, 0], [-1, 0.1, 0], [-1, 0, 0.1], [10, 0.2, 0.1]]
    diagram, crossings, inside, faces, parts = walked(needle, lambda mesh: np.ones(len(mesh), bool))
    assert len(parts.unsure) > 0
    assert len(clipped_faces(diagram, crossings, inside, faces.some(parts.unsure))[0]) > 0


def test_faces_that_only_touch_the_boundary_are_left_to_slabs() -> None:
    lattice = np.array(list(product(range(3), repeat=3)), float)
    *_, faces, parts = walked(lattice, lambda mesh: np.ones(len(mesh), bool))
    assert 0 < len(parts.unsure) <= len(faces.keys)
    assert not np.isin(parts.faces, parts.unsure).any()
