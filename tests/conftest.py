"""What all tests share."""

from __future__ import annotations

import numpy as np
import pytest

from tetraskel import curve_skeleton, triangulate
from tetraskel.kernels.compilation import numba_is_used
from tubes import TUBES


@pytest.fixture(scope="session", autouse=True)
def compiled():
    """Compile before the tests: programs they start then say nothing about it, and no test is timed with it."""
    if numba_is_used():
        triangulate(np.random.default_rng(0).random((20, 2)))
        curve_skeleton(TUBES["torus"]().sample(2000))
