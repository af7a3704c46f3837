"""The nearest points of a cloud, by SciPy's k-d tree; loaded when it is first needed, for a ParaView without SciPy."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.errors import EngineError

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Cloud:
    """Points (n, d) that can be asked for those nearest to others."""

    def __init__(self, points: Floats) -> None:
        self.points = points

    @property
    def n(self) -> int:
        """Number of points."""
        return len(self.points)

    @cached_property
    def _tree(self) -> Any:
        try:
            from scipy.spatial import cKDTree
        except ImportError as error:
            raise EngineError("finding nearest points needs the package scipy, which is not installed.") from error
        return cKDTree(self.points, compact_nodes=False, balanced_tree=False)

    def query(self, places: Floats, k: int = 1) -> tuple[Floats, Ints]:
        """Distances and indices of the k nearest points of each of the (m, d) places: (m,) or (m, k) each."""
        distance, index = self._tree.query(places, k)
        return distance, index

    def count_within(self, places: Floats, distance: float) -> Ints:
        """(m,) how many points lie within a distance of each of the (m, d) places."""
        return np.asarray(self._tree.query_ball_point(places, distance, return_length=True))
