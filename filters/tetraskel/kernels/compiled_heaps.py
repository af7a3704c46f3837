"""The heaps of `heaps` as numba compiles them: two arrays, four sons to a node. Imported only where numba is.

Four sons lie in one line of the cache, and the tree is half as deep as with two (LaMarca and Ladner 1996).
"""

from __future__ import annotations

import numpy as np
from numba.extending import overload
from numba.np.numpy_support import as_dtype

from tetraskel.kernels import heaps


@overload(heaps.make_heap)
def _make_heap(room, key):
    kind = as_dtype(key)
    return lambda room, key: (np.empty(room, kind), np.empty(room, np.int32))


@overload(heaps.push)
def _push(keys, values, size, key, value):
    def push(keys, values, size, key, value):
        place = size
        while place > 0:
            above = (place - 1) >> 2
            if keys[above] < key or (keys[above] == key and values[above] <= value):
                break
            keys[place], values[place] = keys[above], values[above]
            place = above
        keys[place], values[place] = key, value

    return push


@overload(heaps.pop)
def _pop(keys, values, size):
    def pop(keys, values, size):
        least, owner = keys[0], values[0]
        size -= 1
        key, value = keys[size], values[size]  # the last entry goes down from the top
        place = 0
        while 4 * place + 1 < size:
            best = 4 * place + 1
            for other in range(best + 1, min(best + 4, size)):
                if keys[other] < keys[best] or (keys[other] == keys[best] and values[other] < values[best]):
                    best = other
            if key < keys[best] or (key == keys[best] and value <= values[best]):
                break
            keys[place], values[place] = keys[best], values[best]
            place = best
        keys[place], values[place] = key, value
        return least, owner

    return pop
