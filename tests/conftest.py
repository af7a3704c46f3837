"""What all tests share."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel import build_tree, curve_skeleton, triangulate
from tetraskel.kernels.compilation import numba_is_used
from tubes import TUBES


def pytest_sessionstart(session):
    """Compile once, before the workers of pytest-xdist start: they and the programs of tests load what is on disk."""
    if not hasattr(session.config, "workerinput") and not session.config.option.collectonly:
        compile_all()


@pytest.fixture(scope="session", autouse=True)
def compiled():
    """Load what is compiled before the tests: no test is timed with it."""
    compile_all()


def compile_all():
    """Everything numba compiles for the functions, in the plane and in space; programs then say nothing about it."""
    if numba_is_used():
        build_tree(triangulate(np.random.default_rng(0).random((20, 2))))
        points = TUBES["torus"]().sample(2000)
        build_tree(triangulate(points))
        curve_skeleton(points)
