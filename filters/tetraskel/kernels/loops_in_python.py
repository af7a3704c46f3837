"""Loops that no array operation replaces: compiled by numba where it is installed, plain Python where it is not.

A loop is written once, in the subset of Python that both run: it indexes flat sequences of numbers, uses `heaps`,
and writes its results into sequences it is given. Compiled it sees arrays, else lists, and the numbers are the
same to the last bit.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetraskel.kernels.background import wait_for
from tetraskel.kernels.chunks import CHUNK, Tick, for_chunks, silent
from tetraskel.kernels.compilation import compiled, numba_is_used


def run_loop(
    loop: Callable[..., None],
    inputs: Sequence[Any],
    outputs: Sequence[NDArray],
    tick: Tick,
    expected_seconds: float = 1.0,
) -> None:
    """Call `loop(*inputs, *outputs)`, which writes into `outputs` only.

    Parameters
    ----------
    loop : function
        Takes flat arrays (lists, without numba) and plain numbers.
    inputs : sequence of (k,) arrays or numbers
        Not written to.
    outputs : sequence of (k,) arrays
        Given with their initial values; hold the results afterwards.
    tick : callable
        Called every tenth of a second; may raise `Aborted`.
    expected_seconds : float
        For the progress told to `tick` only.
    """
    if numba_is_used():
        arrays = [_contiguous(values) for values in inputs]
        wait_for(lambda: _compiled(loop)(*arrays, *outputs), tick, expected_seconds)
        return
    lists = [values.tolist() for values in outputs]
    plain = [values.tolist() if isinstance(values, np.ndarray) else values for values in inputs]
    wait_for(lambda: loop(*plain, *lists), tick, 50 * expected_seconds)
    for values, result in zip(outputs, lists, strict=True):
        values[:] = result


def run_compiled(
    name: str, constants: Sequence[Any], inputs: Sequence[NDArray], outputs: Sequence[NDArray], tick: Tick = silent
) -> bool:
    """Call `tetrahedron_loops.<name>(*constants, *inputs, *outputs)` in pieces, on every core; False without numba.

    Parameters
    ----------
    name : str
    constants : sequence of arrays or numbers
        Given to every call as they are.
    inputs, outputs : sequences of (n, ...) arrays
        Cut into the same pieces.
    tick : callable
        Told the share of work done; may raise `Aborted`.
    """
    if not numba_is_used():
        return False
    loop = _loop(f"tetrahedron_loops.{name}")

    def work(piece: slice) -> None:
        loop(*constants, *(values[piece] for values in inputs), *(values[piece] for values in outputs))

    if not loop.signatures:
        wait_for(lambda: work(slice(0, 0)), tick, 1.0)  # compiles
    for_chunks(work, len(outputs[0]), tick)
    return True


def call_compiled(name: str, arguments: Sequence[Any], tick: Tick = silent, expected_seconds: float = 1.0) -> Any:
    """The result of a loop, "module.function", of these arguments; None without numba. `tick` as in `run_loop`."""
    if not numba_is_used():
        return None
    return wait_for(lambda: _loop(name)(*map(_contiguous, arguments)), tick, expected_seconds)


def gather_compiled(
    name: str, arguments_of: Callable[[slice], Sequence[Any]], n: int, tick: Tick = silent, chunk: int = CHUNK
) -> tuple[NDArray, ...]:
    """The arrays that a loop, "module.function", makes of each piece of range(n), joined in order; with numba only.

    Parameters
    ----------
    arguments_of : callable
        Of a piece, which may be empty.
    tick : callable
        Told the share of work done; may raise `Aborted`.
    """
    loop, found = _loop(name), {}

    def work(piece: slice) -> None:
        found[piece.start] = loop(*map(_contiguous, arguments_of(piece)))

    wait_for(lambda: work(slice(0, 0)), tick, 1.0)  # compiles
    for_chunks(work, n, tick, chunk)
    return tuple(np.concatenate(column) for column in zip(*(found[start] for start in sorted(found)), strict=True))


def _loop(name: str) -> Any:
    module, function = name.split(".")
    return _compiled(getattr(importlib.import_module(f"tetraskel.kernels.{module}"), function))


@cache
def _compiled(loop: Callable[..., None]) -> Any:
    importlib.import_module("tetraskel.kernels.compiled_heaps")
    return compiled(loop)


def _contiguous(values: Any) -> Any:
    """Arrays in one layout: no loop is compiled twice for another one."""
    if isinstance(values, tuple):
        return tuple(map(_contiguous, values))
    return np.ascontiguousarray(values) if isinstance(values, np.ndarray) else values
