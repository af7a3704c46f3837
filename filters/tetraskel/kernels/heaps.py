"""Heaps for the loops of `loops_in_python`: `heapq` in plain Python; `compiled_heaps` has what numba compiles instead.

A heap holds pairs (key, value) and gives back the smallest pair, whatever it looks like inside: both give the same
sequence. The caller counts the entries, because the compiled heap is two arrays without a length of their own.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import Any


def make_heap(room: int, key: float) -> tuple[list[tuple[Any, int]], None]:
    """An empty heap, as `keys` and `values`, for at most `room` pairs with keys of the type of `key`."""
    return [], None


def push(keys: Any, values: Any, size: int, key: Any, value: int) -> None:
    """Put in a pair beside `size` others."""
    heappush(keys, (key, value))


def pop(keys: Any, values: Any, size: int) -> tuple[Any, int]:
    """Take the smallest pair of `size` out."""
    return heappop(keys)
