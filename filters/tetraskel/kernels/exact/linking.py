"""Which new cells share a facet: through the pair of vertices on its far edge."""

from __future__ import annotations

import numpy as np

from tetraskel.kernels.compilation import inlined, inner


@inlined
def link(mates, table, width, facet, a, b):
    """Join a facet over the edge from a to b to the one over the edge from b to a, if that has come already."""
    other = table[b * width + a]
    if other >= 0:
        mates[facet] = other
        mates[other] = facet
    else:
        table[a * width + b] = facet


@inner
def _place(keys, key):
    """Where a key is or would be, in a table of a power of two of keys; -1 is an empty place."""
    mask = np.uint64(len(keys) - 1)
    place = np.int64(((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(20)) & mask)
    while keys[place] != key and keys[place] != -1:
        place = (place + 1) & np.int64(mask)
    return place


@inner
def link_by_hash(vertices, mates, facets):
    """The same for a star of any size; `facets` are its outer facets."""
    size = 16
    while size < 8 * len(facets):
        size *= 2
    keys, values = np.full(size, -1, np.int64), np.zeros(size, np.int64)
    for i in range(len(facets)):
        facet = np.int64(facets[i])
        k, base = facet & 3, facet & ~3
        for turn in range(3):
            j, a, b = 1 + turn, 1 + (turn + 1) % 3, 1 + (turn + 2) % 3
            first, second = np.int64(vertices[base + (k ^ a)]), np.int64(vertices[base + (k ^ b)])
            back = _place(keys, (second << 32) | first)
            if keys[back] >= 0:
                mates[base + (k ^ j)] = values[back]
                mates[values[back]] = base + (k ^ j)
            else:
                place = _place(keys, (first << 32) | second)
                keys[place], values[place] = (first << 32) | second, base + (k ^ j)
