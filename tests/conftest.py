"""What all tests share."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from tetraskel import build_tree, curve_skeleton, triangulate, voronoi_skeleton
from tetraskel.kernels.compilation import numba_is_used
from tubes import TUBES

settings.register_profile("patient", deadline=None)  # other programs slow single examples down
settings.load_profile("patient")


def pytest_sessionstart(session):
    """Compile once, before the workers of pytest-xdist start: they and the programs of tests load what is on disk."""
    if not hasattr(session.config, "workerinput") and not session.config.option.collectonly and numba_is_used():
        call = [sys.executable, "-c", "import conftest; conftest.compile_plane()"]
        path = os.pathsep.join([str(Path(__file__).parent), *sys.path])  # this folder's conftest first
        beside = subprocess.Popen(call, env={**os.environ, "PYTHONPATH": path})
        compile_space()
        beside.wait()
        compile_plane()  # what one of the two forgot when both wrote to the same list
        compile_space()


def pytest_collection_modifyitems(items):
    """First what waits for programs, while other workers have something to do."""
    items.sort(key=lambda item: "paraview" not in item.path.parts)


@pytest.fixture(scope="session", autouse=True)
def compiled():
    """Load what is compiled before the tests: no test is timed with it."""
    if numba_is_used():
        compile_plane()
        compile_space()


@pytest.fixture(autouse=True)
def small_pictures(request, monkeypatch):
    """Pictures of commands as small as can be judged: software draws them, and that takes more time than all else."""
    if "cli" in request.path.parts or request.path.name == "test_docs.py":
        from tetraskel.cli import comparison_pictures, picture

        for module in (picture, comparison_pictures):
            monkeypatch.setattr(module, "SIZE", (400, 300))


def compile_plane():
    """What numba compiles for triangles; programs then say nothing about it."""
    mesh = triangulate(np.random.default_rng(0).random((20, 2)))
    build_tree(mesh)
    voronoi_skeleton(mesh, method="sk2")


def compile_space():
    """The same for tetrahedra, from points to curve skeleton, and Voronoi skeletons."""
    points = TUBES["torus"]().sample(2000)
    build_tree(triangulate(points))
    curve_skeleton(points)
    voronoi_skeleton(triangulate(points[:100]), method="sk2")
