"""How large and how small an object may be for lengths to be multiplied with one another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import InputError

Floats = NDArray[np.float64]

# Squares of volumes go with the sixth power of a length, paths with the fifth: between these bounds such numbers stay
# far from the ends of what a double holds, for parts of a millionth of the whole, too.
SMALLEST, LARGEST = 1e-30, 1e30


def expect_extent(points: Floats) -> None:
    """Raise `InputError` unless the box of (n, d) points has a size that can be calculated with; no points have.

    A triangulation takes any unit, for its predicates are exact or scaled; what measures lengths is given this first.
    """
    extent = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    if extent and not SMALLEST <= extent <= LARGEST:
        raise InputError(
            f"expected points that span between {SMALLEST:g} and {LARGEST:g}, got {extent:g}; give them in "
            "another unit."
        )
