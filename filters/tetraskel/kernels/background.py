"""Wait for a library call that cannot be interrupted, without becoming uninterruptible oneself."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

from tetraskel.kernels.chunks import Tick

T = TypeVar("T")

POLL_SECONDS = 0.1


def wait_for(call: Callable[[], T], tick: Tick, expected_seconds: float) -> T:
    """The result of `call`, run in a thread of its own while `tick` is told how far it may be.

    The share told creeps towards 1 with the expected time. When `tick` raises, or Ctrl-C comes, the exception
    passes at once; the library call is left to finish unobserved and its result is dropped.
    """
    return begin(call)(tick, expected_seconds)


def begin(call: Callable[[], T]) -> Callable[[Tick, float], T]:
    """Start `call` in a thread of its own; what comes back waits for its result, as `wait_for` does."""
    outcome: list[T] = []
    failure: list[BaseException] = []

    def run() -> None:
        try:
            outcome.append(call())
        except BaseException as error:
            failure.append(error)

    worker = threading.Thread(target=run, daemon=True)
    worker.start()

    def wait(tick: Tick, expected_seconds: float) -> T:
        waited = 0.0
        while worker.is_alive():
            worker.join(POLL_SECONDS)
            waited += POLL_SECONDS
            tick(waited / (waited + expected_seconds))
        if failure:
            raise failure[0]
        return outcome[0]

    return wait
