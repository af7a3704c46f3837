"""Connected pieces of a mesh, simplices joined across facets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.integer]


def label_pieces(neighbors: Ints) -> NDArray[np.int32]:
    """(m,) piece of each simplex, numbered by the smallest simplex id in it.

    Strategy: every simplex points to the smallest id it has heard of; labels hop across facets, then along the
    pointers (each pointer to where its target points), until nothing changes. The number of rounds grows with the
    logarithm of the longest chain, not its length. In plain NumPy because a ParaView may come without SciPy.
    """
    n, width = neighbors.shape
    label = np.arange(n, dtype=np.int32)
    cells = np.repeat(np.arange(n, dtype=np.int32), width)
    across = neighbors.ravel()
    joined = (across >= 0) & (across < cells)  # each facet once
    low, high = across[joined], cells[joined]
    while len(low):
        a, b = label[low], label[high]
        differ = a != b
        low, high, a, b = low[differ], high[differ], a[differ], b[differ]
        np.minimum.at(label, np.maximum(a, b), np.minimum(a, b))
        while not np.array_equal(label, jumped := label[label]):
            label = jumped
    return np.unique(label, return_inverse=True)[1].astype(np.int32)
