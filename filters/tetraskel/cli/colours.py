"""What colours stand for: pictures, windows and pages show the same range of an array under the same legend."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

RADIUS, DEPTH = "MaximumInscribedSphereRadius", "Depth"


def colour_range(name: str, values: ArrayLike) -> tuple[float, float]:
    """The values at both ends of the colours of the array `name`, never equal.

    Radii begin at 0: a tube of one radius has one colour, and colours of several objects can be compared. Everything
    else goes from its least value to its largest. Values that are not finite do not count.

    Examples
    --------
    >>> colour_range(RADIUS, [0.25, 0.5])
    (0.0, 0.5)
    >>> colour_range(DEPTH, [2, 7])
    (2.0, 7.0)
    """
    numbers = np.asarray(values, dtype=float)
    known = numbers[np.isfinite(numbers)]
    least = 0.0 if name == RADIUS else float(known.min(initial=np.inf))
    most = float(known.max(initial=-np.inf))
    if most > least:
        return least, most
    least = least if np.isfinite(least) else 0.0
    return least, least + max(1.0, abs(least))


def legend(name: str, limits: tuple[float, float]) -> dict[str, str | int]:
    """Title, form and count of a legend's numbers, so that no two of them look alike."""
    if name != DEPTH:
        return {"title": "Radius\n", "fmt": "%.3g", "n_labels": 3}
    between = limits[1] - limits[0] >= 2  # else there is no whole number between them
    return {"title": "Depth\n", "fmt": "%.0f", "n_labels": 3 if between else 2}
