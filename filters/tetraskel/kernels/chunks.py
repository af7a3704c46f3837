"""Work over long arrays in pieces that stay in the processor's cache, on every core.

NumPy lets go of the interpreter inside its loops, so plain threads are enough.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

CHUNK = 1 << 13  # simplices at a time

TICK_SECONDS = 0.1  # between two calls of a tick

Tick = Callable[[float], None]
"""Called with the share of work done, 0 to 1; raises `tetraskel.errors.Aborted` to stop."""


def silent(_: float) -> None:
    """The `Tick` of who does not want to know."""


def part(tick: Tick, start: float, stop: float) -> Tick:
    """A tick for a stage that is the work from one share to another."""
    return lambda share: tick(start + (stop - start) * share)


def for_chunks(work: Callable[[slice], None], n: int, tick: Tick = silent, chunk: int = CHUNK) -> None:
    """Call `work` on consecutive slices of range(n), several at once; `tick` is called in the caller's thread."""
    slices = [slice(start, min(start + chunk, n)) for start in range(0, n, chunk)]
    if len(slices) < 4:
        for piece in slices:
            work(piece)
        tick(1.0)
        return
    told = time.monotonic()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            for done, _ in enumerate(pool.map(work, slices), 1):
                if time.monotonic() - told > TICK_SECONDS:
                    tick(done / len(slices))
                    told = time.monotonic()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
