"""Inside by gates on many ranks (threads here): the serial answer, cell for cell."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from dealt import box_shell, dealt, lattice, noisy, torus, uniform
from shapes import SOLIDS
from tetraskel import InputError, InsideWarning, gate_arrays, gate_tree, interior, triangulate
from tetraskel.distributed.in_process import run_on_ranks
from tetraskel.distributed.interior import MeshOfRanks, interior_of_part
from tetraskel.distributed.parts import part_of_mesh
from tetraskel.distributed.surface import lie_on_surface
from tetraskel.distributed.triangulation import triangulate_part
from tetraskel.kernels.adjacency import triangulation_of
from tetraskel.kernels.compilation import numba_is_used
from tetraskel.kernels.denoise import lies_on_surface
from tetraskel.kernels.interior import surface_share
from tetraskel.kernels.mesh import submesh
from tetraskel.kernels.object_boundary import boundary_of
from tetraskel.options import InteriorOptions

needs_numba = pytest.mark.skipif(not numba_is_used(), reason="numba is not installed (the extra fast)")


def sampled(name):
    """A cloud of the surface of a known solid."""

    def cloud(rng, n):
        return SOLIDS[name]().sample(n, rng)

    cloud.__name__ = name
    return cloud


CLOUDS = {torus: 400, sampled("two_balls"): 350, sampled("bottle"): 400, box_shell: 400, uniform: 400, lattice: 216,
          noisy: 350}  # fmt: skip
OPTIONS = {"bottle": {"ratio": 4.0}, "noisy": {"noise": 2.0}}
ARRAYS = ("width", "room_radius", "parent")


def serial(mesh, options):
    """Inside, and what is warned of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InsideWarning)
        inside = interior(mesh, **options)
    return inside, [str(warning.message) for warning in caught]


def assert_serial(found, mesh, expected, messages):
    """Inside, the gate tree and the boundary are the serial ones."""
    parts, told = zip(*found, strict=True)
    assert np.array_equal(np.concatenate([one.inside for one in told]), expected)
    assert all(one.messages == messages for one in told)
    arrays = gate_arrays(gate_tree(mesh), mesh.neighbors)
    for name in ARRAYS:
        values = np.concatenate([getattr(one.gates, name) for one in told])
        assert np.array_equal(values, getattr(arrays, name)), name
    facets = [
        part.point_ids[boundary_of(replace(part.mesh, neighbors=one.neighbors), one.everywhere).facets]
        for part, one in zip(parts, told, strict=True)
    ]
    assert np.array_equal(np.concatenate(facets), boundary_of(mesh, expected).facets)


@needs_numba
@pytest.mark.parametrize("size", [1, 2, 3, 4, 8])
@pytest.mark.parametrize("cloud", CLOUDS, ids=lambda cloud: cloud.__name__)
def test_inside_on_ranks_is_the_serial_one(cloud, size):
    rng = np.random.default_rng(size)
    points = cloud(rng, CLOUDS[cloud])
    points = np.concatenate([points, points[:10]])
    mesh = triangulate(points, engine="exact")
    options = OPTIONS.get(cloud.__name__, {})
    expected, messages = serial(mesh, options)
    assert expected.any() == (cloud not in (uniform, lattice))
    assert any("nothing lies inside" in message for message in messages) == (cloud in (uniform, lattice))
    for by in ("random", "space"):
        owner = dealt(points, size, by, rng)

        def work(comm, owner=owner):
            mine = np.flatnonzero(owner == comm.rank)
            part = triangulate_part(comm, points[mine], mine).part
            return part, interior_of_part(comm, part, InteriorOptions(**options), with_arrays=True)

        assert_serial(run_on_ranks(size, work), mesh, expected, messages)


def cut_up(comm, mesh, ends):
    """The simplices between two of `ends`, with all points that any of them uses, and some that none does."""
    cells = np.arange(ends[comm.rank], ends[comm.rank + 1])
    used = np.union1d(mesh.simplices[cells], np.arange(comm.rank, len(mesh.points), 7))
    part = triangulation_of(mesh.points[used], np.searchsorted(used, mesh.simplices[cells]))
    return part_of_mesh(comm, part, used)


@pytest.mark.parametrize("case", ["few points", "at random", "no convex hull", "everything on one rank"])
def test_a_mesh_cut_up_anywhere_gives_the_serial_inside(case):
    """Without the exact engine; simplices at random are next to others of their own rank by chance only."""
    rng = np.random.default_rng(1)
    mesh = triangulate(SOLIDS["torus"]().sample(300 if case == "few points" else 900, rng), engine="qhull")
    options = {"ratio": 4.0} if case == "few points" else {}
    if case == "at random":
        order = rng.permutation(len(mesh))
        mesh = triangulation_of(mesh.points, mesh.simplices[order])
    if case == "no convex hull":
        mesh = submesh(mesh, serial(mesh, {})[0] | (mesh.neighbors >= 0).all(axis=1))
    expected, messages = serial(mesh, options)
    assert expected.any()
    one = case == "everything on one rank"
    ends = [0, 0, len(mesh), len(mesh)] if one else [0, *np.sort(rng.integers(0, len(mesh), 2)), len(mesh)]

    def work(comm):
        part = cut_up(comm, mesh, ends)
        return part, interior_of_part(comm, part, InteriorOptions(**options), with_arrays=True)

    assert_serial(run_on_ranks(3, work), mesh, expected, messages)


@pytest.mark.parametrize("size", [2, 3, 8])
def test_each_point_counts_once_in_the_share_between_the_sides(size):
    rng = np.random.default_rng(size)
    mesh = triangulate(torus(rng, 500), engine="qhull")
    inside = rng.random(len(mesh)) < 0.02
    ends = np.linspace(0, len(mesh), size + 1).astype(int)

    def share(comm):
        part = cut_up(comm, mesh, ends)
        return MeshOfRanks(comm, part, 0.0).surface_share(inside[part.cell_ids])

    assert run_on_ranks(size, share) == [surface_share(mesh, inside)] * size


def surface_on_ranks(size, points, n_points=None):
    """What all ranks are told; some points are on several ranks."""

    def work(comm):
        mine = np.flatnonzero((np.arange(len(points)) % comm.size == comm.rank) | (np.arange(len(points)) % 10 == 0))
        return lie_on_surface(comm, points[mine], mine, n_points or len(points))

    (told,) = set(run_on_ranks(size, work))
    return told


@pytest.mark.parametrize("size", [1, 3, 30])
def test_whether_points_lie_on_a_surface(size):
    """Known where no two points are equally far from a third; 30 ranks have fewer points than are looked at."""
    rng = np.random.default_rng(size)
    for cloud, n, expected in ((torus, 900, True), (uniform, 900, False), (uniform, 40, False), (lattice, 216, None)):
        points = cloud(rng, n)
        assert surface_on_ranks(size, points) is expected
        assert expected is None or lies_on_surface(points) == expected
    assert surface_on_ranks(size, np.concatenate([points, points[:2]]), len(points) + 2) is None


def test_points_too_large_to_be_calculated_with_are_refused():
    mesh = triangulate(np.random.default_rng(0).random((60, 3)))
    mesh = replace(mesh, points=mesh.points * 1e40)
    ends = np.linspace(0, len(mesh), 4).astype(int)
    with pytest.raises(InputError, match="another unit"):
        run_on_ranks(3, lambda comm: interior_of_part(comm, cut_up(comm, mesh, ends), InteriorOptions()))
